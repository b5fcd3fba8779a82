// The entry: a page with a document in it shows that; a notebook calls `render`.

import styles from "./style.css";
import { makeApi } from "./api.js";
import { element } from "./elements.js";
import { Viewer } from "./viewer.js";

const DOCUMENT = "bifurc-document"; // the id of the element that holds the document of a page
const ROOT = "bifurc-viewer";
const TELLING = 60; // ms between two messages to a notebook

function addStyles(node) {
  node.append(element("style", {}, styles));
}

function showPage(holder) {
  const root = document.getElementById(ROOT);
  addStyles(document.head);
  const viewer = new Viewer(root, JSON.parse(holder.textContent), document);
  window.bifurc = makeApi(viewer);
  requestAnimationFrame(() => requestAnimationFrame(() => (document.body.dataset.ready = "true")));
}

const holder = globalThis.document?.getElementById(DOCUMENT);
if (holder) showPage(holder);

/** What anywidget calls for every view of a widget; what it returns is called when the view goes. */
function render({ model, el }) {
  addStyles(el);
  const root = element("div", { class: "bv-in-notebook", "data-lm-suppress-shortcuts": "true" });
  const theme = notebookTheme();
  if (theme) root.dataset.theme = theme;
  el.append(root);
  let viewer;
  whenConnected(root, () => {
    viewer = new Viewer(root, model.get("document"));
    keepTogether(model, root, viewer);
  });
  return () => viewer?.dispose();
}

/** Let the traits of a widget and the viewer's position follow each other. */
function keepTogether(model, root, viewer) {
  let isFollowing = false;
  let timer;
  const follow = () => {
    const { track, s } = viewer.position;
    if (track.name === model.get("form") && s === model.get("position")) return;
    isFollowing = true;
    viewer.goByName(model.get("form"), model.get("position"));
    isFollowing = false;
  };
  const tell = () => {
    timer = undefined;
    const { track, s } = viewer.position;
    model.off("change:form change:position", follow);
    model.set("form", track.name);
    model.set("position", s);
    model.on("change:form change:position", follow);
    model.save_changes();
  };
  root.addEventListener("bifurc-position", () => {
    if (!isFollowing) timer ??= setTimeout(tell, TELLING);
  });
  model.on("change:form change:position", follow);
  follow();
}

/** "dark" or "light" as JupyterLab and Visual Studio Code say it; undefined elsewhere. */
function notebookTheme() {
  const { body } = document;
  if (body.dataset.jpThemeLight) return body.dataset.jpThemeLight === "true" ? "light" : "dark";
  if (body.classList.contains("vscode-dark")) return "dark";
  return body.classList.contains("vscode-light") ? "light" : undefined;
}

/** Start once a node is in the page: before that it has no size and no style. */
function whenConnected(node, start) {
  if (node.isConnected) start();
  else requestAnimationFrame(() => whenConnected(node, start));
}

export default { render };
