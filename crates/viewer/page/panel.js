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
    const regions = data.shapes.flatMap((shape) => shape.regions);
    this.twins = regions.some((region) => region.twin !== null);
    this.sides = regions.some((region) => region.side !== null);
    this.rows = data.shapes.map((shape, s) => {
      const rows = shape.regions.map((region, id) => this.row(shape, s, region, id, actions));
      const own = [data.matches.length && "match", this.twins && "twin", this.sides && "side"].filter(Boolean);
      const heads = ["id", ...own, "volume", "reliability", ...(data.matches.length ? [] : ["stability"])];
      const head = heads.map((name) => element("th", { scope: "col" }, name));
      const table = element("table", {}, element("thead", {}, element("tr", {}, ...head)));
      if (data.shapes.length > 1) table.prepend(element("caption", {}, shape.name));
      table.append(element("tbody", {}, ...rows));
      tables.append(rows.length ? table : element("p", {}, `${shape.name}: no regions were found.`));
      return rows;
    });
    const words = [
      this.twins && "Twin: the region that is its mirror image on the same body; it is seen faintly when a region is chosen.",
      this.sides && "Side: from −1 on one side of the body to +1 on the other; which of them is the left one is not said.",
    ];
    tables.append(...words.filter(Boolean).map((text) => element("p", { class: "word" }, text)));
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
      element("td", {}, percent(region.fraction, 3)),
      element("td", {}, show(region.reliability, 2)),
    ];
    // Beside matches there is no room for it; above the table stand all numbers of the region that is chosen.
    if (!this.data.matches.length) cells.push(element("td", {}, show(region.stability, 3)));
    if (this.sides) cells.splice(1, 0, element("td", {}, showSide(region.side)));
    if (this.twins) cells.splice(1, 0, element("td", {}, region.twin === null ? "–" : this.link(s, region.twin, String(region.twin))));
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
  link(s, id, name = `region ${id}`) {
    const button = element("button", { type: "button", class: "link", "aria-label": `Region ${id}` }, name);
    button.addEventListener("click", (event) => {
      // Not the row that it stands in.
      event.stopPropagation();
      this.actions.choose(s, id);
    });
    return button;
  }

  mark(s, chosen, twins, hovered) {
    this.rows[s].forEach((row, id) => {
      row.setAttribute("aria-selected", String(chosen.includes(id)));
      row.classList.toggle("twin", twins.includes(id));
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
    if (this.twins) pairs.push(["twin", region.twin === null ? "none" : this.link(choice.shape, region.twin)]);
    if (this.sides) pairs.push(["side", showSide(region.side)]);
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
