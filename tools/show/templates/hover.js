"use strict";
for (const place of document.querySelectorAll(".hover")) {
  const marks = JSON.parse(place.dataset.marks);
  const told = place.querySelector("output");
  const near = (event) => {
    const box = place.getBoundingClientRect();
    const x = event.clientX - box.left, y = event.clientY - box.top;
    const away = (m) => Math.hypot(m[0] * box.width - x, m[1] * box.height - y);
    const found = marks.reduce((best, m) => (best === null || away(m) < away(best) ? m : best), null);
    const shows = found !== null && away(found) < 40;
    told.style.display = shows ? "block" : "none";
    if (!shows) return;
    told.textContent = found[2];
    const side = found[0] > 0.5 ? "right" : "left";
    told.style.left = told.style.right = "auto";
    told.style[side] = 100 * (side === "left" ? found[0] : 1 - found[0]) + "%";
    told.style.top = 100 * found[1] + "%";
  };
  place.addEventListener("pointermove", near);
  place.addEventListener("pointerdown", near);
  place.addEventListener("pointerleave", () => { told.style.display = "none"; });
}
