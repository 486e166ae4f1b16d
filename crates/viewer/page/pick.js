// What lies below a place of the picture, found as the renderer finds it: the nearest triangle that
// the line of sight meets, or the cut.

// What is hidden is not met. `x` and `y` are picture coordinates from -1 to 1. Gives {kind, number} of a vertex or voxel, or null.
function pick(surface, frame, cut, x, y) {
  const { shape, slice, colours } = surface;
  const { position, triangle } = shape;
  const { turn, scale, shift } = frame;
  const count = position.length / 3;
  const screen = new Float32Array(3 * count);
  for (let v = 0; v < count; v++) {
    for (let i = 0; i < 3; i++) {
      let sum = 0;
      for (let a = 0; a < 3; a++) sum += turn[3 * a + i] * position[3 * v + a];
      screen[3 * v + i] = i < 2 ? sum * scale[i] + shift[i] : sum;
    }
  }
  const beyond = (v) => (cut ? cut.side * (position[3 * v + cut.axis] - cut.at) : -1);
  let nearest = -Infinity;
  let found = null;
  let winding = 0;
  for (let t = 0; t < triangle.length; t += 3) {
    const [a, b, c] = [3 * triangle[t], 3 * triangle[t + 1], 3 * triangle[t + 2]];
    const [ax, ay] = [screen[a] - x, screen[a + 1] - y];
    const [bx, by] = [screen[b] - x, screen[b + 1] - y];
    const [cx, cy] = [screen[c] - x, screen[c + 1] - y];
    // Most triangles lie on one side of the line of sight.
    if ((ax > 0 && bx > 0 && cx > 0) || (ax < 0 && bx < 0 && cx < 0)) continue;
    if ((ay > 0 && by > 0 && cy > 0) || (ay < 0 && by < 0 && cy < 0)) continue;
    const w = [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx];
    const inside = (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) || (w[0] <= 0 && w[1] <= 0 && w[2] <= 0);
    const area = w[0] + w[1] + w[2];
    if (!inside || area === 0) continue;
    const corners = [a / 3, b / 3, c / 3];
    const mean = (value) => corners.reduce((sum, v, i) => sum + (w[i] / area) * value(v), 0);
    if (mean(beyond) > 0) {
      winding += Math.sign(area);
      continue;
    }
    const depth = mean((v) => screen[3 * v + 2]);
    const most = w.map(Math.abs);
    const number = corners[most.indexOf(Math.max(...most))];
    if (depth > nearest && colours[4 * number + 3] > 0) {
      nearest = depth;
      found = { kind: "vertex", number };
    }
  }
  // The cut is seen from its open side, where the part taken away was solid.
  const toward = cut ? turn[3 * cut.axis + 2] * cut.side : 0;
  if (!slice || toward <= 0 || (shape.closed && winding === 0)) return found;
  const axes = [0, 1, 2].map((i) => [0, 1, 2].map((a) => turn[3 * a + i]));
  const level = [(x - shift[0]) / scale[0], (y - shift[1]) / scale[1]];
  const flat = [0, 1, 2].map((a) => level[0] * axes[0][a] + level[1] * axes[1][a]);
  const depth = (cut.side * (cut.at - flat[cut.axis])) / toward;
  const voxel = slice.voxelAt(cut, [0, 1, 2].map((a) => flat[a] + depth * axes[2][a]));
  return voxel >= 0 && depth > nearest && slice.colours[4 * voxel + 3] > 0 ? { kind: "voxel", number: voxel } : found;
}
