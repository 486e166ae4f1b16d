// What colour each vertex and voxel has: by regions, or by the components of a level set.

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
  const write = (i, c) => {
    colours[4 * i] = c[0];
    colours[4 * i + 1] = c[1];
    colours[4 * i + 2] = c[2];
    colours[4 * i + 3] = 255;
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
  const label = kind === "vertex" ? shape.label : shape.grid.label;
  const plain = [look.none, ...shape.regions.map((r) => r.colour)];
  const faded = plain.map((c) => mix(c, WHITE, 0.75));
  const sets = (ids) => ids.map((id) => [shape.regions[id][`${kind}Set`], plain[id + 1]]);
  const chosen = sets(look.chosen);
  const lit = [...chosen, ...sets(look.twins).map(([set, colour]) => [set, mix(colour, WHITE, 0.5)])];
  const hovered = sets(look.hovered);
  for (let i = 0; i < count; i++) {
    const inside = lit.find(([set]) => hasBit(set, i));
    let colour = inside ? inside[1] : (lit.length ? faded : plain)[label[i] + 1];
    if (hovered.some(([set]) => hasBit(set, i))) colour = mix(colour, WHITE, 0.4);
    write(i, colour);
  }
}
