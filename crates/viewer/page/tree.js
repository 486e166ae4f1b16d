// The component tree as a picture: branches grow downwards as vertices enter, and join where they merge.

const SVG = "http://www.w3.org/2000/svg";

class TreePicture {
  constructor(svg, actions) {
    this.svg = svg;
    this.actions = actions;
    const drag = (event) => {
      if (event.buttons === 0 || event.target.classList.contains("region")) return;
      const box = svg.getBoundingClientRect();
      actions.level(Math.min(1, Math.max(0, (event.clientY - box.top - this.top) / (box.height - 2 * this.top))));
    };
    this.top = 10;
    svg.addEventListener("pointerdown", (event) => {
      // Capturing would keep the click from a region's mark.
      if (event.target.classList.contains("region")) return;
      svg.setPointerCapture?.(event.pointerId);
      drag(event);
    });
    svg.addEventListener("pointermove", drag);
  }

  make(kind, attributes) {
    const node = document.createElementNS(SVG, kind);
    Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
    return node;
  }

  show(shape, t, none, paper) {
    const tree = shape.trees[t];
    const width = this.svg.clientWidth || 340;
    const height = this.svg.clientHeight || 220;
    this.height = height;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.replaceChildren();
    const count = tree.parents.length;
    const children = Array.from({ length: count }, () => []);
    const roots = [];
    tree.parents.forEach((parent, b) => (parent === b ? roots : children[parent]).push(b));
    // The square root lets thin branches be seen.
    const span = tree.volumes.map((volume) => Math.sqrt(Math.max(volume, 0)) + 0.02);
    for (let b = count - 1; b >= 0; b--) {
      span[b] = Math.max(span[b], children[b].reduce((sum, c) => sum + span[c], 0));
    }
    const left = new Array(count);
    const place = (siblings, start, room) => {
      const used = siblings.reduce((sum, b) => sum + span[b], 0);
      let x = start + (room - used) / 2;
      for (const b of siblings) {
        left[b] = x;
        x += span[b];
      }
      return [start + (room - used) / 2, x];
    };
    const whole = roots.reduce((sum, b) => sum + span[b], 0);
    place(roots, 0, whole);
    const x = (v) => 8 + (v / whole) * (width - 16);
    const y = (share) => this.y(share);
    const colours = tree.parents.map((_, b) => this.colour(shape, tree, b, none, paper));
    for (let b = 0; b < count; b++) {
      const middle = left[b] + span[b] / 2;
      const tip = [middle - 0.12 * span[b], middle + 0.12 * span[b]];
      const [from, to] = children[b].length ? place(children[b], left[b], span[b]) : tip;
      const corners = [
        [x(from), y(tree.starts[b])],
        [x(to), y(tree.starts[b])],
        [x(left[b] + span[b]), y(tree.ends[b])],
        [x(left[b]), y(tree.ends[b])],
      ];
      const points = corners.map((p) => p.map((v) => v.toFixed(1)).join(",")).join(" ");
      this.svg.append(this.make("polygon", { class: "branch", points, fill: css(colours[b]) }));
    }
    this.line = this.make("line", { class: "level", x1: 0, x2: width });
    this.svg.append(this.line);
    this.marks = new Map();
    tree.regions.forEach((mark, id) => {
      if (!mark) return;
      const [branch, entered] = mark;
      const circle = this.make("circle", {
        class: "region",
        cx: x(left[branch] + span[branch] / 2).toFixed(1),
        cy: y(entered).toFixed(1),
        r: 5,
        fill: css(shape.regions[id].colour),
        tabindex: 0,
        role: "button",
        "aria-label": `Region ${id}`,
        "aria-pressed": "false",
      });
      circle.addEventListener("click", () => this.actions.choose(id));
      circle.addEventListener("pointerenter", () => this.actions.hover(id));
      circle.addEventListener("pointerleave", () => this.actions.hover(null));
      circle.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        this.actions.choose(id);
      });
      this.marks.set(id, circle);
      this.svg.append(circle);
    });
    this.label(width);
  }

  // The numbers of the regions, beside their marks, as far as they fit.
  label(width) {
    const size = 12;
    const boxes = [...this.marks.values()].map((circle) => {
      const [x, y] = ["cx", "cy"].map((name) => Number(circle.getAttribute(name)));
      return [x - 6, y - 6, x + 6, y + 6];
    });
    for (const [id, circle] of this.marks) {
      const [x, y] = ["cx", "cy"].map((name) => Number(circle.getAttribute(name)));
      const wide = 7 * String(id).length;
      const places = [[8, -size / 2], [-8 - wide, -size / 2], [-wide / 2, -8 - size], [-wide / 2, 8]];
      for (const [dx, dy] of places) {
        const box = [x + dx, y + dy, x + dx + wide, y + dy + size];
        const apart = (other) => box[2] <= other[0] || box[0] >= other[2] || box[3] <= other[1] || box[1] >= other[3];
        if (box[0] < 0 || box[2] > width || box[1] < 0 || box[3] > this.height || !boxes.every(apart)) continue;
        boxes.push(box);
        const text = this.make("text", { x: box[0] + wide / 2, y: box[3] - 2, "text-anchor": "middle", "aria-hidden": "true" });
        text.textContent = String(id);
        this.svg.append(text);
        break;
      }
    }
  }

  // The colour of the largest region on a branch, lightened: the marks stand out.
  colour(shape, tree, branch, none, paper) {
    const on = tree.regions.flatMap((mark, id) => (mark && mark[0] === branch ? [id] : []));
    const largest = on.sort((p, q) => shape.regions[q].fraction - shape.regions[p].fraction)[0];
    return mix(largest === undefined ? none : shape.regions[largest].colour, paper, isDark() ? 0.6 : 0.45);
  }

  y(share) {
    return this.top + share * (this.height - 2 * this.top);
  }

  update(level, chosen) {
    if (!this.line) return;
    for (const end of ["y1", "y2"]) this.line.setAttribute(end, this.y(level).toFixed(1));
    this.marks.forEach((circle, id) => {
      circle.classList.toggle("on", chosen.includes(id));
      circle.setAttribute("aria-pressed", String(chosen.includes(id)));
    });
  }
}
