// What is drawn over the shapes: how long a length is, where the axes point; and a picture of all that is seen.

const AXES = [["x", "#d32f2f"], ["y", "#2e8b2e"], ["z", "#2f6fde"]];

// The longest of 1, 2, 5, 10, ... that is at most this long.
function roundLength(most) {
  const ten = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((n) => n * ten <= most * (1 + 1e-9)) * ten;
}

// The length of the scale bar, in the shape's units, and in CSS pixels.
function scaleBar() {
  const pixels = (renderer.unit() * canvas.clientHeight) / 2 / (renderer.views.length > 1 && canvas.height > canvas.width ? renderer.views.length : 1);
  const length = roundLength(Math.min(150, canvas.clientWidth / 4) / pixels);
  return { length, pixels: length * pixels };
}

function overlay() {
  const { length, pixels } = scaleBar();
  byId("bar").style.width = `${pixels}px`;
  byId("bar-text").textContent = show(length);
  byId("scale").setAttribute("aria-label", `The bar is ${show(length)} long, in the shape's units`);
  byId("axes").toggleAttribute("hidden", !state.axes);
  if (!state.axes) return;
  // Shapes that look elsewhere among their axes have axes of their own, in the order of the shapes.
  const fronts = data.shapes.map((shape) => shape.front ?? 0);
  const near = (front) => Math.cos(((front - fronts[0]) * Math.PI) / 180) > 0.999;
  const shown = fronts.every(near) ? fronts.slice(0, 1) : fronts;
  byId("axes").setAttribute("width", 80 * shown.length);
  byId("axes").replaceChildren(...shown.flatMap((front, i) => axisLines(camera.axes(front), 40 + 80 * i)));
}

// The axes seen from here, the one that points away first, about a place across.
function axisLines(axes, middle) {
  const make = (kind, attributes, text = "") => {
    const node = document.createElementNS(SVG, kind);
    Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
    node.textContent = text;
    return node;
  };
  const order = [0, 1, 2].sort((a, b) => axes[2][a] - axes[2][b]);
  return order.flatMap((a) => {
    const [name, stroke] = AXES[a];
    const [x, y] = [axes[0][a], -axes[1][a]];
    const line = make("line", { x1: middle, y1: 40, x2: middle + 24 * x, y2: 40 + 24 * y, stroke, "stroke-width": 3, "stroke-linecap": "round" });
    return [line, make("text", { x: middle + 33 * x, y: 44 + 33 * y, "text-anchor": "middle" }, name)];
  });
}

function setAxes(on) {
  state.axes = on;
  byId("axes-button").setAttribute("aria-pressed", String(on));
  redraw();
}

// The canvas and what lies over it, as one picture in as many pixels as the screen has there.
function picture() {
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [canvas.width, canvas.height];
  const pen = sheet.getContext("2d");
  const ratio = canvas.width / canvas.clientWidth;
  // What was drawn is there only until the browser has shown it.
  renderer.draw();
  pen.drawImage(canvas, 0, 0);
  pen.scale(ratio, ratio);
  pen.lineCap = "round";
  pen.fillStyle = pen.strokeStyle = getComputedStyle(canvas).color;
  pen.font = "14px system-ui, sans-serif";
  const frame = canvas.getBoundingClientRect();
  const at = (node) => {
    const box = node.getBoundingClientRect();
    return [box.left - frame.left, box.top - frame.top, box.width, box.height];
  };
  const [x, y, width, height] = at(byId("bar"));
  pen.fillRect(x, y + height - 2, width, 2);
  pen.fillRect(x, y, 2, height);
  pen.fillRect(x + width - 2, y, 2, height);
  pen.textAlign = "right";
  pen.fillText(byId("bar-text").textContent, x + width, y - 4);
  pen.textAlign = "left";
  byId("names").childNodes.forEach((name) => {
    const [left, top] = at(name);
    pen.fillText(name.textContent, left + 14, top + 22);
  });
  if (state.axes) {
    const [left, top] = at(byId("axes"));
    pen.translate(left, top);
    pen.textAlign = "center";
    pen.lineWidth = 3;
    for (const node of byId("axes").childNodes) {
      const number = (name) => Number(node.getAttribute(name));
      if (node.tagName === "text") pen.fillText(node.textContent, number("x"), number("y"));
      else {
        pen.strokeStyle = node.getAttribute("stroke");
        pen.beginPath();
        pen.moveTo(number("x1"), number("y1"));
        pen.lineTo(number("x2"), number("y2"));
        pen.stroke();
      }
    }
  }
  return sheet;
}

function savePicture() {
  if (!renderer) return;
  picture().toBlob((blob) => {
    const url = URL.createObjectURL(blob);
    const names = data.shapes.map((shape) => shape.name.replace(/[^\p{L}\p{N}]+/gu, "_")).join("-");
    element("a", { href: url, download: `${names}.png` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
    tell("Saved as a PNG picture.");
  });
}

// Says what was done, for a moment.
function tell(text) {
  byId("told").textContent = text;
  clearTimeout(tell.timer);
  tell.timer = setTimeout(() => (byId("told").textContent = ""), 4000);
}
