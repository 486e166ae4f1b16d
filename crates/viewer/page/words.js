// The words of the method, explained where they stand: a question mark opens a sentence and a link.

const DOCS = "https://github.com/mser3d/mser3d/blob/main/";
const WORDS = {
  altitude: ["The weight at which a region is complete, when the level moves through the component tree.", "ARCHITECTURE.md#component-trees"],
  stability: ["How little a region's volume changes when the level moves; large is stable, ∞ means it does not change.", "ARCHITECTURE.md#regions"],
  lifetime: ["How far the level moves between a region's beginning and the merge that ends it; only the last region before a merge has one.", "ARCHITECTURE.md#component-trees"],
  reliability: ["The chance, from 0 to 1, that the region is found again on another pose; below 0.5 it is shown faintly in the table.", "docs/results/reliability.md"],
  twin: ["Its mirror image on the same body; it is seen faintly when its twin is chosen.", "docs/sides.md"],
  twins: ["The parts that are its mirror images, or equal to it; they are seen faintly when it is chosen.", "docs/sides.md"],
  side: ["From −1 on one side of the body to +1 on the other; which of them is the left one is not said.", "docs/sides.md"],
  tree: ["The component tree that the region was found in; t_rel is how long heat flows, relative to the size of the shape.", "docs/weights.md"],
  "merges at": ["How much of the shape has entered when the component around the region becomes one with another; a click shows it.", "ARCHITECTURE.md#component-trees"],
  front: ["Where the body looks, told by its limbs that are mirror images, its head and its toes; Front, Side and Back are seen from there.", "docs/formats.md#viewhtml-and-pictures"],
  level: ["The threshold that moves: a place enters when the level reaches its weight, and connected places form components.", "ARCHITECTURE.md#component-trees"],
};

const NOTE = element("div", { id: "note", role: "note", hidden: "" });

// A button that explains a word.
function explained(word) {
  const [sentence] = WORDS[word];
  const button = element("button", { type: "button", class: "what", "aria-label": `What is ${word}?`, "aria-expanded": "false" }, "?");
  button.setAttribute("aria-description", sentence);
  button.addEventListener("click", (event) => {
    event.stopPropagation();
    if (button.getAttribute("aria-expanded") === "true") closeNote();
    else openNote(button, word);
  });
  return button;
}

function openNote(button, word) {
  closeNote();
  const [sentence, page] = WORDS[word];
  const link = element("a", { href: DOCS + page, target: "_blank", rel: "noopener" }, "more");
  NOTE.replaceChildren(element("b", {}, word), ` ${sentence} `, link);
  NOTE.hidden = false;
  // After the button, so that Tab leads from it to the link.
  button.after(NOTE);
  button.setAttribute("aria-expanded", "true");
  placeNote();
}

// Below its button, or above it where there is no room.
function placeNote() {
  if (NOTE.hidden) return;
  const at = NOTE.previousElementSibling.getBoundingClientRect();
  NOTE.style.left = `${Math.max(8, Math.min(at.left, window.innerWidth - NOTE.offsetWidth - 8))}px`;
  const below = at.bottom + 4;
  NOTE.style.top = `${below + NOTE.offsetHeight > window.innerHeight ? at.top - 4 - NOTE.offsetHeight : below}px`;
}

// Closes what is open, and says whether anything was.
function closeNote() {
  if (NOTE.hidden) return false;
  NOTE.previousElementSibling?.setAttribute("aria-expanded", "false");
  NOTE.hidden = true;
  return true;
}

document.addEventListener("click", (event) => NOTE.contains(event.target) || closeNote());
document.addEventListener("scroll", placeNote, true);
