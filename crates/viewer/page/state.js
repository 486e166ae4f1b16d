// What is chosen and shown, and what changes it.

const byId = (id) => document.getElementById(id);
const data = readData();
const canvas = byId("canvas");
const camera = new Camera(data.up);
const state = { mode: "regions", chosen: null, hovered: null, component: null, tree: 0, treeShape: 0, level: 0.3, cut: null, flip: false };
const hasTrees = data.shapes.every((shape) => shape.trees.length);
const actions = { choose, hover };
const panel = new Panel(data, actions);
const treePicture = new TreePicture(byId("tree"), {
  level: setLevel,
  choose: (id) => choose(state.treeShape, id),
  hover: (id) => hover(state.treeShape, id),
});
let renderer = null;
let dirty = false;

// The regions of a shape that a choice stands for: itself, or what it is matched with.
function regionsOf(choice, s) {
  if (!choice) return [];
  if (choice.shape === s) return [choice.region];
  return data.matches.filter((m) => m[choice.shape] === choice.region).map((m) => m[s]);
}

// The mirror images of what is chosen.
function twinsOf(s) {
  return regionsOf(state.chosen, s).map((id) => data.shapes[s].regions[id].twin).filter((twin) => twin !== null);
}

function choose(shape, region) {
  const same = state.chosen && state.chosen.shape === shape && state.chosen.region === region;
  state.chosen = region === null || same ? null : { shape, region };
  if (state.chosen && state.mode === "level") setMode("regions");
  if (state.chosen && hasTrees) {
    const tree = data.shapes[shape].regions[region].tree ?? state.tree;
    if (tree !== state.tree || shape !== state.treeShape) setTree(tree, shape);
  }
  panel.show(state.chosen);
  refresh();
}

function hover(shape, region) {
  const next = region === null ? null : { shape, region };
  if (JSON.stringify(next) === JSON.stringify(state.hovered)) return;
  state.hovered = next;
  refresh();
}

function setMode(mode) {
  state.mode = mode === "level" && hasTrees ? "level" : "regions";
  document.querySelector(`input[name=mode][value=${state.mode}]`).checked = true;
  refresh();
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
  treePicture.show(data.shapes[shape], state.tree, data.none);
  refresh();
}

function setCut(axis) {
  state.cut = axis < 0 ? null : axis;
  document.querySelector(`input[name=cut][value="${axis}"]`).checked = true;
  refresh();
}

// Colours change; the picture follows at the next frame.
function refresh() {
  data.shapes.forEach((_, s) => panel.mark(s, regionsOf(state.chosen, s), twinsOf(s), regionsOf(state.hovered, s)));
  if (hasTrees) {
    treePicture.update(state.level, regionsOf(state.chosen, state.treeShape));
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
  redraw();
}

function redraw() {
  if (dirty || !renderer) return;
  dirty = true;
  requestAnimationFrame(() => {
    dirty = false;
    renderer?.draw();
  });
}

// What a picked vertex or voxel belongs to.
function regionAt(hit) {
  const shape = data.shapes[hit.shape];
  const label = (hit.kind === "vertex" ? shape.label : shape.grid.label)[hit.number];
  return label < 0 ? null : label;
}

function componentAt(hit) {
  const tree = data.shapes[hit.shape].trees[state.tree];
  if (!tree || tree[`${hit.kind}Entered`][hit.number] > state.level * 65535 + 0.5) return null;
  const branch = componentsAt(tree, state.level)[tree[`${hit.kind}Branch`][hit.number]];
  return branch < 0 ? null : { shape: hit.shape, branch };
}

function point(x, y) {
  const hit = renderer?.pick(x, y);
  const tip = byId("tip");
  let text = "";
  if (state.mode === "level") {
    const component = hit && componentAt(hit);
    if (JSON.stringify(component) !== JSON.stringify(state.component)) {
      state.component = component;
      refresh();
    }
    if (component) {
      const tree = data.shapes[component.shape].trees[state.tree];
      text = `component, at most ${percent(tree.volumes[component.branch])} before it merges`;
    }
  } else {
    const region = hit ? regionAt(hit) : null;
    hover(hit ? hit.shape : 0, region);
    if (region !== null) text = `Region ${region} · ${percent(data.shapes[hit.shape].regions[region].fraction)}`;
  }
  tip.hidden = !text;
  tip.textContent = text;
  tip.style.left = `${Math.min(x, canvas.clientWidth - 190)}px`;
  tip.style.top = `${y}px`;
}

// Chooses the innermost region at a place; within the chosen one, the region around that.
function click(x, y) {
  const hit = renderer?.pick(x, y);
  const innermost = hit ? regionAt(hit) : null;
  if (innermost === null) {
    choose(0, null);
    return;
  }
  const { regions } = data.shapes[hit.shape];
  const chosen = state.chosen?.shape === hit.shape ? state.chosen.region : null;
  const again = chosen !== null && hasBit(regions[chosen][`${hit.kind}Set`], hit.number);
  const next = again ? regions[chosen].parent ?? innermost : innermost;
  if (next !== chosen) choose(hit.shape, next);
}

function step(by) {
  const all = data.shapes.flatMap((shape, s) => shape.regions.map((_, r) => [s, r]));
  if (!all.length) return;
  const now = state.chosen ? all.findIndex(([s, r]) => s === state.chosen.shape && r === state.chosen.region) : by > 0 ? -1 : 0;
  choose(...all[(now + by + all.length) % all.length]);
}
