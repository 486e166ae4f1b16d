// A table of a shape's parts or regions, sorted by any column.

// Below this chance to be found again a region is shown faintly.
const UNRELIABLE = 0.5;

// The columns: heading, word to explain, the value to sort by, and what is shown. Beside matches there is no room for
// all; above the table stand all numbers of what is chosen.
function columns(data, list, s, links) {
  const items = data.shapes.flatMap((shape) => shape[list]);
  const matches = data.matches[list];
  const pair = (id) => matches.find((m) => m[s] === id);
  const partner = (id) => pair(id)?.[1 - s];
  const found = [
    { head: NOUNS[list], value: (_, id) => id },
    matches.length && {
      head: "match",
      value: (_, id) => partner(id) ?? null,
      cell: (_, id) => (partner(id) === undefined ? "none" : `${s === 0 ? "→" : "←"} ${partner(id)}${pair(id)[3] ? ", wrong" : ""}`),
    },
    items.some((item) => item.twins.length) && {
      head: "twin",
      word: "twin",
      value: (item) => item.twins[0] ?? null,
      cell: (item) => (item.twins.length ? joined(item.twins.map((id) => links.item(s, id, list, String(id)))) : "–"),
    },
    items.some((item) => item.side !== null) && {
      head: "side",
      word: "side",
      value: (item) => item.side,
      cell: (item) => showSide(item.side),
    },
    { head: "share", value: (item) => item.fraction, cell: (item) => percent(item.fraction, 3) },
    list === "parts" && {
      head: "from region",
      value: (item) => item.region,
      cell: (item) => (item.region === null ? "trunk" : links.item(s, item.region, "regions", String(item.region))),
    },
    ...["reliability", "lifetime", "stability"].map((name) => list === "regions" && !(matches.length && name !== "reliability") && {
      head: name,
      word: name,
      value: (item) => item[name],
      cell: (item) => (name === "stability" && item.stability === null ? "∞" : show(item[name], name === "reliability" ? 2 : 3)),
    }),
  ];
  // What was measured of none is no column.
  const measured = ({ head }) => !["reliability", "lifetime"].includes(head) || items.some((item) => item[head] !== null);
  return found.filter((column) => column && measured(column));
}

// Nodes with commas between them.
const joined = (nodes) => element("span", {}, ...nodes.flatMap((node, i) => (i ? [", ", node] : [node])));

class Table {
  constructor(data, list, s, actions, links) {
    const shape = data.shapes[s];
    this.list = list;
    this.columns = columns(data, list, s, links);
    this.items = shape[list];
    this.order = this.items.map((_, id) => id);
    this.rows = this.items.map((item, id) => this.row(shape, s, item, id, actions));
    this.heads = this.columns.map((column, c) => this.head(column, c, links));
    this.body = element("tbody", {}, ...this.rows);
    const table = element("table", {}, element("thead", {}, element("tr", {}, ...this.heads)), this.body);
    const name = data.shapes.length > 1 ? shape.name : list === "parts" ? "Parts" : "Regions";
    if (data.shapes.length > 1) table.prepend(element("caption", {}, name));
    else table.setAttribute("aria-label", name);
    const empty = element("p", {}, `${shape.name}: no ${list} were found.`);
    // It may be wider than the panel: then it scrolls, and the keyboard reaches it.
    this.node = this.rows.length ? element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": `Table ${data.shapes.length > 1 ? `${s + 1}: ` : ""}${name}` }, table) : empty;
    this.sorted(0, "ascending");
  }

  head({ head, word }, c, links) {
    const button = element("button", { type: "button", class: "sort" }, head);
    button.addEventListener("click", () => this.sort(c));
    return element("th", { scope: "col" }, button, ...(word ? [links.word(word)] : []));
  }

  // By a column; again: the other way. Names ascend first, measures descend.
  sort(c) {
    const before = this.heads[c].getAttribute("aria-sort");
    const first = c === 0 || ["twin", "match"].includes(this.columns[c].head) ? "ascending" : "descending";
    this.sorted(c, before === null ? first : before === "ascending" ? "descending" : "ascending");
  }

  // What has no value comes last; an endless stability first.
  sorted(c, direction) {
    const { value, head } = this.columns[c];
    const sign = direction === "ascending" ? 1 : -1;
    const none = head === "stability" ? Infinity : sign * Infinity;
    const key = this.items.map((item, id) => value(item, id) ?? none);
    const compare = (p, q) => (key[p] === key[q] ? p - q : sign * (key[p] < key[q] ? -1 : 1));
    this.order.sort(compare);
    this.body.append(...this.order.map((id) => this.rows[id]));
    this.heads.forEach((node, i) => (i === c ? node.setAttribute("aria-sort", direction) : node.removeAttribute("aria-sort")));
  }

  row(shape, s, item, id, actions) {
    const noun = NOUNS[this.list];
    const button = element("button", { type: "button", "aria-label": `${noun} ${id} of ${shape.name}` }, String(id));
    const [, ...others] = this.columns;
    const cells = others.map((column) => element("td", {}, (column.cell ?? column.value)(item, id)));
    const row = element("tr", { "data-id": id }, element("td", {}, swatch(item.colour), button), ...cells);
    if (item.reliability !== undefined && item.reliability !== null && item.reliability < UNRELIABLE) row.classList.add("faint");
    row.addEventListener("click", () => actions.choose(s, id, this.list));
    row.addEventListener("pointerenter", () => actions.hover(s, id));
    row.addEventListener("pointerleave", () => actions.hover(s, null));
    return row;
  }

  mark({ chosen, twins, hovered, hidden }) {
    this.rows.forEach((row, id) => {
      const mark = (name, ids) => row.classList.toggle(name, ids.includes(id));
      mark("chosen", chosen);
      mark("twin", twins);
      mark("hover", hovered);
      mark("hidden", hidden);
      row.querySelector("button").setAttribute("aria-pressed", String(chosen.includes(id)));
    });
  }
}
