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
