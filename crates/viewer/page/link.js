// A link to what is seen: the part of the address behind # says what is chosen, and how it is seen.

const digits = (x, n = 4) => String(Number(x.toFixed(n)));

function viewHash() {
  const words = [`mode=${state.mode}`];
  const name = ({ shape, id }) => (data.shapes.length > 1 ? `${shape}:${id}` : String(id));
  if (state.chosen) words.push(`chosen=${name(state.chosen)}`);
  const hidden = state.hidden[listed()];
  if (hidden.length) words.push(`hidden=${hidden.map(name).join(",")}`);
  if (state.others < 1) words.push(`others=${digits(state.others, 2)}`);
  words.push(`view=${[camera.azimuth, camera.elevation].map((x) => digits(x, 1)).join(",")}`);
  const [x, y] = camera.shift;
  if (camera.zoom !== 1 || x || y) words.push(`zoom=${[camera.zoom, x, y].map((n) => digits(n)).join(",")}`);
  if (state.cut !== null) words.push(`cut=${"xyz"[state.cut]},${byId("cut-at").value}${state.flip ? ",flip" : ""}`);
  if (state.mode === "level") words.push(`level=${digits(state.level)}`);
  if (hasTrees && (state.tree || state.treeShape)) words.push(`tree=${state.tree}${state.treeShape ? `,${state.treeShape}` : ""}`);
  if (state.axes) words.push("axes=1");
  return `#${words.join("&")}`;
}

// What a link says, as far as it fits this page; anything else is left out.
function restore(hash) {
  const words = Object.fromEntries(hash.slice(1).split("&").map((word) => word.split("=")).filter((pair) => pair.length === 2));
  const numbers = (name) => (words[name] ?? "").split(",").map(Number);
  const finite = (list, count) => list.length >= count && list.every(Number.isFinite);
  const item = (name) => {
    const [id, shape = "0"] = name.split(":").reverse();
    const numbers = /^\d+$/.test(id) && /^\d+$/.test(shape);
    return numbers && data.shapes[shape]?.[listed()][id] ? { shape: Number(shape), id: Number(id) } : null;
  };
  if (words.mode) takeMode(words.mode);
  const trees = hasTrees && words.tree ? numbers("tree") : [];
  if (finite(trees, 1) && trees.length && data.shapes[trees[1] ?? 0]?.trees[trees[0]]) setTree(trees[0], trees[1] ?? 0);
  state.chosen = words.chosen ? item(words.chosen) : null;
  state.hidden[listed()] = (words.hidden ?? "").split(",").map(item).filter(Boolean);
  const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
  state.others = words.others && finite(numbers("others"), 1) ? clamp(numbers("others")[0], 0, 1) : 1;
  if (finite(numbers("view"), 2)) camera.look(numbers("view")[0], clamp(numbers("view")[1], -90, 90));
  if (finite(numbers("zoom"), 3)) {
    const [zoom, ...shift] = numbers("zoom");
    camera.zoom = clamp(zoom, 0.2, 60);
    camera.shift = shift.slice(0, 2);
  }
  const [axis, at, flip] = (words.cut ?? "").split(",");
  if (axis && "xyz".includes(axis)) {
    if (Number.isFinite(Number(at))) byId("cut-at").value = at;
    setFlip(flip === "flip");
    setCut("xyz".indexOf(axis));
  } else setCut(-1);
  if (state.mode === "level" && words.level && finite(numbers("level"), 1)) setLevel(numbers("level")[0]);
  setAxes(words.axes === "1");
  panel.show(state.chosen);
  refresh();
}

// The address follows what is seen, once it stays.
let written = "";
function keepAddress() {
  clearTimeout(keepAddress.timer);
  keepAddress.timer = setTimeout(() => {
    written = viewHash();
    history.replaceState(null, "", written);
  }, 300);
}
window.addEventListener("hashchange", () => location.hash === written || restore(location.hash));

function copyLink() {
  written = viewHash();
  history.replaceState(null, "", written);
  const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject();
  copied.then(() => tell("The link is copied."), () => tell("The link is in the address bar."));
}
