// What is below the pointer, and what a click there does.

// The part, or the innermost region, that a picked vertex or voxel belongs to.
function itemAt(hit) {
  const label = data.shapes[hit.shape].labels[listed()][hit.kind][hit.number];
  return label < 0 ? null : label;
}

function componentAt(hit) {
  const tree = data.shapes[hit.shape].trees[state.tree];
  if (!tree || tree[`${hit.kind}Entered`][hit.number] > state.level * 65535 + 0.5) return null;
  const branch = componentsAt(tree, state.level)[tree[`${hit.kind}Branch`][hit.number]];
  return branch < 0 ? null : { shape: hit.shape, branch };
}

function point(x, y) {
  const hit = renderer?.pick(x, y);
  const tip = byId("tip");
  let text = "";
  if (state.mode === "level") {
    const component = hit && componentAt(hit);
    if (JSON.stringify(component) !== JSON.stringify(state.component)) {
      state.component = component;
      refresh();
    }
    if (component) {
      const tree = data.shapes[component.shape].trees[state.tree];
      text = `component, at most ${percent(tree.volumes[component.branch])} before it merges`;
    }
  } else {
    const id = hit ? itemAt(hit) : null;
    hover(hit ? hit.shape : 0, id);
    if (id !== null) text = `${title(hit.shape, id)} · ${percent(data.shapes[hit.shape][listed()][id].fraction)}`;
  }
  tip.hidden = !text;
  tip.textContent = text;
  tip.style.left = `${Math.min(x, canvas.clientWidth - 190)}px`;
  tip.style.top = `${y}px`;
}

// Chooses the part or innermost region at a place; again at a place in the same innermost one, the region around the chosen one.
let clicked = null;
function click(x, y) {
  const hit = renderer?.pick(x, y);
  const innermost = hit ? itemAt(hit) : null;
  if (innermost === null) {
    choose(0, null);
    return;
  }
  const shape = data.shapes[hit.shape];
  const chosen = state.chosen?.shape === hit.shape ? state.chosen.id : null;
  const here = { shape: hit.shape, id: innermost };
  const within = chosen !== null && membership(shape, listed(), chosen, hit.kind)(hit.number);
  // What was chosen elsewhere, as by the table or as a part, is left for what is seen here.
  const again = within && (chosen === innermost || same(here, clicked));
  clicked = here;
  const next = again ? shape[listed()][chosen].parent ?? innermost : innermost;
  if (next !== chosen) choose(hit.shape, next);
}

// The next or previous one in the order of the tables.
function step(by) {
  const all = panel.order(listed());
  if (!all.length) return;
  const now = state.chosen ? all.findIndex((other) => same(other, state.chosen)) : by > 0 ? -1 : 0;
  const { shape, id } = all[(now + by + all.length) % all.length];
  choose(shape, id);
}
