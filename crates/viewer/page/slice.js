// The plane that cuts a solid: its voxels as a texture. Planes run along the axes of the world, the axes of the grid may
// run any way; so the plane is sampled. Along the world's axes that is the voxels' layer, else there are FINE samples a voxel.

const FINE = 4;

// For each place of a grid, x fastest, the number of its voxel; -1 for none.
function voxelsByPlace(grid) {
  if (!grid.byPlace) {
    grid.byPlace = new Int32Array(grid.dims.reduce((n, d) => n * d, 1)).fill(-1);
    grid.place.forEach((place, v) => (grid.byPlace[place] = v));
  }
  return grid.byPlace;
}

class Slice {
  constructor(gl, shape) {
    this.gl = gl;
    this.grid = shape.grid;
    this.reach = shape.closed ? 3 : 0;
    this.sample();
    this.voxel = voxelsByPlace(this.grid);
    this.colours = new Uint8Array(4 * this.grid.place.length);
    this.layer = [];
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
    }
  }

  // The box of samples around the grid: its low corner, step and count along x, y and z.
  sample() {
    const { dims, origin, spacing, directions } = this.grid;
    const edge = (a, w) => directions[a][w] * spacing[a] * dims[a];
    const sum = (w, part) => [0, 1, 2].reduce((s, a) => s + part(edge(a, w), 0), origin[w]);
    const low = [0, 1, 2].map((w) => sum(w, Math.min));
    const high = [0, 1, 2].map((w) => sum(w, Math.max));
    const along = directions.every((d) => d.filter((x) => x !== 0).length === 1);
    const fine = along ? 1 : FINE;
    this.reach *= fine;
    const edgeAlong = (w) => Math.min(...[0, 1, 2].map((a) => spacing[a] / Math.abs(directions[a][w])));
    const step = [0, 1, 2].map((w) => edgeAlong(w) / fine);
    // What is a rounding error more than a whole number of steps is that number.
    const count = [0, 1, 2].map((w) => Math.max(1, Math.ceil((high[w] - low[w]) / step[w] - 1e-6)));
    Object.assign(this, { low, step, count });
  }

  // The voxel around a place in the world; -1 for none.
  voxelOf(place) {
    const { dims, origin, spacing, directions } = this.grid;
    let number = 0;
    for (let a = 2; a >= 0; a--) {
      const along = [0, 1, 2].reduce((s, w) => s + directions[a][w] * (place[w] - origin[w]), 0);
      const index = Math.floor(along / spacing[a]);
      if (index < 0 || index >= dims[a]) return -1;
      number = number * dims[a] + index;
    }
    return this.voxel[number];
  }

  // Takes the layer of a cut; true if it is another than before. The surface reaches beyond the
  // centres of its voxels, so up to `reach` voxels further in and outwards stand for those missing.
  take({ axis, at, side }) {
    const { low, step, count } = this;
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const layer = Math.min(count[axis] - 1, Math.max(0, Math.floor((at - low[axis]) / step[axis])));
    const now = [axis, layer, side];
    if (now.every((x, i) => x === this.layer[i])) return false;
    this.layer = now;
    const deep = Array.from({ length: this.reach + 1 }, (_, i) => layer - i * side).filter((l) => l >= 0 && l < count[axis]);
    this.size = [count[u], count[v]];
    let texels = new Int32Array(count[u] * count[v]).fill(-1);
    const place = [0, 0, 0];
    for (let j = 0, i = 0; j < count[v]; j++) {
      place[v] = low[v] + (j + 0.5) * step[v];
      for (let k = 0; k < count[u]; k++, i++) {
        place[u] = low[u] + (k + 0.5) * step[u];
        for (let d = 0; d < deep.length && texels[i] < 0; d++) {
          place[axis] = low[axis] + (deep[d] + 0.5) * step[axis];
          texels[i] = this.voxelOf(place);
        }
      }
    }
    for (let round = 0; round < this.reach; round++) {
      const spread = texels.slice();
      for (let j = 0, i = 0; j < count[v]; j++) {
        for (let k = 0; k < count[u]; k++, i++) {
          if (texels[i] >= 0) continue;
          const around = [
            k > 0 ? texels[i - 1] : -1,
            k + 1 < count[u] ? texels[i + 1] : -1,
            j > 0 ? texels[i - count[u]] : -1,
            j + 1 < count[v] ? texels[i + count[u]] : -1,
          ];
          spread[i] = Math.max(...around);
        }
      }
      texels = spread;
    }
    this.texels = texels;
    return true;
  }

  // The voxel that the layer shows at a point; -1 for none.
  voxelAt({ axis }, point) {
    const [k, j] = [1, 2].map((i) => {
      const a = (axis + i) % 3;
      return Math.floor((point[a] - this.low[a]) / this.step[a]);
    });
    const within = k >= 0 && j >= 0 && k < this.size[0] && j < this.size[1];
    return within ? this.texels[j * this.size[0] + k] : -1;
  }

  upload() {
    const { gl } = this;
    const pixels = new Uint8Array(4 * this.texels.length);
    this.texels.forEach((v, i) => {
      if (v < 0) return;
      for (let a = 0; a < 3; a++) pixels[4 * i + a] = this.colours[4 * v + a];
      pixels[4 * i + 3] = this.colours[4 * v + 3];
    });
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ...this.size, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  }

  draw(tool, frame, cut) {
    const { gl, low, step, count } = this;
    const [u, v] = [(cut.axis + 1) % 3, (cut.axis + 2) % 3];
    const vector = (a, x) => [0, 1, 2].map((i) => (i === a ? x : 0));
    const corner = low.slice();
    corner[cut.axis] = cut.at;
    const turn = frame.turn;
    const facing = [0, 1, 2].map((i) => turn[3 * cut.axis + i] * cut.side);
    gl.useProgram(tool.program);
    gl.uniformMatrix3fv(tool.places.uTurn, false, turn);
    gl.uniform3fv(tool.places.uScale, frame.scale);
    gl.uniform2fv(tool.places.uShift, frame.shift);
    gl.uniform3fv(tool.places.uCorner, corner);
    gl.uniform3fv(tool.places.uAcross, vector(u, count[u] * step[u]));
    gl.uniform3fv(tool.places.uAlong, vector(v, count[v] * step[v]));
    gl.uniform3fv(tool.places.uFacing, facing[2] < 0 ? facing.map((x) => -x) : facing);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(tool.places.uSlice, 0);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}
