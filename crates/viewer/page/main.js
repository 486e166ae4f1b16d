// Puts the parts together: one state, what changes it, and when the picture is drawn again.

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
  data.shapes.forEach((_, s) => panel.mark(s, regionsOf(state.chosen, s), regionsOf(state.hovered, s)));
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

class Renderer {
  constructor() {
    const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: false });
    if (!gl) throw new Error("webgl2");
    this.gl = gl;
    this.tools = {
      surface: program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT),
      slice: program(gl, SLICE_VERTEX, SLICE_FRAGMENT),
    };
    gl.enable(gl.DEPTH_TEST);
    gl.bindVertexArray(gl.createVertexArray());
    this.surfaces = data.shapes.map((shape) => new Surface(gl, shape));
    this.radius = Math.max(...data.shapes.map((shape) => shape.radius)) || 1;
    // Half the room that each shape takes upright and across, however it is turned about its up axis.
    const half = (shape, a) => (shape.high[a] - shape.low[a]) / 2;
    const [u, v, w] = data.up === "z" ? [2, 0, 1] : [1, 0, 2];
    const least = 1e-3 * this.radius;
    this.tall = Math.max(least, ...data.shapes.map((shape) => half(shape, u)));
    this.wide = Math.max(least, ...data.shapes.map((shape) => Math.hypot(half(shape, v), half(shape, w))));
    this.resize();
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    const count = data.shapes.length;
    const beside = canvas.width >= canvas.height;
    // Left, bottom, width and height of each shape's part.
    this.views = data.shapes.map((_, s) => {
      const [w, h] = [Math.floor(canvas.width / (beside ? count : 1)), Math.floor(canvas.height / (beside ? 1 : count))];
      return beside ? [s * w, 0, w, h] : [0, (count - 1 - s) * h, w, h];
    });
    const names = count > 1 ? data.shapes.map((shape) => element("span", {}, shape.name)) : [];
    names.forEach((name, s) => {
      name.style.left = `${(100 * this.views[s][0]) / canvas.width}%`;
      name.style.top = `${(100 * (canvas.height - this.views[s][1] - this.views[s][3])) / canvas.height}%`;
    });
    byId("names").replaceChildren(...names);
  }

  frame(s) {
    const [, , width, height] = this.views[s];
    const axes = camera.axes();
    const turn = new Float32Array(9);
    for (let a = 0; a < 3; a++) for (let i = 0; i < 3; i++) turn[3 * a + i] = axes[i][a];
    const unit = camera.zoom * 0.92 * Math.min(1 / this.tall, width / height / this.wide);
    const depth = -0.9 / this.radius;
    const [x, y] = camera.shift;
    return { turn, scale: [(unit * height) / width, unit, depth], shift: [(x * height) / width, y] };
  }

  // The plane of the cut through a shape.
  cut(s) {
    if (state.cut === null) return null;
    const { low, high } = data.shapes[s];
    const share = byId("cut-at").value / 1000;
    const axis = state.cut;
    return { axis, side: state.flip ? -1 : 1, at: low[axis] + share * (high[axis] - low[axis]) };
  }

  recolour() {
    this.surfaces.forEach((surface, s) => {
      const look = {
        mode: state.mode,
        tree: Math.min(state.tree, surface.shape.trees.length - 1),
        level: state.level,
        none: data.none,
        chosen: regionsOf(state.chosen, s),
        hovered: regionsOf(state.hovered, s),
        hoveredComponent: state.component && state.component.shape === s ? state.component.branch : -1,
      };
      paint(surface.colours, surface.shape, "vertex", look);
      surface.uploadColours();
      if (surface.slice) {
        paint(surface.slice.colours, surface.shape, "voxel", look);
        surface.slice.stale = true;
      }
    });
  }

  draw() {
    const { gl } = this;
    if (gl.isContextLost()) return;
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    this.views.forEach((view, s) => {
      const { slice } = this.surfaces[s];
      const cut = this.cut(s);
      if (cut && slice) {
        if (slice.take(cut) || slice.stale) slice.upload();
        slice.stale = false;
      }
      gl.viewport(...view);
      gl.scissor(...view);
      this.surfaces[s].draw(this.tools, this.frame(s), cut);
    });
    gl.disable(gl.SCISSOR_TEST);
  }

  // What lies at a place of the canvas, in CSS pixels: {shape, kind, number} or null.
  pick(x, y) {
    const ratio = canvas.width / canvas.clientWidth;
    const [px, py] = [x * ratio, canvas.height - y * ratio];
    const s = this.views.findIndex((v) => px >= v[0] && px < v[0] + v[2] && py >= v[1] && py < v[1] + v[3]);
    if (s < 0) return null;
    const [left, bottom, width, height] = this.views[s];
    const cut = this.cut(s);
    const { shape, slice } = this.surfaces[s];
    if (cut && slice) slice.stale = slice.take(cut) || slice.stale;
    const place = [(2 * (px - left)) / width - 1, (2 * (py - bottom)) / height - 1];
    const hit = pick(shape, slice, this.frame(s), cut, ...place);
    return hit && { shape: s, ...hit };
  }
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

