// Shaders. Vertices come from textures by their number, so that each triangle knows its corners and
// a change of colours is one small upload.

const ROW = 2048; // texels in a row of the data textures

const COMMON = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
ivec2 cell(int i) { return ivec2(i % ${ROW}, i / ${ROW}); }
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toScreen(vec3 l) {
  l = clamp(l, 0.0, 1.0);
  return mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, l));
}
// Key, fill and sky light, as in the pictures that the renderer draws.
vec3 lit(vec3 colour, vec3 n, float open) {
  vec2 wrap = 0.5 + 0.5 * vec2(dot(n, vec3(-0.424, 0.566, 0.707)), dot(n, vec3(0.811, 0.162, 0.562)));
  float sky = 0.5 + 0.5 * n.y;
  float diffuse = dot(vec2(0.62, 0.22), wrap * wrap) * (0.4 + 0.6 * open) + (0.20 + 0.16 * sky) * open * open;
  float gloss = 0.05 * pow(max(dot(n, vec3(-0.230, 0.306, 0.924)), 0.0), 24.0) * open;
  return colour * diffuse + gloss;
}
`;

const OPEN = `
// Whether a pixel is left open by what is this opaque: every so many of a square of 4 x 4 are.
bool open(float alpha) {
  const int order[16] = int[16](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);
  ivec2 p = ivec2(gl_FragCoord.xy) & 3;
  return alpha <= (float(order[4 * p.y + p.x]) + 0.5) / 16.0;
}
`;

const SURFACE_VERTEX = `${COMMON}
uniform sampler2D uPosition; // xyz, openness
uniform sampler2D uNormal;
uniform usampler2D uTriangle;
uniform mat3 uTurn;
uniform vec3 uScale;
uniform vec2 uShift;
uniform vec4 uCut; // what lies at dot(normal, p) > offset is taken away
flat out ivec3 vCorners;
out vec3 vShare;
out vec3 vNormal;
out vec3 vPlace;
out float vOpen;
out float vBeyond;
void main() {
  int t = gl_VertexID / 3;
  int c = gl_VertexID - 3 * t;
  vCorners = ivec3(texelFetch(uTriangle, cell(t), 0).xyz);
  vShare = vec3(equal(ivec3(c), ivec3(0, 1, 2)));
  vec4 p = texelFetch(uPosition, cell(vCorners[c]), 0);
  vNormal = uTurn * texelFetch(uNormal, cell(vCorners[c]), 0).xyz;
  vPlace = uTurn * p.xyz;
  vOpen = p.w;
  vBeyond = dot(uCut.xyz, p.xyz) - uCut.w;
  gl_Position = vec4(vPlace * uScale + vec3(uShift, 0.0), 1.0);
}`;

const SURFACE_FRAGMENT = `${COMMON}${OPEN}uniform sampler2D uColour;
flat in ivec3 vCorners;
in vec3 vShare;
in float vBeyond;
vec4 corner(int i) { return texelFetch(uColour, cell(vCorners[i]), 0); }
// The corner whose colour prevails: borders between colours are straight lines across triangles.
int prevailing(out float margin) {
  vec4 a = corner(0), b = corner(1), c = corner(2);
  vec3 w = vShare;
  vec3 total = vec3(
    w.x + (a == b ? w.y : 0.0) + (a == c ? w.z : 0.0),
    w.y + (b == a ? w.x : 0.0) + (b == c ? w.z : 0.0),
    w.z + (c == a ? w.x : 0.0) + (c == b ? w.y : 0.0));
  int best = total.x >= total.y && total.x >= total.z ? 0 : total.y >= total.z ? 1 : 2;
  vec4 mine = best == 0 ? a : best == 1 ? b : c;
  float other = max(max(mine == a ? 0.0 : total.x, mine == b ? 0.0 : total.y), mine == c ? 0.0 : total.z);
  margin = a == b && b == c ? 1.0 : total[best] - other;
  return best;
}
in vec3 vNormal;
in vec3 vPlace;
in float vOpen;
uniform bool uWhole; // what is hidden counts as well
uniform bool uSolid; // nothing shows the inside: a face seen from behind is a fold
out vec4 oColour;
void main() {
  if (vBeyond > 0.0) discard;
  vec3 face = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  vec3 n = normalize(vNormal);
  float margin;
  int best = prevailing(margin);
  if (!uWhole && open(corner(best).a)) discard;
  float line = 1.0 - smoothstep(0.6, 1.4, margin / max(fwidth(margin), 1e-4));
  bool back = !gl_FrontFacing && !uSolid;
  if (n.z < 0.0) n = -n;
  if (dot(n, face) < 0.64 && (gl_FrontFacing || !uSolid)) n = face; // a crease
  vec3 colour = toLinear(corner(best).rgb);
  float clear = back ? 0.5 : 1.0 - 0.8 * (1.0 - vOpen);
  vec3 light = lit(colour, n, clear) * (back ? 0.6 : 1.0);
  light *= 1.0 - 0.4 * (1.0 - smoothstep(0.0, 0.3, n.z)); // a soft outline
  light *= margin < 1.0 ? 1.0 - 0.45 * line : 1.0;
  oColour = vec4(toScreen(light), 1.0);
}`;

const SLICE_VERTEX = `${COMMON}
uniform mat3 uTurn;
uniform vec3 uScale;
uniform vec2 uShift;
uniform vec3 uCorner;
uniform vec3 uAcross;
uniform vec3 uAlong;
out vec2 vPlace;
void main() {
  vPlace = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec3 p = uTurn * (uCorner + vPlace.x * uAcross + vPlace.y * uAlong);
  gl_Position = vec4(p * uScale + vec3(uShift, 0.0), 1.0);
}`;

const SLICE_FRAGMENT = `${COMMON}${OPEN}uniform sampler2D uSlice;
uniform vec3 uFacing;
in vec2 vPlace;
out vec4 oColour;
void main() {
  ivec2 size = textureSize(uSlice, 0);
  ivec2 at = min(ivec2(vPlace * vec2(size)), size - 1);
  vec4 colour = texelFetch(uSlice, at, 0);
  if (open(colour.a)) discard;
  oColour = vec4(toScreen(lit(toLinear(colour.rgb), uFacing, 1.0)), 1.0);
}`;

function program(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    const logs = gl.getAttachedShaders(program).map((s) => gl.getShaderInfoLog(s));
    throw new Error(`shader: ${gl.getProgramInfoLog(program)} ${logs.join(" ")}`);
  }
  const places = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(program, i);
    places[name] = gl.getUniformLocation(program, name);
  }
  return { program, places };
}
