// Joins the controls to the state, and starts.

document.querySelectorAll("input[name=mode]").forEach((input) => input.addEventListener("change", () => setMode(input.value)));
document.querySelectorAll("input[name=cut]").forEach((input) => input.addEventListener("change", () => setCut(Number(input.value))));
byId("cut-at").addEventListener("input", () => (state.cut === null ? setCut(0) : redraw()));
byId("cut-flip").addEventListener("click", () => {
  setFlip(!state.flip);
  if (state.cut === null) setCut(0);
  redraw();
});
byId("level").addEventListener("input", (event) => setLevel(event.target.value / 1000));
byId("tree-choice").addEventListener("change", (event) => setTree(Number(event.target.value), state.treeShape));
document.querySelectorAll("[data-view]").forEach((button) =>
  button.addEventListener("click", () => look(...VIEWS[button.dataset.view])));
byId("help-button").addEventListener("click", (event) => {
  byId("help").hidden = !byId("help").hidden;
  event.target.setAttribute("aria-expanded", String(!byId("help").hidden));
});

byId("axes-button").addEventListener("click", () => setAxes(!state.axes));
byId("picture").addEventListener("click", savePicture);
byId("link").addEventListener("click", copyLink);
byId("level").after(explained("level"));

// Only what there is can be chosen.
const modes = [hasParts && "parts", "regions", hasTrees && "level"].filter(Boolean);
document.querySelectorAll("input[name=mode]").forEach((input) => (input.parentElement.hidden = !modes.includes(input.value)));
byId("modes").hidden = modes.length === 1;
byId("tree-part").hidden = !hasTrees;
takeMode(state.mode);
setDark(DARK.matches);

function fail(...lines) {
  byId("failure").replaceChildren(...lines.map((line) => element("p", {}, line)));
  byId("failure").hidden = false;
}

function start() {
  try {
    renderer = new Renderer();
  } catch (error) {
    if (error.message !== "webgl2") throw error;
    return fail(
      "This browser cannot draw the shape: it has no WebGL2, or it is switched off.",
      "A current Firefox, Chromium or Safari has it; hardware acceleration may have to be allowed in the settings. The table is complete without it.",
    );
  }
  // Nothing to show where it was drawn.
  for (const id of ["scale", "picture"]) byId(id).hidden = false;
  refresh();
}
canvas.addEventListener("webglcontextlost", (event) => {
  event.preventDefault();
  renderer = null;
  fail("The graphics card was taken away; the picture comes back when it does.");
});
canvas.addEventListener("webglcontextrestored", () => {
  byId("failure").hidden = true;
  start();
});
new ResizeObserver(() => {
  renderer?.resize();
  renderer?.draw();
  if (renderer) overlay();
}).observe(canvas);

panel.show(null);
start();
if (location.hash) restore(location.hash);
