"use strict";
{
  const root = document.documentElement;
  const theme = document.getElementById("theme");
  const isDark = () => getComputedStyle(root).getPropertyValue("--paper").trim() !== "#fff";
  theme.hidden = false;
  theme.addEventListener("click", () => { root.dataset.theme = isDark() ? "light" : "dark"; });

  // Show the values of a point on hover, tap and keyboard focus.
  const tip = document.getElementById("tip");
  const show = (mark) => {
    const box = mark.getBoundingClientRect();
    tip.textContent = mark.dataset.tip;
    tip.hidden = false;
    const left = Math.min(box.right + 8, innerWidth - tip.offsetWidth - 8);
    tip.style.left = `${Math.max(8, left)}px`;
    tip.style.top = `${Math.max(8, box.top - tip.offsetHeight - 8)}px`;
  };
  const hide = () => { tip.hidden = true; };
  for (const mark of document.querySelectorAll("svg .mark")) {
    const title = mark.querySelector("title");
    mark.dataset.tip = title.textContent;
    mark.setAttribute("aria-label", title.textContent);
    title.remove();
    mark.tabIndex = 0;
    for (const event of ["pointerenter", "focus", "click"]) mark.addEventListener(event, () => show(mark));
    for (const event of ["pointerleave", "blur"]) mark.addEventListener(event, hide);
  }
  addEventListener("scroll", hide, { passive: true });

  for (const slider of document.querySelectorAll(".slider")) {
    const range = slider.querySelector("input");
    const move = () => slider.style.setProperty("--at", `${range.value / 10}%`);
    range.addEventListener("input", move);
    slider.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "mouse") return;
      const box = slider.getBoundingClientRect();
      range.value = Math.round((event.clientX - box.left) / box.width * 1000);
      move();
    });
    move();
  }

  // Sort numbers by value and texts alphabetically; empty cells come last.
  const key = (row, column) => {
    const cell = row.cells[column];
    return "number" in cell.dataset ? Number(cell.dataset.number) : cell.textContent;
  };
  const compare = (a, b) => {
    if (a === "" || b === "") return (a === "") - (b === "");
    return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b));
  };
  for (const head of document.querySelectorAll(".table thead th")) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent || "\u2195";
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const body = head.closest("table").tBodies[0];
      const sign = head.ariaSort === "ascending" ? -1 : 1;
      for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      const keyed = [...body.rows].map((row) => [key(row, head.cellIndex), row]);
      keyed.sort(([a], [b]) => (a === "" || b === "" ? compare(a, b) : sign * compare(a, b)));
      body.append(...keyed.map(([, row]) => row));
    });
  }
}
