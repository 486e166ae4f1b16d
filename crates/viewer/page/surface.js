// Drawing a shape: its surface, and what a cut shows.

// Area-weighted vertex normals.
function vertexNormals({ position: p, triangle }) {
  const sums = new Float32Array(p.length);
  for (let t = 0; t < triangle.length; t += 3) {
    const [a, b, c] = [3 * triangle[t], 3 * triangle[t + 1], 3 * triangle[t + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const v of [a, b, c]) for (let i = 0; i < 3; i++) sums[v + i] += n[i];
  }
  for (let v = 0; v < sums.length; v += 3) {
    const length = Math.hypot(sums[v], sums[v + 1], sums[v + 2]) || 1;
    for (let i = 0; i < 3; i++) sums[v + i] /= length;
  }
  return sums;
}

class Surface {
  constructor(gl, shape) {
    this.gl = gl;
    this.shape = shape;
    const count = shape.position.length / 3;
    const normals = vertexNormals(shape);
    const place = new Float32Array(4 * count);
    const normal = new Float32Array(4 * count);
    for (let v = 0; v < count; v++) {
      for (let a = 0; a < 3; a++) {
        place[4 * v + a] = shape.position[3 * v + a];
        normal[4 * v + a] = normals[3 * v + a];
      }
      place[4 * v + 3] = shape.open[v] / 255;
    }
    const triangles = shape.triangle.length / 3;
    const corners = new Uint32Array(4 * triangles);
    for (let t = 0; t < triangles; t++) {
      for (let i = 0; i < 3; i++) corners[4 * t + i] = shape.triangle[3 * t + i];
    }
    this.colours = new Uint8Array(4 * count);
    this.textures = {
      uPosition: this.texture(gl.RGBA32F, gl.RGBA, gl.FLOAT, place),
      uNormal: this.texture(gl.RGBA32F, gl.RGBA, gl.FLOAT, normal),
      uTriangle: this.texture(gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT, corners),
      uColour: this.texture(gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, this.colours),
    };
    this.count = 3 * triangles;
    this.slice = shape.grid && new Slice(gl, shape);
  }

  // A texture of four-part texels, ROW in a row.
  texture(inside, format, type, data) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
    }
    const rows = Math.max(1, Math.ceil(data.length / 4 / ROW));
    const padded = new data.constructor(4 * ROW * rows);
    padded.set(data);
    gl.texImage2D(gl.TEXTURE_2D, 0, inside, ROW, rows, 0, format, type, padded);
    return texture;
  }

  uploadColours() {
    const { gl } = this;
    this.opaque = this.colours.every((value, i) => i % 4 < 3 || value === 255);
    const whole = 4 * ROW * Math.max(1, Math.ceil(this.colours.length / 4 / ROW));
    this.padded ??= new Uint8Array(whole);
    this.padded.set(this.colours);
    gl.bindTexture(gl.TEXTURE_2D, this.textures.uColour);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, whole / 4 / ROW, gl.RGBA, gl.UNSIGNED_BYTE, this.padded);
  }

  // Draws with the camera's frame {turn, scale, shift}; `cut` is {axis, side, at} or null.
  draw(tools, frame, cut) {
    const { gl } = this;
    const main = tools.surface;
    const plane = [0, 0, 0, 1];
    if (cut) {
      plane[cut.axis] = cut.side;
      plane[3] = cut.side * cut.at;
    }
    gl.useProgram(main.program);
    gl.uniformMatrix3fv(main.places.uTurn, false, frame.turn);
    gl.uniform3fv(main.places.uScale, frame.scale);
    gl.uniform2fv(main.places.uShift, frame.shift);
    gl.uniform4fv(main.places.uCut, plane);
    Object.entries(this.textures).forEach(([name, texture], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(main.places[name] ?? null, unit);
    });
    gl.activeTexture(gl.TEXTURE0);
    const filled = cut && this.slice && this.shape.closed;
    gl.uniform1i(main.places.uWhole, filled ? 1 : 0);
    gl.uniform1i(main.places.uSolid, this.shape.closed && !cut && this.opaque ? 1 : 0);
    if (filled) {
      // Behind a place where the cut is seen, back and front faces of what is kept do not balance.
      gl.colorMask(false, false, false, false);
      gl.depthMask(false);
      gl.disable(gl.DEPTH_TEST);
      gl.enable(gl.STENCIL_TEST);
      gl.stencilFunc(gl.ALWAYS, 0, 255);
      gl.stencilOpSeparate(gl.FRONT, gl.KEEP, gl.KEEP, gl.DECR_WRAP);
      gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.INCR_WRAP);
      gl.drawArrays(gl.TRIANGLES, 0, this.count);
      gl.colorMask(true, true, true, true);
      gl.depthMask(true);
      gl.enable(gl.DEPTH_TEST);
      gl.disable(gl.STENCIL_TEST);
      gl.uniform1i(main.places.uWhole, 0);
    }
    gl.drawArrays(gl.TRIANGLES, 0, this.count);
    if (cut && this.slice) {
      if (filled) {
        gl.enable(gl.STENCIL_TEST);
        gl.stencilFunc(gl.NOTEQUAL, 0, 255);
        gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
      }
      this.slice.draw(tools.slice, frame, cut);
      gl.disable(gl.STENCIL_TEST);
    }
  }
}
