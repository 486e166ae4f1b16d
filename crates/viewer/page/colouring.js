// What colour each vertex and voxel has: by parts, by regions, or by the components of a level set.

const OUTSIDE = [228, 228, 228]; // has not entered yet
const SPECK = [168, 178, 190]; // a component that belongs to no branch yet, or to no region

const mix = (c, to, share) => c.map((x, i) => x + share * (to[i] - x));
const WHITE = [255, 255, 255];

// For each branch, the branch that its component goes by when a share `level` has entered; -1 before it begins.
function componentsAt(tree, level) {
  const component = new Int32Array(tree.parents.length);
  for (let b = 0; b < component.length; b++) {
    const parent = tree.parents[b];
    if (tree.starts[b] > level + 1e-6) component[b] = -1;
    else if (parent !== b && tree.ends[b] <= level + 1e-6) component[b] = component[parent];
    else component[b] = b;
  }
  return component;
}

// A component keeps the colour of the last region it grew through, else of its largest part.
function branchColours(shape, t, level) {
  const tree = shape.trees[t];
  const largest = new Map();
  tree.parents.forEach((parent, b) => {
    const best = largest.get(parent);
    if (parent !== b && (best === undefined || tree.volumes[b] > tree.volumes[best])) largest.set(parent, b);
  });
  const marks = new Map();
  tree.regions.forEach((mark, r) => {
    if (!mark) return;
    if (!marks.has(mark[0])) marks.set(mark[0], []);
    marks.get(mark[0]).push([mark[1], r]);
  });
  marks.forEach((list) => list.sort((p, q) => p[0] - q[0]));
  return tree.parents.map((_, branch) => {
    let soon;
    for (let b = branch; b !== undefined; b = largest.get(b)) {
      const list = marks.get(b) ?? [];
      const passed = list.filter((mark) => mark[0] <= level + 1e-6);
      if (passed.length) return shape.regions[passed.at(-1)[1]].colour;
      soon ??= list[0];
    }
    return soon ? shape.regions[soon[1]].colour : SPECK;
  });
}

// Fills `colours` (RGBA) for the vertices ("vertex") or voxels ("voxel") of a shape.
function paint(colours, shape, kind, look) {
  const write = (i, c, alpha = 255) => {
    colours[4 * i] = c[0];
    colours[4 * i + 1] = c[1];
    colours[4 * i + 2] = c[2];
    colours[4 * i + 3] = alpha;
  };
  const count = colours.length / 4;
  if (look.mode === "level") {
    const tree = shape.trees[look.tree];
    const component = componentsAt(tree, look.level);
    const palette = branchColours(shape, look.tree, look.level);
    const entered = tree[`${kind}Entered`];
    const branch = tree[`${kind}Branch`];
    const limit = look.level * 65535 + 0.5;
    for (let i = 0; i < count; i++) {
      if (entered[i] > limit) write(i, OUTSIDE);
      else {
        const c = component[branch[i]];
        const colour = c < 0 ? SPECK : palette[c];
        write(i, c >= 0 && c === look.hoveredComponent ? mix(colour, WHITE, 0.4) : colour);
      }
    }
    return;
  }
  const list = shape[look.list];
  const labels = shape.labels[look.list][kind];
  const plain = [look.none, ...list.map((item) => item.colour)];
  const lit = [
    ...look.chosen.map((id) => [id, plain[id + 1], 255]),
    ...look.twins.map((id) => [id, mix(plain[id + 1], look.back, 0.5), Math.round(255 * look.others)]),
  ];
  const base = lit.length ? plain.map((c) => mix(c, look.back, 0.75)) : plain;
  const alpha = lit.length ? Math.round(255 * look.others) : 255;
  for (let i = 0; i < count; i++) write(i, base[labels[i] + 1], alpha);
  // The first of those that are lit prevails.
  for (const [id, colour, alpha] of lit.reverse()) {
    const inside = membership(shape, look.list, id, kind);
    for (let i = 0; i < count; i++) if (inside(i)) write(i, colour, alpha);
  }
  for (const id of look.hovered) {
    const inside = membership(shape, look.list, id, kind);
    const at = (i) => [0, 1, 2].map((a) => colours[4 * i + a]);
    for (let i = 0; i < count; i++) if (inside(i)) write(i, mix(at(i), WHITE, 0.4), 255);
  }
  for (const id of look.hidden) {
    const inside = membership(shape, look.list, id, kind);
    for (let i = 0; i < count; i++) if (inside(i)) colours[4 * i + 3] = 0;
  }
}