function click(x, y) {
  const hit = renderer?.pick(x, y);
  const region = hit ? regionAt(hit) : null;
  if (region === null) choose(0, null);
  else if (!(state.chosen && state.chosen.shape === hit.shape && state.chosen.region === region)) choose(hit.shape, region);
}

function step(by) {
  const all = data.shapes.flatMap((shape, s) => shape.regions.map((_, r) => [s, r]));
  if (!all.length) return;
  const now = state.chosen ? all.findIndex(([s, r]) => s === state.chosen.shape && r === state.chosen.region) : by > 0 ? -1 : 0;
  choose(...all[(now + by + all.length) % all.length]);
}

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
  camera.zoomAt(Math.exp(-event.deltaY * lines * 0.0015), 0, 0);
  redraw();
}, { passive: false });

const views = { 1: [0, 0], 2: [90, 0], 3: [180, 0], 4: [0, 90], 0: [35, 12] };
function look(azimuth, elevation) {
  camera.look(azimuth, elevation);
  redraw();
}

const keys = {
  n: () => step(1),
  p: () => step(-1),
  Escape: () => choose(0, null),
  l: () => setMode(state.mode === "level" ? "regions" : "level"),
  "[": () => hasTrees && setLevel(state.level - 0.02),
  "]": () => hasTrees && setLevel(state.level + 0.02),
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
  const typing = event.target.matches("input, select");
  if (typing && event.key !== "Escape") return;
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (arrow && event.target === canvas) {
    if (event.shiftKey) camera.move(0.08 * arrow[0], -0.08 * arrow[1]);
    else camera.turn(8 * arrow[0], 8 * arrow[1]);
  } else if (event.key in views) camera.look(...views[event.key]);
  else if (event.key in keys) keys[event.key]();
  else return;
  event.preventDefault();
  redraw();
});

document.querySelectorAll("input[name=mode]").forEach((input) => input.addEventListener("change", () => setMode(input.value)));
document.querySelectorAll("input[name=cut]").forEach((input) => input.addEventListener("change", () => setCut(Number(input.value))));
byId("cut-at").addEventListener("input", () => (state.cut === null ? setCut(0) : redraw()));
byId("cut-flip").addEventListener("click", (event) => {
  state.flip = !state.flip;
  event.target.setAttribute("aria-pressed", String(state.flip));
  if (state.cut === null) setCut(0);
  redraw();
});
byId("level").addEventListener("input", (event) => setLevel(event.target.value / 1000));
byId("tree-choice").addEventListener("change", (event) => setTree(Number(event.target.value), state.treeShape));
document.querySelectorAll("[data-view]").forEach((button) =>
  button.addEventListener("click", () => look(...button.dataset.view.split(" ").map(Number))));
byId("help-button").addEventListener("click", (event) => {
  byId("help").hidden = !byId("help").hidden;
  event.target.setAttribute("aria-expanded", String(!byId("help").hidden));
});

if (hasTrees) {
  setTree(0, 0);
} else {
  byId("tree-part").hidden = true;
  byId("modes").hidden = true;
}

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
      "A current Firefox, Chromium or Safari has it; hardware acceleration may have to be allowed in the settings. The table of regions is complete without it.",
    );
  }
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
}).observe(canvas);

panel.show(null);
start();
