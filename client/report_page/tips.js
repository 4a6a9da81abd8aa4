// One floating note for everything that has a meaning or a value under the pointer.
const tip = el("div", { class: "tip", role: "tooltip" });
document.body.append(tip);

/** Shows lines (texts or nodes) near (x, y) of the window, inside it. */
function showTipAt(x, y, ...lines) {
  tip.replaceChildren(...lines.filter(Boolean).flatMap((line, i) => (i ? [el("br"), line] : [line])));
  tip.style.visibility = "visible";
  const left = Math.max(8, Math.min(x + 14, window.innerWidth - tip.offsetWidth - 8));
  const below = y + 18 + tip.offsetHeight < window.innerHeight - 8;
  tip.style.left = `${left}px`;
  tip.style.top = `${Math.max(8, below ? y + 18 : y - tip.offsetHeight - 12)}px`;
}
const showTip = (event, ...lines) => showTipAt(event.clientX, event.clientY, ...lines);
const hideTip = () => { tip.style.visibility = "hidden"; };

function tellMeaning(event) {
  const node = event.target.closest ? event.target.closest("[data-meaning]") : null;
  if (!node) return;
  const box = node.getBoundingClientRect();
  const pointer = event.type === "pointerover";
  showTipAt(pointer ? event.clientX : box.left, pointer ? event.clientY : box.bottom - 10, node.dataset.meaning);
}
document.addEventListener("pointerover", tellMeaning);
document.addEventListener("focusin", tellMeaning);
for (const type of ["pointerout", "focusout"])
  document.addEventListener(type, (event) => { if (event.target.closest && event.target.closest("[data-meaning]")) hideTip(); });
document.addEventListener("keydown", (event) => { if (event.key === "Escape") hideTip(); });
