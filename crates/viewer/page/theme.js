// Light or dark: as the system has it, until the button is pressed.

const DARK = window.matchMedia("(prefers-color-scheme: dark)");
let paper = WHITE; // what the shapes stand on

function setDark(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  byId("dark").setAttribute("aria-pressed", String(dark));
  const hex = getComputedStyle(document.documentElement).getPropertyValue("--paper").trim();
  paper = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  if (hasTrees) setTree(state.tree, state.treeShape);
  refresh();
}

const isDark = () => document.documentElement.dataset.theme === "dark";
const follow = (event) => setDark(event.matches);
DARK.addEventListener("change", follow);
byId("dark").addEventListener("click", () => {
  DARK.removeEventListener("change", follow);
  setDark(!isDark());
});
