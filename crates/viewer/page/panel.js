// The side panel: the numbers of a part or region, the tables of all, and facts about the shapes.

function element(kind, attributes = {}, ...children) {
  const node = document.createElement(kind);
  Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
  node.append(...children);
  return node;
}

function swatch(colour) {
  const node = element("span", { class: "swatch", "aria-hidden": "true" });
  node.style.background = css(colour);
  return node;
}

// Pairs of a name and what it is. A name that is a word of ours is explained.
function definitions(pairs) {
  const name = (text) => element("dt", {}, text, ...(text in WORDS ? [explained(text)] : []));
  return element("dl", {}, ...pairs.flatMap(([text, value]) => [name(text), element("dd", {}, value)]));
}

// How a part or region is called.
function title(s, id, list = listed()) {
  const noun = list === "parts" ? "Part" : "Region";
  const trunk = list === "parts" && data.shapes[s].parts[id].trunk ? ", the trunk" : "";
  return `${noun} ${id}${trunk}`;
}

class Panel {
  constructor(data, actions) {
    this.data = data;
    this.actions = actions;
    this.details = document.getElementById("details");
    const links = { item: (...words) => this.link(...words), word: explained };
    this.tables = Object.fromEntries(
      Object.keys(NOUNS).map((list) => [list, data.shapes.map((_, s) => new Table(data, list, s, actions, links))]),
    );
    this.twins = (list) => data.shapes.some((shape) => shape[list].some((item) => item.twins.length));
    this.sides = (list) => data.shapes.some((shape) => shape[list].some((item) => item.side !== null));
    const facts = document.getElementById("facts");
    for (const shape of data.shapes) {
      if (!shape.facts.length) continue;
      facts.append(element("h2", {}, shape.name), definitions(shape.facts));
    }
  }

  // Shows the tables of the parts or of the regions.
  take(list) {
    this.list = list;
    document.getElementById("table-title").textContent = list === "parts" ? "Parts" : "Regions";
    document.getElementById("tables").replaceChildren(...this.tables[list].map((table) => table.node));
  }

  // What the tables list, in their order.
  order(list) {
    return this.tables[list].flatMap((table, shape) => table.order.map((id) => ({ shape, id })));
  }

  // What a part or region is matched with.
  matched(s, id, list) {
    if (!this.data.matches[list].length) return [];
    const pair = this.data.matches[list].find((m) => m[s] === id);
    if (!pair) return [["match", "none"]];
    const found = element("span", {}, this.link(1 - s, pair[1 - s], list), ...(pair[3] ? [", which is wrong"] : []));
    return [["match", found], ["distance", show(pair[2])]];
  }

  // The name of a part or region that chooses it.
  link(s, id, list, name = `${NOUNS[list]} ${id}`) {
    const button = element("button", { type: "button", class: "link", "aria-label": `${NOUNS[list]} ${id}` }, name);
    button.addEventListener("click", (event) => {
      // Not the row that it stands in.
      event.stopPropagation();
      this.actions.choose(s, id, list);
    });
    return button;
  }

  links(s, ids, list) {
    return ids.length ? joined(ids.map((id, i) => this.link(s, id, list, i ? String(id) : undefined))) : "none";
  }

  mark(s, marks) {
    this.tables[this.list][s].mark(marks);
  }

  // The numbers of a part or region, or how to get them.
  show(choice) {
    const { list } = this;
    if (!choice) {
      const counts = this.data.shapes.map((s) => `${s.name}: ${s[list].length} ${list}`).join("; ");
      const hint = element("p", {}, `Point at a ${NOUNS[list]} for its name, click or tap it for its numbers.`);
      const all = state.hidden[list].length ? [this.button("Show all", this.actions.showAll)] : [];
      this.details.replaceChildren(element("h2", {}, counts), hint, ...all);
      return;
    }
    const shape = this.data.shapes[choice.shape];
    const item = shape[list][choice.id];
    const name = `${title(choice.shape, choice.id, list)}${this.data.shapes.length > 1 ? ` of ${shape.name}` : ""}`;
    const pairs = [
      ["volume", show(item.volume)],
      ["share", percent(item.fraction)],
      ...(list === "parts" ? this.ofPart(choice, shape, item) : this.ofRegion(choice, shape, item)),
      ["vertices", String(item.vertices)],
    ];
    if (shape.grid) pairs.push(["voxels", String(item.voxels)]);
    this.details.replaceChildren(element("h2", {}, swatch(item.colour), name), definitions(pairs), this.tools(choice));
  }

