// The entry: a page with a document in it shows that; a notebook calls `render`.

import styles from "./style.css";
import { element } from "./elements.js";
import { Viewer } from "./viewer.js";

const DOCUMENT = "bifurc-document"; // the id of the element that holds the document of a page
const ROOT = "bifurc-viewer";

function addStyles(node) {
  node.append(element("style", {}, styles));
}

function showPage(holder) {
  const root = document.getElementById(ROOT);
  addStyles(document.head);
  const viewer = new Viewer(root, JSON.parse(holder.textContent), document);
  window.bifurc = viewer.api;
  requestAnimationFrame(() => requestAnimationFrame(() => (document.body.dataset.ready = "true")));
}

const holder = globalThis.document?.getElementById(DOCUMENT);
if (holder) showPage(holder);

/** What anywidget calls for every view of a widget. */
function render({ model, el }) {
  addStyles(el);
  const root = element("div", { class: "bv-in-notebook" });
  el.append(root);
  const viewer = new Viewer(root, model.get("document"));
  let isOwn = false;
  const follow = () => {
    if (isOwn) return;
    viewer.goByName(model.get("form") || 1, model.get("position"));
  };
  model.on("change:form", follow);
  model.on("change:position", follow);
  if (model.get("form")) follow();
  root.addEventListener("bifurc-position", ({ detail }) => {
    isOwn = true;
    model.set("form", detail.form);
    model.set("position", detail.s);
    model.save_changes();
    isOwn = false;
  });
  return () => viewer.view?.dispose();
}

export default { render };
