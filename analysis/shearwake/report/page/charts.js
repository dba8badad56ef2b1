"use strict";
// Draws the interactive figures with uPlot. Each .chart contains its panels as JSON, see chart.py.
const charts = [];  // {plot, lines} of all panels drawn so far
const hiddenCases = new Set();

// Three significant digits more than the eye can read from a picture; true minus signs.
function numberText(value) {
  if (value === null || value === undefined || !isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(3).replace(/\.?0+e/, "e") : String(Number(value.toPrecision(4)));
  return text.replace("-", "\u2212");
}

// Vertical bars of half length `error` at the points of each visible line.
function drawErrors(plot, lines) {
  const context = plot.ctx, pixel = devicePixelRatio, cap = 3 * pixel;
  lines.forEach((line, i) => {
    if (!line.error || !plot.series[i + 1].show) return;
    context.save();
    context.strokeStyle = line.colour;
    context.setLineDash([]);  // uPlot leaves the dashes of its last line
    context.lineWidth = 1.2 * pixel;
    context.beginPath();
    line.x.forEach((x, k) => {
      if (line.y[k] === null || line.error[k] === null) return;
      const at = plot.valToPos(x, "x", true);
      const low = plot.valToPos(line.y[k] - line.error[k], "y", true);
      const high = plot.valToPos(line.y[k] + line.error[k], "y", true);
      context.moveTo(at, low); context.lineTo(at, high);
      context.moveTo(at - cap, low); context.lineTo(at + cap, low);
      context.moveTo(at - cap, high); context.lineTo(at + cap, high);
    });
    context.stroke();
    context.restore();
  });
}

// Crosses at the points of lines of values that are not valid.
function drawCrosses(plot, lines) {
  const context = plot.ctx, arm = 4 * devicePixelRatio;
  lines.forEach((line, i) => {
    if (!line.crossed || !plot.series[i + 1].show) return;
    context.save();
    context.strokeStyle = line.colour;
    context.setLineDash([]);
    context.lineWidth = 1.8 * devicePixelRatio;
    context.beginPath();
    line.x.forEach((x, k) => {
      if (line.y[k] === null) return;
      const at = plot.valToPos(x, "x", true), up = plot.valToPos(line.y[k], "y", true);
      context.moveTo(at - arm, up - arm); context.lineTo(at + arm, up + arm);
      context.moveTo(at - arm, up + arm); context.lineTo(at + arm, up - arm);
    });
    context.stroke();
    context.restore();
  });
}

// Bands and dotted lines below the lines of a panel; ticks and dots above them.
function drawMarks(plot, marks, kinds) {
  const context = plot.ctx, pixel = devicePixelRatio, {left, top, width, height} = plot.bbox;
  const across = v => plot.valToPos(v, "x", true);
  context.save();
  context.beginPath();
  context.rect(left, top, width, height);
  context.clip();
  for (const mark of marks) {
    if (!kinds.includes(mark.kind) || hiddenCases.has(mark.case)) continue;
    const x = across(mark.x);
    context.strokeStyle = context.fillStyle = mark.kind === "band" ? "rgba(0, 0, 0, 0.055)" : mark.colour;
    context.setLineDash(mark.kind === "line" ? [1.5 * pixel, 2.5 * pixel] : []);
    context.lineWidth = (mark.kind === "tick" ? 2.5 : 1) * pixel;
    context.beginPath();
    if (mark.kind === "band") context.rect(x, top, across(mark.end) - x, height);
    if (mark.kind === "dot") context.arc(x, plot.valToPos(mark.y, "y", true), 4 * pixel, 0, 2 * Math.PI);
    if (mark.kind === "line") { context.moveTo(x, top); context.lineTo(x, top + height); }
    if (mark.kind === "tick") { context.moveTo(x, top + height); context.lineTo(x, top + 0.96 * height); }
    if (mark.kind === "band" || mark.kind === "dot") context.fill(); else context.stroke();
  }
  context.restore();
}

// The point that is nearest to the pointer in pixels: [line, index] or null.
function nearest(plot, lines) {
  let best = null, least = 40 * 40;
  lines.forEach((line, i) => {
    if (!plot.series[i + 1].show) return;
    line.x.forEach((x, k) => {
      if (line.y[k] === null) return;
      const dx = plot.valToPos(x, "x") - plot.cursor.left, dy = plot.valToPos(line.y[k], "y") - plot.cursor.top;
      if (dx * dx + dy * dy < least) { least = dx * dx + dy * dy; best = [line, k]; }
    });
  });
  return best;
}

// About six multiples of 1, 2 or 5 times a power of ten.
function evenSteps(low, high) {
  const wanted = (high - low) / 6 || 1, power = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(size => size >= wanted);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1)}, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

