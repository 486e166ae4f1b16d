// What is seen, and how it is moved.

const data = readData();
const body = new Body(data);
const camera = new Camera(data.up);
const canvas = document.getElementById("canvas");
const [slider, play, now, lasting] = ["time", "play", "now", "lasting"].map((id) => document.getElementById(id));
const painter = new Painter(canvas);
document.getElementById("failure").hidden = Boolean(painter.gl);
document.getElementById("note").textContent = data.note;

let shown = 0; // place among the frames of the page
let chosen = -1;
let corners = null;
let timer = 0;

const axes = () => camera.axes(data.front ?? 0);
const redraw = () => painter.draw(axes(), camera, body.radius);

function showFrame(place) {
  shown = (place + data.frames.length) % data.frames.length;
  const frame = data.frames[shown];
  corners = body.corners(frame);
  painter.set(corners, body.colours(frame, chosen, lasting.checked));
  slider.value = String(shown);
  const time = frame.time === null ? "" : `, ${frame.time.toFixed(3)} s`;
  now.textContent = `frame ${frame.number} of ${data.total}${time}`;
  slider.setAttribute("aria-valuetext", now.textContent);
  showDetails(data, chosen, frame.number);
  redraw();
}

function choose(track) {
  chosen = track === undefined ? -1 : track;
  rows.forEach((row, t) => row.classList.toggle("chosen", t === chosen));
  showFrame(shown);
}

function setPlaying(playing) {
  clearInterval(timer);
  timer = playing ? setInterval(() => showFrame(shown + 1), data.interval) : 0;
  play.textContent = playing ? "Pause" : "Play";
  play.setAttribute("aria-pressed", String(playing));
}

function clickAt(x, y) {
  const box = canvas.getBoundingClientRect();
  const half = 0.5 * box.height;
  const s = painter.scale(camera, body.radius);
  const [across, up, toward] = axes();
  const u = ((x - box.left - 0.5 * box.width) / half - camera.shift[0]) / s;
  const v = ((box.top + half - y) / half - camera.shift[1]) / s;
  const frame = data.frames[shown];
  const track = body.pick(frame, corners, [0, 1, 2].map((a) => u * across[a] + v * up[a]), toward);
  if (track === undefined || track < 0) return choose(-1);
  // Again: the one around what is chosen, if there is one.
  const seen = body.shown(frame, track, lasting.checked, chosen);
  if (seen < 0) return choose(-1);
  const outer = body.within(frame, seen, chosen) ? body.shown(frame, body.parent(frame, chosen), lasting.checked, -1) : seen;
  return choose(outer >= 0 ? outer : seen);
}

function look(view) {
  camera.look(...VIEWS[view]);
  redraw();
}

const rows = fillTable(data, (track) => choose(track === chosen ? -1 : track));
slider.max = String(data.frames.length - 1);
slider.addEventListener("input", () => { setPlaying(false); showFrame(Number(slider.value)); });
lasting.addEventListener("change", () => showFrame(shown));
document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => look(button.dataset.view)));
play.addEventListener("click", () => setPlaying(!timer));

let drag = null;
canvas.addEventListener("pointerdown", (e) => {
  drag = { x: e.clientX, y: e.clientY, moved: 0 };
  canvas.setPointerCapture(e.pointerId);
});
canvas.addEventListener("pointermove", (e) => {
  if (!drag) return;
  const [dx, dy] = [e.clientX - drag.x, e.clientY - drag.y];
  drag = { x: e.clientX, y: e.clientY, moved: drag.moved + Math.abs(dx) + Math.abs(dy) };
  if (drag.moved < 4) return;
  camera.turn(0.5 * dx, 0.5 * dy);
  redraw();
});
canvas.addEventListener("pointerup", (e) => {
  if (drag && drag.moved < 4) clickAt(e.clientX, e.clientY);
  drag = null;
});
canvas.addEventListener("wheel", (e) => {
  e.preventDefault();
  camera.zoomAt(Math.exp(-0.0015 * e.deltaY), 0, 0);
  redraw();
}, { passive: false });
document.addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || e.target === slider) return;
  const turn = (dx, dy) => { camera.turn(dx, dy); redraw(); };
  const zoom = (factor) => { camera.zoomAt(factor, 0, 0); redraw(); };
  const step = (by) => { setPlaying(false); showFrame(shown + by); };
  const keys = { " ": () => setPlaying(!timer), ",": () => step(-1), ".": () => step(1), Escape: () => choose(-1),
    ArrowLeft: () => turn(10, 0), ArrowRight: () => turn(-10, 0), ArrowUp: () => turn(0, 10), ArrowDown: () => turn(0, -10),
    "+": () => zoom(1.2), "-": () => zoom(1 / 1.2) };
  for (const view of Object.keys(VIEWS)) keys[view] = () => look(view);
  if (!Object.hasOwn(keys, e.key) || (e.key === " " && e.target.tagName === "BUTTON")) return;
  e.preventDefault();
  keys[e.key]();
});
new ResizeObserver(redraw).observe(canvas);
showFrame(0);
