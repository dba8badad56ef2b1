"use strict";
// Sorts a table by the column whose button was pressed: numbers by value, empty cells last.
function sortTable(table, column, descending) {
  const body = table.tBodies[0];
  const key = row => {
    const cell = row.cells[column];
    if (cell.dataset.v !== undefined) return Number(cell.dataset.v);
    const text = cell.textContent.trim();
    return text === "" || text === "–" ? null : text;
  };
  const compare = (a, b) => {
    if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
    const numbers = typeof a.key === "number" && typeof b.key === "number";
    const order = numbers ? a.key - b.key : String(a.key).localeCompare(String(b.key));
    return descending ? -order : order;
  };
  Array.from(body.rows, row => ({row, key: key(row)})).sort(compare)
    .forEach(item => body.appendChild(item.row));
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = Array.from(table.tHead.rows[0].cells);
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const descending = head.getAttribute("aria-sort") === "ascending";
    heads.forEach(other => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", descending ? "descending" : "ascending");
    sortTable(table, column, descending);
  }));
}

// The slider over the times of the surface. Each panel shows its last picture up to the selected time.
for (const player of document.querySelectorAll(".player")) {
  const data = JSON.parse(player.querySelector("script").textContent);
  const slider = player.querySelector("input"), output = player.querySelector("output");
  const button = player.querySelector("button"), drawings = player.querySelectorAll("svg");
  let timer = null;
  const show = () => {
    const time = data.times[Number(slider.value)];
    output.textContent = time + " ms";
    slider.setAttribute("aria-valuetext", output.textContent);
    data.panels.forEach((panel, i) => {
      const now = Math.max(0, panel.times.filter(t => t <= time + 1e-9).length - 1);
      drawings[i].querySelector("image").setAttribute("href", panel.pictures[now]);
      const foci = drawings[i].querySelector(".foci"), at = panel.focus[now];
      foci.setAttribute("visibility", at ? "visible" : "hidden");  // hidden: the load has ended
      if (at) foci.setAttribute("transform", "translate(" + at.join(" ") + ")");
    });
  };
  const stop = () => { clearInterval(timer); timer = null; button.textContent = "Play"; };
  slider.addEventListener("input", () => { stop(); show(); });
  button.addEventListener("click", () => {
    if (timer !== null) { stop(); return; }
    button.textContent = "Pause";
    timer = setInterval(() => {
      slider.value = (Number(slider.value) + 1) % data.times.length;
      show();
    }, Math.max(80, Math.min(600, 6000 / data.times.length)));
  });
  show();
}
