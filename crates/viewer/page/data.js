// The page's data: a head in JSON, and one block of packed arrays that it points into.

function readData() {
  const head = JSON.parse(document.getElementById("head").textContent);
  const text = atob(document.getElementById("arrays").textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const kinds = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array, i16: Int16Array, u8: Uint8Array };
  // Replaces each {type, start, length} by the array it stands for.
  const unpack = (value) => {
    if (Array.isArray(value)) return value.map(unpack);
    if (value === null || typeof value !== "object") return value;
    if (value.type in kinds) return new kinds[value.type](bytes.buffer, value.start, value.length);
    return Object.fromEntries(Object.entries(value).map(([key, v]) => [key, unpack(v)]));
  };
  const data = unpack(head);
  for (const shape of data.shapes) {
    const { grid } = shape;
    shape.labels = {
      parts: { vertex: shape.part, voxel: grid?.part },
      regions: { vertex: shape.label, voxel: grid?.label },
    };
    shape.parts ??= [];
    shape.trees.forEach((tree) => spread(tree, shape));
    for (const region of shape.regions) region.twins = region.twin === null ? [] : [region.twin];
    shape.low = [Infinity, Infinity, Infinity];
    shape.high = [-Infinity, -Infinity, -Infinity];
    for (const v of shape.triangle) {
      for (let a = 0; a < 3; a++) {
        const x = shape.position[3 * v + a];
        if (x < shape.low[a]) shape.low[a] = x;
        if (x > shape.high[a]) shape.high[a] = x;
      }
    }
    shape.radius = 0.5 * Math.hypot(...[0, 1, 2].map((a) => shape.high[a] - shape.low[a]));
  }
  return data;
}

// A tree's branch and share entered for each vertex and voxel. Where there are voxels, the page has them of voxels, and a
// vertex enters with its voxel; without one it never enters.
function spread(tree, { vertexVoxel }) {
  if (!vertexVoxel) {
    Object.assign(tree, { vertexBranch: tree.branch, vertexEntered: tree.entered });
    return;
  }
  Object.assign(tree, { voxelBranch: tree.branch, voxelEntered: tree.entered });
  tree.vertexBranch = new Uint32Array(vertexVoxel.length);
  tree.vertexEntered = new Uint32Array(vertexVoxel.length).fill(0x10000);
  vertexVoxel.forEach((next, v) => {
    if (next === 0) return;
    tree.vertexBranch[v] = tree.branch[next - 1];
    tree.vertexEntered[v] = tree.entered[next - 1];
  });
}

// Whether a vertex ("vertex") or voxel ("voxel") is in a region or part, as a function of its number.
function membership(shape, list, id, kind) {
  if (list === "parts") {
    const labels = shape.labels.parts[kind];
    return (i) => labels[i] === id;
  }
  const set = shape.regions[id][`${kind}Set`];
  return (i) => hasBit(set, i) === 1;
}

// For each region, the part that nearly all of it is in; -1 where it is in several.
function partsOfRegions(shape) {
  const kind = shape.grid ? "voxel" : "vertex";
  const labels = shape.labels.parts[kind];
  return shape.regions.map((region, id) => {
    const inside = membership(shape, "regions", id, kind);
    const counts = new Array(shape.parts.length).fill(0);
    let all = 0;
    labels.forEach((label, i) => {
      if (!inside(i)) return;
      all += 1;
      if (label >= 0) counts[label] += 1;
    });
    return counts.findIndex((count) => count > 0 && count >= 0.9 * all);
  });
}

const hasBit = (set, i) => (set[i >> 3] >> (i & 7)) & 1;

// Four significant digits or another number of them, without needless zeros; null stands for infinity.
function show(x, digits = 4) {
  if (x === null || x === undefined) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  return size >= 1e5 || size < 1e-3 ? x.toExponential(digits - 1) : String(Number(x.toPrecision(digits)));
}

// A side with its sign; the middle has none.
function showSide(x) {
  if (x === null) return "–";
  const text = x.toFixed(2);
  return x > 0 && Number(text) !== 0 ? `+${text}` : text.replace("-0.00", "0.00");
}

const percent = (x, digits) => `${show(100 * x, digits)} %`;
const css = (c) => `rgb(${c[0]}, ${c[1]}, ${c[2]})`;
