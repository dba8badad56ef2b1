"use strict";
// Sorts a table by the column whose button was pressed: numbers by value, empty cells last.
function cellValue(cell) {
  if (cell.dataset.v !== undefined) return Number(cell.dataset.v);
  const text = cell.textContent.trim();
  return text === "" || text === "–" ? null : text;
}

function sortTable(table, column, descending) {
  const body = table.tBodies[0];
  const compare = (a, b) => {
    if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
    const numbers = typeof a.key === "number" && typeof b.key === "number";
    const order = numbers ? a.key - b.key : String(a.key).localeCompare(String(b.key));
    return descending ? -order : order;
  };
  Array.from(body.rows, row => ({row, key: cellValue(row.cells[column])})).sort(compare)
    .forEach(item => body.appendChild(item.row));
}

// A function row -> whether it passes one term of the filter: "column < 3" or a text that the row contains.
function term(text, names) {
  const found = /^\s*([^<>=]+?)\s*(<=|>=|<|>|=)\s*(\S+)\s*$/.exec(text);
  const column = found ? names.findIndex(name => name.toLowerCase().includes(found[1].toLowerCase())) : -1;
  if (column < 0) return row => row.textContent.toLowerCase().includes(text.trim().toLowerCase());
  const limit = isNaN(found[3]) ? found[3].toLowerCase() : Number(found[3]);
  const tests = {"<": v => v < limit, "<=": v => v <= limit, ">": v => v > limit, ">=": v => v >= limit, "=": v => v === limit};
  return row => {
    const value = cellValue(row.cells[column]);
    return value !== null && tests[found[2]](typeof value === "string" ? value.toLowerCase() : value);
  };
}

function csvText(table) {
  const quoted = text => /[",\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
  const rows = Array.from(table.rows).filter(row => !row.hidden);
  return rows.map(row => Array.from(row.cells, cell =>
    quoted(cell.dataset.name ?? cell.dataset.v ?? cell.textContent.trim().replace("–", ""))).join(",")).join("\n") + "\n";
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = Array.from(table.tHead.rows[0].cells), rows = Array.from(table.tBodies[0].rows);
  const names = heads.map(head => `${head.dataset.name} ${head.textContent}`), filter = document.querySelector("#filter");
  const count = document.querySelector("#count");
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const descending = head.getAttribute("aria-sort") === "ascending";
    heads.forEach(other => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", descending ? "descending" : "ascending");
    sortTable(table, column, descending);
  }));
  const select = () => {
    const tests = filter.value.split(",").filter(text => text.trim()).map(text => term(text, names));
    rows.forEach(row => { row.hidden = !tests.every(test => test(row)); });
    const shown = rows.filter(row => !row.hidden);
    count.textContent = shown.length + " of " + rows.length + (rows.length === 1 ? " case" : " cases");
    showCases(rows.filter(row => row.hidden || !row.querySelector("input").checked).map(row => row.dataset.id));
  };
  filter.addEventListener("input", select);
  table.addEventListener("change", select);
  document.querySelector("#csv").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([csvText(table)], {type: "text/csv"}));
    link.download = "cases.csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
}

// A link to a figure within a closed topic opens the topic.
function openTarget() {
  const target = location.hash.length > 1 ? document.getElementById(decodeURIComponent(location.hash.slice(1))) : null;
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  if (target) target.scrollIntoView();
}
addEventListener("hashchange", openTarget);
openTarget();

if (innerWidth < 1000) document.querySelector("nav .contents").open = false;  // the result comes first on a phone

// Marks the part of the page that is read in the contents.
const links = new Map(Array.from(document.querySelectorAll("nav a"), link => [link.hash.slice(1), link]));
const watch = new IntersectionObserver(entries => entries.forEach(entry => {
  if (!entry.isIntersecting) return;
  links.forEach(link => link.removeAttribute("aria-current"));
  links.get(entry.target.id).setAttribute("aria-current", "true");
}), {rootMargin: "-10% 0px -75% 0px"});
links.forEach((_, id) => { const part = document.getElementById(id); if (part) watch.observe(part); });
