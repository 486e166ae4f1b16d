// The plane that cuts a solid: the voxels of one layer as a texture.

class Slice {
  constructor(gl, shape) {
    this.gl = gl;
    this.grid = shape.grid;
    this.reach = shape.closed ? 3 : 0;
    const [nx, ny, nz] = this.grid.dims;
    this.voxel = new Int32Array(nx * ny * nz).fill(-1);
    this.grid.place.forEach((place, v) => (this.voxel[place] = v));
    this.colours = new Uint8Array(4 * this.grid.place.length);
    this.layer = [];
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
    }
  }

  // Takes the layer of a cut; true if it is another than before. The surface reaches beyond the
  // centres of its voxels, so up to `reach` voxels further in and outwards stand for those missing.
  take({ axis, at, side }) {
    const { dims, origin, spacing } = this.grid;
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const layer = Math.min(dims[axis] - 1, Math.max(0, Math.floor((at - origin[axis]) / spacing[axis])));
    const now = [axis, layer, side];
    if (now.every((x, i) => x === this.layer[i])) return false;
    this.layer = now;
    const deep = Array.from({ length: this.reach + 1 }, (_, i) => layer - i * side).filter((l) => l >= 0 && l < dims[axis]);
    const step = [1, dims[0], dims[0] * dims[1]];
    this.size = [dims[u], dims[v]];
    let texels = new Int32Array(dims[u] * dims[v]);
    for (let j = 0, i = 0; j < dims[v]; j++) {
      for (let k = 0; k < dims[u]; k++) {
        const below = deep.map((l) => this.voxel[l * step[axis] + k * step[u] + j * step[v]]);
        texels[i++] = below.find((voxel) => voxel >= 0) ?? -1;
      }
    }
    for (let round = 0; round < this.reach; round++) {
      const spread = texels.slice();
      for (let j = 0, i = 0; j < dims[v]; j++) {
        for (let k = 0; k < dims[u]; k++, i++) {
          if (texels[i] >= 0) continue;
          const around = [
            k > 0 ? texels[i - 1] : -1,
            k + 1 < dims[u] ? texels[i + 1] : -1,
            j > 0 ? texels[i - dims[u]] : -1,
            j + 1 < dims[v] ? texels[i + dims[u]] : -1,
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
    const { origin, spacing } = this.grid;
    const [k, j] = [1, 2].map((i) => {
      const a = (axis + i) % 3;
      return Math.floor((point[a] - origin[a]) / spacing[a]);
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
      pixels[4 * i + 3] = 255;
    });
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ...this.size, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  }

  draw(tool, frame, cut) {
    const { gl } = this;
    const { dims, origin, spacing } = this.grid;
    const [u, v] = [(cut.axis + 1) % 3, (cut.axis + 2) % 3];
    const vector = (a, x) => [0, 1, 2].map((i) => (i === a ? x : 0));
    const corner = origin.slice();
    corner[cut.axis] = cut.at;
    const turn = frame.turn;
    const facing = [0, 1, 2].map((i) => turn[3 * cut.axis + i] * cut.side);
    gl.useProgram(tool.program);
    gl.uniformMatrix3fv(tool.places.uTurn, false, turn);
    gl.uniform3fv(tool.places.uScale, frame.scale);
    gl.uniform2fv(tool.places.uShift, frame.shift);
    gl.uniform3fv(tool.places.uCorner, corner);
    gl.uniform3fv(tool.places.uAcross, vector(u, dims[u] * spacing[u]));
    gl.uniform3fv(tool.places.uAlong, vector(v, dims[v] * spacing[v]));
    gl.uniform3fv(tool.places.uFacing, facing[2] < 0 ? facing.map((x) => -x) : facing);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(tool.places.uSlice, 0);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}
