// The side panel: the numbers of a region, the table of all, and facts about the shapes.

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

function definitions(pairs) {
  return element("dl", {}, ...pairs.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

class Panel {
  constructor(data, actions) {
    this.data = data;
    this.actions = actions;
    this.details = document.getElementById("details");
    const tables = document.getElementById("tables");
    this.rows = data.shapes.map((shape, s) => {
      const rows = shape.regions.map((region, id) => this.row(shape, s, region, id, actions));
      const heads = ["id", data.matches.length ? "match" : null, "volume", "reliability", "stability", "altitude"];
      const head = heads.filter(Boolean).map((name) => element("th", { scope: "col" }, name));
      const table = element("table", {}, element("thead", {}, element("tr", {}, ...head)));
      if (data.shapes.length > 1) table.prepend(element("caption", {}, shape.name));
      table.append(element("tbody", {}, ...rows));
      tables.append(rows.length ? table : element("p", {}, `${shape.name}: no regions were found.`));
      return rows;
    });
    const facts = document.getElementById("facts");
    for (const shape of data.shapes) {
      if (!shape.facts.length) continue;
      facts.append(element("h2", {}, shape.name), definitions(shape.facts));
    }
  }

  // What a region is matched with: [id, distance] or undefined.
  partner(s, id) {
    const pair = this.data.matches.find((m) => m[s] === id);
    return pair && [pair[1 - s], pair[2]];
  }

  row(shape, s, region, id, actions) {
    const button = element("button", { type: "button", "aria-label": `Region ${id} of ${shape.name}` }, String(id));
    const cells = [
      element("td", {}, swatch(region.colour), button),
      element("td", {}, percent(region.fraction)),
      element("td", {}, show(region.reliability)),
      element("td", {}, show(region.stability)),
      element("td", {}, show(region.altitude)),
    ];
    if (this.data.matches.length) {
      const partner = this.partner(s, id);
      cells.splice(1, 0, element("td", {}, partner ? `${s === 0 ? "→" : "←"} ${partner[0]}` : "none"));
    }
    const row = element("tr", { "aria-selected": "false" }, ...cells);
    row.addEventListener("click", () => actions.choose(s, id));
    row.addEventListener("pointerenter", () => actions.hover(s, id));
    row.addEventListener("pointerleave", () => actions.hover(s, null));
    return row;
  }

  // A region's name that chooses it.
  link(s, id) {
    const button = element("button", { type: "button", class: "link" }, `region ${id}`);
    button.addEventListener("click", () => this.actions.choose(s, id));
    return button;
  }

  mark(s, chosen, hovered) {
    this.rows[s].forEach((row, id) => {
      row.setAttribute("aria-selected", String(chosen.includes(id)));
      row.classList.toggle("hover", hovered.includes(id));
    });
  }

  // The numbers of a region, or how to get them.
  show(choice) {
    if (!choice) {
      const counts = this.data.shapes.map((s) => `${s.name}: ${s.regions.length} regions`).join("; ");
      const hint = element("p", {}, "Point at a region for its name, click or tap it for its numbers.");
      this.details.replaceChildren(element("h2", {}, counts), hint);
      return;
    }
    const shape = this.data.shapes[choice.shape];
    const region = shape.regions[choice.region];
    const title = `Region ${choice.region}${this.data.shapes.length > 1 ? ` of ${shape.name}` : ""}`;
    const pairs = [
      ["volume", show(region.volume)],
      ["share", percent(region.fraction)],
      ["reliability", show(region.reliability)],
      ["stability", show(region.stability)],
      ["altitude", show(region.altitude)],
      ["inside", region.parent === null ? "no other" : this.link(choice.shape, region.parent)],
      ["vertices", String(region.vertices)],
    ];
    if (shape.grid) pairs.push(["voxels", String(region.voxels)]);
    if (region.tree !== null) pairs.push(["tree", shape.trees[region.tree].name]);
    const partner = this.partner(choice.shape, choice.region);
    if (this.data.matches.length) {
      pairs.push(["match", partner ? this.link(1 - choice.shape, partner[0]) : "none"]);
      if (partner) pairs.push(["distance", show(partner[1])]);
    }
    this.details.replaceChildren(element("h2", {}, swatch(region.colour), title), definitions(pairs));
  }
}
