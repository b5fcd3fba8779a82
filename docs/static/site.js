// The gallery's search, and the buttons that set a linkage in motion.

// Cards that hold every word that was typed, and have the chosen numbers.
function searchGallery(form) {
  const cards = [...document.querySelectorAll(".gallery-card")];
  const { words, joints, forms } = form.elements;
  const wanted = words.value.toLowerCase().split(/\s+/);
  let shown = 0;
  for (const card of cards) {
    const isFound =
      wanted.every((word) => card.dataset.words.includes(word)) &&
      (joints.value === "" || card.dataset.joints === joints.value) &&
      (forms.value === "" || card.dataset.forms === forms.value);
    card.hidden = !isFound;
    shown += isFound;
  }
  form.querySelector("output").value = `${shown} of ${cards.length} linkages`;
}

// The page of the viewer, in place of the pictures.
function showInMotion(button) {
  const view = button.closest(".linkage-view");
  const frame = document.createElement("iframe");
  frame.src = button.dataset.page;
  frame.title = button.dataset.title;
  view.querySelector(".linkage-pictures").replaceWith(frame);
  button.remove();
}

document.addEventListener("DOMContentLoaded", () => {
  for (const form of document.querySelectorAll(".gallery-search")) {
    form.addEventListener("input", () => searchGallery(form));
    form.addEventListener("submit", (event) => event.preventDefault());
    searchGallery(form); // what the browser has kept in the fields
  }
  for (const button of document.querySelectorAll(".linkage-buttons button")) {
    button.addEventListener("click", () => showInMotion(button));
  }
});