function axes(panel) {
  const look = {stroke: "#222", grid: {stroke: "#e6e6e6", width: 1}, ticks: {stroke: "#888", width: 1}, font: "12px sans-serif",
    labelFont: "12px sans-serif"};
  const x = {...look, label: panel.x_label}, y = {...look, label: panel.y_label,
    size: (plot, values) => Math.max(62, 18 + 6.8 * Math.max(0, ...(values || []).map(text => (text || "").length)))};
  if (panel.x_names) {
    x.splits = () => panel.x_names.map((_, i) => i);
    x.values = (plot, splits) => splits.map(i => panel.x_names[i] ?? "");
  } else {
    const marked = [...new Set(panel.lines.filter(line => line.points).flatMap(line => line.x))].sort((a, b) => a - b);
    if (marked.length && marked.length <= 12)  // ticks at the swept values if all of them fit, else at even steps
      x.splits = (plot, axis, low, high) => {
        const shown = marked.filter(v => v >= low && v <= high);
        const fit = shown.every((v, i) => i === 0 || plot.valToPos(v, "x") - plot.valToPos(shown[i - 1], "x") > 34);
        return fit || panel.x_log ? shown.filter((v, i) => fit || i % 2 === 0) : evenSteps(low, high);
      };
    x.values = (plot, splits) => splits.map(v => v === null ? "" : numberText(v));
  }
  y.values = (plot, splits) => splits.map(v => v === null ? "" : numberText(v));
  if (panel.y_log && !panel.y_ticks) {  // powers of ten; uPlot would begin at the end of the scale
    y.splits = (plot, axis, low, high) => {
      const first = Math.floor(Math.log10(low)), count = Math.ceil(Math.log10(high)) - first + 1, step = Math.ceil(count / 8);
      const steps = Math.log10(high / low) < 2 ? [1, 2, 5] : [1];
      return Array.from({length: count}, (_, i) => first + i).filter(n => n % step === 0).flatMap(n => steps.map(s => Number(`${s}e${n}`)))
        .filter(v => v >= low && v <= high);
    };
    y.filter = (plot, splits) => splits;
  }
  if (panel.y_ticks) {  // a logarithmic scale around 1, which need not contain a decade
    y.splits = (plot, axis, low, high) => panel.y_ticks.filter(v => v >= low && v <= high);
    y.filter = (plot, splits) => splits;
  }
  return [x, y];
}

// All points with a margin at first, exactly the selected part after zooming; uPlot would round to decades.
function horizontalRange(panel) {
  const x = panel.lines.flatMap(line => line.x), first = Math.min(...x), last = Math.max(...x);
  const room = panel.x_names ? 0.5 : panel.lines.some(line => line.points) ? 0.04 * (last - first || 1) : 0;
  const factor = (last / first || 1) ** 0.04 || 1;
  return (plot, low, high) => low !== first || high !== last ? [low, high]
    : panel.x_log ? [first / factor, last * factor] : [first - room, last + room];
}

function verticalRange(panel) {
  if (panel.y_log) return {distr: 3, range: panel.y_limits ?? undefined};
  const bars = panel.lines.flatMap(line => line.y.flatMap((v, k) =>
    v === null ? [] : [v - (line.error?.[k] ?? 0), v + (line.error?.[k] ?? 0)]));
  if (panel.y_limits) return {range: panel.y_limits};
  const low = Math.min(...bars), high = Math.max(...bars), room = 0.06 * (high - low || Math.abs(high) || 1);
  return {range: [low - room, high + room]};
}

