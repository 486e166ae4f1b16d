// What is chosen and shown, and what changes it.

const byId = (id) => document.getElementById(id);
const data = readData();
const canvas = byId("canvas");
const camera = new Camera(data.up);
const hasTrees = data.shapes.every((shape) => shape.trees.length);
const hasParts = data.shapes.every((shape) => shape.parts.length);
const state = {
  mode: hasParts ? "parts" : "regions", // or "level"
  chosen: null, // {shape, id} of a part in the mode "parts", else of a region
  hovered: null, // the same
  hidden: { parts: [], regions: [] }, // of each, a list of the same
  others: 1, // how opaque is what is not chosen
  component: null,
  tree: 0,
  treeShape: 0,
  level: 0.3,
  cut: null,
  flip: false,
  axes: false,
};
const NOUNS = { parts: "part", regions: "region" };
const actions = { choose, hover, hide, isolate, showAll, fade, showMerge };
const panel = new Panel(data, actions);
const treePicture = new TreePicture(byId("tree"), {
  level: setLevel,
  choose: (id) => choose(state.treeShape, id, "regions"),
  hover: (id) => listed() === "regions" && hover(state.treeShape, id),
});
let renderer = null;
let dirty = false;

// What can be chosen now: "parts" or "regions".
const listed = () => (state.mode === "parts" ? "parts" : "regions");
const same = (p, q) => p?.shape === q?.shape && p?.id === q?.id;

// What a choice stands for on a shape: itself, or what it is matched with.
function idsOf(choice, s, list = listed()) {
  if (!choice) return [];
  if (choice.shape === s) return [choice.id];
  return data.matches[list].filter((m) => m[choice.shape] === choice.id).map((m) => m[s]);
}

// The mirror images of what is chosen.
function twinsOf(s) {
  return idsOf(state.chosen, s).flatMap((id) => data.shapes[s][listed()][id].twins);
}

// The region that is most like a part, or the part that grew from a region.
function counterpart(choice, from) {
  if (!choice) return null;
  const shape = data.shapes[choice.shape];
  const id = from === "parts" ? shape.parts[choice.id].region : shape.parts.findIndex((part) => part.region === choice.id);
  return id === null || id < 0 ? null : { shape: choice.shape, id };
}

// Chooses a part or region; what was chosen already is left.
function choose(shape, id, list = listed()) {
  if (list !== listed()) state.chosen = null;
  if (state.mode === "level" ? id !== null : list !== listed()) takeMode(list);
  const next = id === null ? null : { shape, id };
  state.chosen = same(next, state.chosen) ? null : next;
  if (!state.chosen) state.others = 1;
  if (state.chosen && hasTrees && list === "regions") {
    const tree = data.shapes[shape].regions[id].tree ?? state.tree;
    if (tree !== state.tree || shape !== state.treeShape) setTree(tree, shape);
  }
  panel.show(state.chosen);
  refresh();
}

function hover(shape, id) {
  const next = id === null ? null : { shape, id };
  if (same(next, state.hovered)) return;
  state.hovered = next;
  refresh();
}

// Takes what is chosen out of the picture, or back in.
function hide() {
  if (!state.chosen) return;
  const hidden = state.hidden[listed()];
  const at = hidden.findIndex((other) => same(other, state.chosen));
  if (at < 0) hidden.push(state.chosen);
  else hidden.splice(at, 1);
  panel.show(state.chosen);
  refresh();
}

// Shows nothing but what is chosen, or the others again.
function isolate() {
  if (state.chosen) setOthers(state.others > 0 ? 0 : 1);
}

function setOthers(opacity) {
  state.others = opacity;
  panel.show(state.chosen);
  refresh();
}

// While a slider moves, the panel that it stands in stays.
function fade(opacity) {
  state.others = opacity;
  refresh();
}

function showAll() {
  state.hidden[listed()] = [];
  setOthers(1);
}

function setMode(mode) {
  const from = listed();
  takeMode(mode);
  if (listed() !== from) {
    state.chosen = counterpart(state.chosen, from);
    state.hovered = null;
    clicked = null;
  }
  panel.show(state.chosen);
  refresh();
}

function takeMode(mode) {
  const known = (mode === "level" && hasTrees) || (mode === "parts" && hasParts);
  state.mode = known ? mode : "regions";
  document.querySelector(`input[name=mode][value=${state.mode}]`).checked = true;
  panel.take(listed());
}

function setLevel(level) {
  state.level = Math.min(1, Math.max(0, level));
  byId("level").value = Math.round(1000 * state.level);
  if (state.mode !== "level") setMode("level");
  refresh();
}

// Shows a tree, of which only one shape's is drawn: that of the region chosen last.
function setTree(tree, shape) {
  const { trees, name } = data.shapes[shape];
  state.treeShape = shape;
  state.tree = Math.min(tree, trees.length - 1);
  byId("tree-title").textContent = data.shapes.length > 1 ? `Component tree of ${name}` : "Component tree";
  byId("tree-choice").replaceChildren(...trees.map(({ name }, t) => element("option", { value: t }, name)));
  byId("tree-choice").value = String(state.tree);
  treePicture.show(data.shapes[shape], state.tree, data.none, paper);
  refresh();
}

function setFlip(flip) {
  state.flip = flip;
  byId("cut-flip").setAttribute("aria-pressed", String(flip));
}

// Lets the level of a tree rise to where two components have just become one.
function showMerge(shape, tree, share) {
  setTree(tree, shape);
  setLevel(share);
  // The tree is below the table; on a phone the picture would go out of sight.
  if (window.matchMedia("(min-width: 801px)").matches) byId("tree-part").scrollIntoView({ block: "end" });
}

function setCut(axis) {
  state.cut = axis < 0 ? null : axis;
  document.querySelector(`input[name=cut][value="${axis}"]`).checked = true;
  refresh();
}

// Colours change; the picture follows at the next frame.
function refresh() {
  data.shapes.forEach((_, s) => {
    const hidden = state.hidden[listed()].filter(({ shape }) => shape === s).map(({ id }) => id);
    panel.mark(s, { chosen: idsOf(state.chosen, s), twins: twinsOf(s), hovered: idsOf(state.hovered, s), hidden });
  });
  if (hasTrees) {
    const chosen = listed() === "parts" ? counterpart(state.chosen, "parts") : state.chosen;
    treePicture.update(state.level, idsOf(chosen, state.treeShape, "regions"));
    const tree = data.shapes[state.treeShape].trees[state.tree];
    const at = 256 * state.level;
    const altitude = tree.quantiles[Math.round(at)];
    const component = componentsAt(tree, state.level);
    const count = component.reduce((n, c, b) => n + (c === b ? 1 : 0), 0);
    const sign = tree.superlevel ? "≥" : "≤";
    const parts = count === 1 ? "1 component" : `${count} components`;
    byId("level-text").textContent = `weight ${sign} ${show(altitude)}: ${percent(state.level)} of the shape, ${parts}`;
  }
  renderer?.recolour();
  drawGrey();
  redraw();
}

function redraw() {
  if (dirty || !renderer) return;
  dirty = true;
  keepAddress();
  requestAnimationFrame(() => {
    dirty = false;
    renderer?.draw();
    if (renderer) overlay();
  });
}
