// The picture of all shapes: where each is drawn, how it is seen, and what lies at a place.

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
    const wide = (shape) => Math.hypot(half(shape, v), half(shape, w));
    this.wide = Math.max(least, ...data.shapes.map(wide));
    // Seen from a little above (12 degrees), depth takes room upright too.
    this.tall = Math.max(least, ...data.shapes.map((shape) => 0.98 * half(shape, u) + 0.21 * wide(shape)));
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

  // How much of half the height of a view a unit of length takes; a view is so many times wider than high.
  unit(wider = this.views[0][2] / this.views[0][3]) {
    return camera.zoom * 0.92 * Math.min(1 / this.tall, wider / this.wide);
  }

  frame(s) {
    const [, , width, height] = this.views[s];
    const axes = camera.axes(data.shapes[s].front ?? 0);
    const turn = new Float32Array(9);
    for (let a = 0; a < 3; a++) for (let i = 0; i < 3; i++) turn[3 * a + i] = axes[i][a];
    const unit = this.unit(width / height);
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
        list: listed(),
        none: data.none,
        back: paper,
        others: state.others,
        chosen: idsOf(state.chosen, s),
        twins: twinsOf(s),
        hovered: idsOf(state.hovered, s),
        hidden: state.hidden[listed()].filter(({ shape }) => shape === s).map(({ id }) => id),
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
    gl.clearColor(...paper.map((c) => c / 255), 1);
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

  // The shape in whose part of the canvas a place (in CSS pixels) lies, and where in it, from -1 to 1.
  locate(x, y) {
    const ratio = canvas.width / canvas.clientWidth;
    const [px, py] = [x * ratio, canvas.height - y * ratio];
    const s = this.views.findIndex((v) => px >= v[0] && px < v[0] + v[2] && py >= v[1] && py < v[1] + v[3]);
    if (s < 0) return null;
    const [left, bottom, width, height] = this.views[s];
    return { s, place: [(2 * (px - left)) / width - 1, (2 * (py - bottom)) / height - 1] };
  }

  // The same place from the centre of its part, in half heights.
  fromCentre(x, y) {
    const found = this.locate(x, y);
    if (!found) return [0, 0];
    const [, , width, height] = this.views[found.s];
    return [(found.place[0] * width) / height, found.place[1]];
  }

  // What lies at a place of the canvas, in CSS pixels: {shape, kind, number} or null.
  pick(x, y) {
    const found = this.locate(x, y);
    if (!found) return null;
    const { s, place } = found;
    const cut = this.cut(s);
    const { slice } = this.surfaces[s];
    if (cut && slice) slice.stale = slice.take(cut) || slice.stale;
    const hit = pick(this.surfaces[s], this.frame(s), cut, ...place);
    return hit && { shape: s, ...hit };
  }
}