function drawPanel(holder, panel, output, key) {
  const box = document.createElement("div");
  box.className = "panel";
  holder.appendChild(box);
  if (panel.title) box.insertAdjacentHTML("beforeend", "<p class='panel-title'></p>");
  if (panel.title) box.lastChild.textContent = panel.title;
  const name = panel.x_names ? v => panel.x_names[Math.round(v)] ?? "" : v => numberText(v);
  const spanGaps = !panel.lines.some(line => line.points);  // curves end where a reading is not valid
  const series = panel.lines.map(line => ({label: (line.crossed ? "\u00d7 " : "") + line.label, stroke: line.colour, width: 1.6,
    dash: line.dashed ? [6, 4] : undefined, spanGaps, show: !hiddenCases.has(line.case),
    paths: line.crossed || line.dots || (panel.x_names && !line.dashed) ? () => null : undefined,
    points: {show: (line.points || line.dots) && !line.crossed, size: line.dots && !line.points ? 5 : 7, fill: line.colour}, value: (plot, v) => numberText(v)}));
  const plot = new uPlot({
    width: Math.max(260, holder.clientWidth), height: holder.clientWidth < 500 ? 260 : 320,
    series: [{label: panel.x_label, value: (p, v) => v === null ? "–" : name(v)}, ...series], axes: axes(panel),
    scales: {x: {time: false, distr: panel.x_log ? 3 : 1, range: horizontalRange(panel)},
      y: verticalRange(panel)},
    cursor: {sync: {key}, drag: {x: true, y: false}, focus: {prox: 30}}, focus: {alpha: 0.35},
    legend: {show: false},
    hooks: {drawAxes: [p => drawMarks(p, panel.marks, ["band", "line"])],
      draw: [p => drawMarks(p, panel.marks, ["tick", "dot"]), p => drawErrors(p, panel.lines), p => drawCrosses(p, panel.lines)], setCursor: [p => {
      const found = p.cursor.left >= 0 ? nearest(p, panel.lines) : null;
      if (!found) return;
      const [line, k] = found;
      const bar = line.error && line.error[k] !== null ? " ± " + numberText(line.error[k]) : "";
      output.textContent = line.label + ": " + panel.x_label + " " + name(line.x[k]) + ", " + panel.y_label + " "
        + numberText(line.y[k]) + bar;
    }]}}, uPlot.join(panel.lines.map(line => [line.x, line.y])), box);
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", [panel.title, panel.y_label + " against " + panel.x_label].filter(text => text).join(": ")
    + "; the data below the chart list its values");
  const buttons = legend(box, panel, plot);
  charts.push({plot, lines: panel.lines, holder, buttons});
  return plot;
}

// A button per line of a panel that hides and shows the line.
function legend(box, panel, plot) {
  const bar = document.createElement("div");
  bar.className = "legend";
  bar.setAttribute("role", "group");
  bar.setAttribute("aria-label", "lines");
  const buttons = panel.lines.map((line, i) => {
    const button = document.createElement("button"), sample = document.createElement("i");
    button.type = "button";
    sample.className = line.crossed ? "cross" : line.dots || (panel.x_names && !line.dashed) ? "dot" : line.dashed ? "dash" : "line";
    sample.style.color = line.colour;
    if (line.crossed) sample.textContent = "\u00d7";
    button.append(sample, line.label);
    button.setAttribute("aria-pressed", plot.series[i + 1].show);
    button.addEventListener("click", () => {
      const show = !plot.series[i + 1].show;
      plot.setSeries(i + 1, {show});
      button.setAttribute("aria-pressed", show);
    });
    button.addEventListener("pointerenter", () => plot.setSeries(i + 1, {focus: true}));
    button.addEventListener("pointerleave", () => plot.setSeries(null, {focus: true}));
    bar.append(button);
    return button;
  });
  box.append(bar);
  return buttons;
}

// The values of panels as tables, which are made when they are opened.
function dataTables(panels) {
  const part = document.createElement("details"), summary = document.createElement("summary");
  part.className = "data";
  summary.textContent = "Data of this chart";
  part.append(summary);
  part.addEventListener("toggle", () => {
    if (part.open && part.children.length === 1) panels.forEach(panel => part.append(dataTable(panel)));
  });
  return part;
}

