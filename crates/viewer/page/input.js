// Mouse, touch and keys.

// Pointers: one turns, two zoom and move; a click that stays in place chooses.
const pointers = new Map();
let travelled = 0;

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (pointers.size === 1) travelled = 0;
  else travelled = 100;
  byId("tip").hidden = true;
});
canvas.addEventListener("pointermove", (event) => {
  const now = [event.offsetX, event.offsetY];
  const before = pointers.get(event.pointerId);
  if (!before) {
    state.pointer = now;
    requestAnimationFrame(() => state.pointer === now && point(...now));
    return;
  }
  const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
  travelled += Math.hypot(dx, dy);
  const half = canvas.clientHeight / 2;
  if (pointers.size === 2) {
    const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
    const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
    camera.zoomAt(apart(now) / apart(before), 0, 0);
    camera.move(dx / half / 2, -dy / half / 2);
  } else if (travelled > 3) {
    if (event.buttons & 6 || event.shiftKey) camera.move(dx / half, -dy / half);
    else camera.turn(dx * 0.5, dy * 0.5);
  }
  pointers.set(event.pointerId, now);
  redraw();
});
const release = (event) => {
  if (pointers.delete(event.pointerId) && event.type === "pointerup" && travelled <= 3) click(event.offsetX, event.offsetY);
};
canvas.addEventListener("pointerup", release);
canvas.addEventListener("pointercancel", release);
canvas.addEventListener("pointerleave", () => {
  state.pointer = null;
  state.component = null;
  byId("tip").hidden = true;
  hover(0, null);
});
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  const lines = event.deltaMode === 1 ? 20 : 1;
  camera.zoomAt(Math.exp(-event.deltaY * lines * 0.0015), ...(renderer?.fromCentre(event.offsetX, event.offsetY) ?? [0, 0]));
  redraw();
}, { passive: false });

function look(azimuth, elevation) {
  camera.look(azimuth, elevation);
  redraw();
}

const keys = {
  n: () => step(1),
  p: () => step(-1),
  Escape: () => closeNote() || choose(0, null),
  h: hide,
  i: isolate,
  a: showAll,
  m: () => setMode(modes[(modes.indexOf(state.mode) + 1) % modes.length]),
  "[": () => hasTrees && setLevel(state.level - 0.02),
  "]": () => hasTrees && setLevel(state.level + 0.02),
  x: () => setAxes(!state.axes),
  s: savePicture,
  k: copyLink,
  d: () => byId("dark").click(),
  "?": () => byId("help-button").click(),
  c: () => setCut(state.cut === null ? 0 : state.cut === 2 ? -1 : state.cut + 1),
  ",": () => moveCut(-20),
  ".": () => moveCut(20),
  "+": () => camera.zoomAt(1.2, 0, 0),
  "=": () => camera.zoomAt(1.2, 0, 0),
  "-": () => camera.zoomAt(1 / 1.2, 0, 0),
};
function moveCut(by) {
  byId("cut-at").value = Number(byId("cut-at").value) + by;
}
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const typing = event.target.matches("input[type=range], select");
  if (typing && event.key !== "Escape") return;
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (arrow && event.target === canvas) {
    if (event.shiftKey) camera.move(0.08 * arrow[0], -0.08 * arrow[1]);
    else camera.turn(8 * arrow[0], 8 * arrow[1]);
  } else if (Object.hasOwn(VIEWS, event.key)) camera.look(...VIEWS[event.key]);
  else if (Object.hasOwn(keys, event.key)) keys[event.key]();
  else return;
  event.preventDefault();
  redraw();
});
