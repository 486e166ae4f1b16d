// Draws a frame. Light is that of flat triangles, from the derivatives of places on the screen.

const VERTEX = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 first;
layout(location = 2) in vec4 second;
layout(location = 3) in vec4 third;
uniform mat3 axes;
uniform vec3 scale;
uniform vec2 shift;
out vec3 seen;
out vec3 weight;
flat out vec3 colours[3];
void main() {
  seen = axes * place;
  int corner = gl_VertexID % 3;
  weight = vec3(corner == 0, corner == 1, corner == 2);
  colours[0] = first.rgb;
  colours[1] = second.rgb;
  colours[2] = third.rgb;
  gl_Position = vec4(seen.xy * scale.xy + shift, -seen.z * scale.z, 1);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 seen;
in vec3 weight;
flat in vec3 colours[3];
out vec4 pixel;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 colour = weight.x >= weight.y && weight.x >= weight.z ? colours[0] : weight.y >= weight.z ? colours[1] : colours[2];
  float light = 0.5 + 0.5 * max(dot(normal, normalize(vec3(-0.35, 0.5, 0.8))), 0.0);
  pixel = vec4(colour * light, 1);
}`;

class Painter {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    this.gl = gl;
    if (!gl) return;
    const shader = (kind, text) => {
      const made = gl.createShader(kind);
      gl.shaderSource(made, text);
      gl.compileShader(made);
      return made;
    };
    this.program = gl.createProgram();
    gl.attachShader(this.program, shader(gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(this.program, shader(gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.program));
    gl.bindVertexArray(gl.createVertexArray());
    this.places = gl.createBuffer();
    this.colours = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colours);
    for (let k = 0; k < 3; k++) {
      gl.enableVertexAttribArray(1 + k);
      gl.vertexAttribPointer(1 + k, 4, gl.UNSIGNED_BYTE, true, 12, 4 * k);
    }
    gl.enable(gl.DEPTH_TEST);
  }

  set(corners, colours) {
    const gl = this.gl;
    if (!gl) return;
    this.count = corners.length / 3;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colours);
    gl.bufferData(gl.ARRAY_BUFFER, colours, gl.DYNAMIC_DRAW);
  }

  // Half heights of the picture for a unit of length.
  scale(camera, radius) {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    return (camera.zoom * 0.95 * Math.min(1, w / h)) / radius;
  }

  draw(axes, camera, radius) {
    const gl = this.gl;
    if (!gl) return;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const { clientWidth: w, clientHeight: h } = this.canvas;
    this.canvas.width = Math.max(1, Math.round(ratio * w));
    this.canvas.height = Math.max(1, Math.round(ratio * h));
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    const s = this.scale(camera, radius);
    const uniform = (name) => gl.getUniformLocation(this.program, name);
    gl.uniformMatrix3fv(uniform("axes"), true, axes.flat());
    gl.uniform3f(uniform("scale"), (s * h) / w, s, 0.5 / radius);
    gl.uniform2f(uniform("shift"), (camera.shift[0] * h) / w, camera.shift[1]);
    gl.drawArrays(gl.TRIANGLES, 0, this.count);
  }
}