function dataTable(panel) {
  const lines = panel.lines.filter(line => line.y.some(v => v !== null));
  const places = [...new Set(lines.flatMap(line => line.x))].sort((a, b) => a - b);
  const heads = lines.map(line => line.crossed ? line.label : line.label + (line.error ? " ± error" : ""));
  const rows = places.map(x => [panel.x_names ? panel.x_names[Math.round(x)] ?? "" : numberText(x), ...lines.map(line => {
    const k = line.x.indexOf(x), error = k < 0 ? null : line.error?.[k];
    return k < 0 || line.y[k] === null ? "" : numberText(line.y[k]) + (error != null ? " ± " + numberText(error) : "");
  })]);
  return scrolled(tableOf([panel.title, panel.y_label].filter(text => text).join(", "), [panel.x_label, ...heads], rows));
}

function tableOf(caption, heads, rows) {
  const table = document.createElement("table"), row = (cells, head) => {
    const line = document.createElement("tr");
    cells.forEach((text, i) => {
      const cell = document.createElement(head || i === 0 ? "th" : "td");
      if (head) cell.scope = "col"; else if (i === 0) cell.scope = "row"; else cell.className = "n";
      cell.textContent = text;
      line.append(cell);
    });
    return line;
  };
  table.createCaption().textContent = caption;
  table.createTHead().append(row(heads, true));
  const body = table.createTBody();
  rows.forEach(cells => body.append(row(cells, false)));
  return table;
}

function scrolled(table) {
  const box = document.createElement("div");
  box.className = "scroll short";
  box.tabIndex = 0;
  box.setAttribute("role", "region");
  box.setAttribute("aria-label", table.caption.textContent);
  box.append(table);
  return box;
}

// The heading of a figure names its charts and pictures.
function nameAfterHeading(holder) {
  holder.setAttribute("role", "group");
  holder.setAttribute("aria-label", holder.closest("figure").previousElementSibling.textContent);
}

function drawCharts(holder) {
  if (holder.dataset.drawn || !holder.clientWidth) return;
  holder.dataset.drawn = "yes";
  nameAfterHeading(holder);
  const panels = JSON.parse(holder.querySelector("script").textContent);
  const output = document.createElement("output"), reset = document.createElement("button");
  reset.type = "button";
  reset.textContent = "Reset zoom";
  const bar = document.createElement("div");
  bar.className = "readout";
  output.textContent = "Point at a line to read its values; drag to zoom; select names to hide lines.";
  bar.append(output, reset);
  holder.appendChild(bar);
  const plots = panels.map(panel => drawPanel(holder, panel, output, holder.id + panel.x_label));
  holder.append(dataTables(panels));
  reset.addEventListener("click", () => plots.forEach(plot =>
    plot.setData(plot.data)));  // also restores the scales
}

// Shows or hides the lines of cases in all figures, as the table selects them.
function showCases(hidden) {
  hiddenCases.clear();
  hidden.forEach(id => hiddenCases.add(id));
  for (const {plot, lines, buttons} of charts)
    lines.forEach((line, i) => {
      const show = !hiddenCases.has(line.case);
      if (line.case && plot.series[i + 1].show !== show) plot.setSeries(i + 1, {show});
      buttons[i].setAttribute("aria-pressed", plot.series[i + 1].show);
    });
}

const drawVisibleCharts = () => document.querySelectorAll(".chart").forEach(drawCharts);
document.querySelectorAll("details").forEach(part => part.addEventListener("toggle", drawVisibleCharts));
function fitCharts() {
  drawVisibleCharts();
  for (const {plot, holder} of charts)
    if (holder.clientWidth && Math.abs(plot.width - holder.clientWidth) > 2)
      plot.setSize({width: holder.clientWidth, height: plot.height});
}
addEventListener("resize", fitCharts);
drawVisibleCharts();

// Prints contain all figures: all topics are open while the page is printed.
const closed = [];
addEventListener("beforeprint", () => {
  document.querySelectorAll("details.topic:not([open])").forEach(part => { part.open = true; closed.push(part); });
  fitCharts();
});
addEventListener("afterprint", () => closed.splice(0).forEach(part => { part.open = false; }));
