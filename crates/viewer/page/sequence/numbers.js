// The table of tracks, and the curves of the chosen one.

const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function element(name, properties, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function swatch(colour) {
  const made = element("span", { className: "swatch" });
  made.style.background = css(colour);
  return made;
}

const mean = (values) => (values.length ? values.reduce((sum, x) => sum + x, 0) / values.length : null);
const present = (track, key) => track.sightings.map((s) => s[key]).filter((x) => x !== null);

// Where a track is found, as a bar.
function bar(track, frames) {
  const drawn = svg("svg", { viewBox: `0 0 ${frames} 1`, preserveAspectRatio: "none", "aria-hidden": "true" });
  drawn.append(svg("rect", { x: 0, y: 0.45, width: frames, height: 0.1, fill: "#d0d0d0" }));
  for (const s of track.sightings) {
    drawn.append(svg("rect", { x: s.frame, y: 0, width: 1.02, height: 1, fill: css(track.colour) }));
  }
  return drawn;
}

function fillTable(data, choose) {
  const rows = data.tracks.map((track, t) => {
    const button = element("button", { type: "button" }, swatch(track.colour), String(t));
    button.addEventListener("click", () => choose(t));
    const cell = (...content) => element("td", {}, ...content);
    return element("tr", {}, cell(button), cell(bar(track, data.total)), cell(percent(mean(present(track, "fraction")), 3)),
      cell(show(mean(present(track, "reliability")), 2)));
  });
  document.querySelector("#tracks tbody").append(...rows);
  return rows;
}

// A curve over all frames, with gaps where the track is not found, and a mark at the frame that is seen.
function curve(track, key, total, now, high) {
  const x = (frame) => (total > 1 ? (100 * frame) / (total - 1) : 50);
  const y = (value) => 19 - (18 * value) / (high || 1);
  const drawn = svg("svg", { viewBox: "-1 0 102 20", preserveAspectRatio: "none", "aria-hidden": "true" });
  drawn.append(svg("line", { x1: x(now), x2: x(now), y1: 0, y2: 20, stroke: "#0b57d0", "stroke-width": 0.4 }));
  let line = "";
  let last = -2;
  for (const s of track.sightings) {
    if (s[key] === null) continue;
    line += `${s.frame === last + 1 ? "L" : "M"}${x(s.frame)} ${y(s[key])}`;
    // A single frame is a short stroke.
    line += `l0.3 0M${x(s.frame)} ${y(s[key])}`;
    last = s.frame;
  }
  const style = { fill: "none", stroke: "#222", "stroke-width": 1.5, "vector-effect": "non-scaling-stroke" };
  drawn.append(svg("path", { d: line || "M0 0", ...style }));
  return drawn;
}

function showDetails(data, chosen, now) {
  const place = document.getElementById("details");
  if (chosen < 0) {
    place.replaceChildren(element("h2", {}, "No track chosen"),
      element("p", { className: "soft" }, "Click the body or the table: a track's numbers are shown here over time."));
    return;
  }
  const track = data.tracks[chosen];
  const frames = track.sightings.map((s) => s.frame);
  const here = track.sightings.find((s) => s.frame === now);
  const content = [element("h2", {}, swatch(track.colour), `Track ${chosen}`),
    element("p", { className: "soft" }, `found in ${frames.length} of ${data.total} frames, from ${frames[0]} to ${frames[frames.length - 1]}`)];
  const curves = [["Volume, share of the body", "fraction", Math.max(...present(track, "fraction")), (x) => percent(x, 3)],
    ["Overlap with the frame before", "overlap", 1, (x) => show(x, 2)],
    ["Reliability", "reliability", 1, (x) => show(x, 2)]];
  for (const [title, key, high, text] of curves) {
    if (!present(track, key).length) continue;
    const value = here && here[key] !== null ? text(here[key]) : "–";
    content.push(element("h3", {}, `${title}: ${value}`), curve(track, key, data.total, now, high));
  }
  place.replaceChildren(...content);
}
