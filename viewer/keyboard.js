// What the keys do.

const STEP = 1 / 240; // of a form, with an arrow
const FINE = 0.1; // of that, with Shift

export const KEYS_IN_WORDS = [
  ["← →", "along the form (Shift: finely)"],
  ["↑ ↓", "next and previous singular point"],
  ["Space", "play and pause"],
  ["1 – 9", "forms"],
  ["G", "ghosts of earlier positions"],
  ["L", "hold the next link still"],
  ["R", "see all again"],
  ["D", "dark or light"],
  ["Esc", "stop a route"],
];

/** Listen to the keys at a node; `actions` are the viewer's. */
export function listenToKeys(node, actions) {
  node.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isForField(event)) return;
    const action = actionOf(event, actions);
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action();
  });
  node.addEventListener("keyup", (event) => {
    if (event.key === " " && !isForField(event)) event.preventDefault(); // Firefox would press the button in focus, too
  });
}

function isForField({ target }) {
  return target instanceof Element && Boolean(target.closest("select, textarea, input:not([type=range])"));
}

function actionOf(event, actions) {
  const step = STEP * (event.shiftKey ? FINE : 1);
  if (/^[1-9]$/.test(event.key)) return () => actions.goToNumber(Number(event.key));
  return {
    ArrowRight: () => actions.step(step),
    ArrowLeft: () => actions.step(-step),
    ArrowUp: () => actions.goToNextPoint(1),
    ArrowDown: () => actions.goToNextPoint(-1),
    " ": () => actions.togglePlay(),
    g: () => actions.toggleGhosts(),
    l: () => actions.holdNextLink(),
    r: () => actions.resetView(),
    d: () => actions.toggleTheme(),
    Escape: () => actions.stop(),
  }[event.key.length === 1 ? event.key.toLowerCase() : event.key];
}