  ofPart({ shape: s, id }, shape, part) {
    shape.partOfRegion ??= partsOfRegions(shape);
    const inside = shape.partOfRegion.flatMap((own, region) => (own === id ? [region] : []));
    const pairs = [["twins", this.links(s, part.twins, "parts")]];
    if (this.sides("parts")) pairs.push(["side", showSide(part.side)]);
    pairs.push(["grew from", part.region === null ? "what the others leave" : this.link(s, part.region, "regions")]);
    pairs.push(["in it", this.links(s, inside, "regions")]);
    pairs.push(...this.matched(s, id, "parts"));
    return pairs;
  }

  ofRegion({ shape: s, id }, shape, region) {
    const measured = (name) => this.data.shapes.some((shape) => shape.regions.some((region) => region[name] !== null));
    const pairs = [
      ...(measured("reliability") ? [["reliability", show(region.reliability)]] : []),
      ["stability", region.stability === null ? "∞" : show(region.stability)],
      ["altitude", show(region.altitude)],
      ...(measured("lifetime") ? [["lifetime", region.lifetime === null ? "it grows on" : show(region.lifetime)]] : []),
      ["inside", region.parent === null ? "no other" : this.link(s, region.parent, "regions")],
    ];
    if (this.twins("regions")) pairs.push(["twin", this.links(s, region.twins, "regions")]);
    if (this.sides("regions")) pairs.push(["side", showSide(region.side)]);
    if (region.tree !== null) pairs.push(["tree", shape.trees[region.tree].name]);
    const merge = this.merge(s, shape, region, id);
    if (merge) pairs.push(["merges at", merge]);
    if (shape.parts.length) {
      shape.partOfRegion ??= partsOfRegions(shape);
      const grown = shape.parts.findIndex((part) => part.region === id);
      const part = grown < 0 ? shape.partOfRegion[id] : grown;
      pairs.push(["part", part < 0 ? "several" : this.link(s, part, "parts")]);
    }
    pairs.push(...this.matched(s, id, "regions"));
    return pairs;
  }

  // Where the component that a region is on the way of merges with another: a button that lets the level rise to there.
  merge(s, shape, region, id) {
    const tree = region.tree === null ? null : shape.trees[region.tree];
    const branch = tree?.regions[id]?.[0];
    if (branch === undefined || tree.parents[branch] === branch) return null;
    const button = element("button", { type: "button", class: "link" }, percent(tree.ends[branch], 3));
    button.setAttribute("aria-label", `Show the merge, when ${percent(tree.ends[branch], 3)} of the shape have entered`);
    button.addEventListener("click", () => this.actions.showMerge(s, region.tree, tree.ends[branch]));
    return button;
  }

  button(name, action, pressed) {
    const state = pressed === undefined ? {} : { "aria-pressed": String(pressed) };
    const button = element("button", { type: "button", ...state }, name);
    button.addEventListener("click", () => {
      action();
      // It was made anew.
      this.details.querySelectorAll("button").forEach((other) => other.textContent === name && other.focus());
    });
    return button;
  }

  // What can be done with what is chosen.
  tools(choice) {
    const { list, actions } = this;
    const hidden = state.hidden[list].some((other) => same(other, choice));
    const others = element("input", { type: "range", min: 0, max: 100, value: 100 * state.others, "aria-label": "Opacity of the others" });
    others.addEventListener("input", () => actions.fade(others.value / 100));
    const row = [
      this.button("Hide", actions.hide, hidden),
      this.button("Isolate", actions.isolate, state.others === 0),
      element("label", { class: "row" }, "others", others),
    ];
    if (state.hidden[list].length) row.push(this.button("Show all", actions.showAll));
    return element("div", { class: "row tools" }, ...row);
  }
}
