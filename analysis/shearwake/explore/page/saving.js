"use strict";
// Files that the page saves: pictures with their title, scale and settings, curves, tables and jobs.
function download(name, content, type) {
  const link = element("a", {download: name, href: URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type}))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// A setting in one line, and everything that it contains.
function titleOf(s, kind = s.kind) {
  const parts = [s.layers ? "edited layers" : PRESETS[s.preset].label, kind];
  if (MOVES(s)) parts.push(`${rounded(s.speed)} m/s`, s.path);
  if (s.kind !== "STM") parts.push(`${rounded(s.am)} Hz`);
  parts.push(s.focus === "array" ? `array at ${s.distance} mm` : `focus of ${s.fwhm} mm`);
  return parts.join(", ");
}
function settingLines(s) {
  const tissue = s.layers ? s.layers.map(layer => `${layer.name}: ${rounded(layer.c_s_m_s)} m/s`).join("; ") : PRESETS[s.preset].label;
  const values = Object.entries(SLIDERS).filter(([, spec]) => spec.shows(s))
    .map(([name, {label, unit}]) => `${label} ${rounded(s[name], 4)}${unit ? " " + unit : ""}`);
  return [`Tissue: ${tissue}. ${values.join("; ")}.`, isSteady(s) ? `Steady state with a period of ${rounded(period_ms(s), 4)} ms.`
    : `${s.duration} ms after a start from rest.`];
}

function wrapped(context, text, width) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = lines.at(-1) ? `${lines.at(-1)} ${word}` : word;
    if (lines.at(-1) && context.measureText(longer).width > width) lines.push(word); else lines[lines.length - 1] = longer;
  }
  return lines;
}

// A canvas with a title, tiles side by side, each of canvases on top of each other and lines of text, a scale and lines below.
function composed(title, tiles, scale, lines) {
  const tile = tiles.length > 1 ? 480 : 1200, gap = 20, width = tiles.length * (tile + gap) + gap, height = 0.75 * tile, size = 22;
  const canvas = element("canvas", {width, height: 4000}), context = canvas.getContext("2d");
  let y = gap;
  const write = (text, x, room, font) => {
    context.font = `${font} ${size}px system-ui, sans-serif`;
    for (const line of wrapped(context, text, room)) { context.fillText(line, x, y); y += 1.4 * size; }
  };
  context.fillStyle = "#fff";
  context.fillRect(0, 0, width, canvas.height);
  context.fillStyle = "#111";
  context.textBaseline = "top";
  write(title, gap, width - 2 * gap, "600");
  const top = y + 8;
  let below = top;
  tiles.forEach(({layers, text}, i) => {
    const x = gap + i * (tile + gap);
    for (const layer of layers) context.drawImage(layer, x, top, tile, height);
    y = top + height + 10;
    for (const line of text) write(line, x, tile, "400");
    below = Math.max(below, y);
  });
  y = below + 10;
  context.imageSmoothingEnabled = true;
  context.drawImage(scale.map, gap, y, width - 2 * gap, 18);
  y += 26;
  context.font = `400 ${size}px system-ui, sans-serif`;
  context.fillText(scale.low, gap, y);
  context.textAlign = "right";
  context.fillText(scale.high, width - gap, y);
  context.textAlign = "left";
  y += 2 * size;
  for (const line of lines) write(line, gap, width - 2 * gap, "400");
  const cut = element("canvas", {width, height: Math.ceil(y + gap)});
  cut.getContext("2d").drawImage(canvas, 0, 0);
  return cut;
}

function savePicture(name, canvas) {
  return new Promise(done => canvas.toBlob(blob => { download(`${name}.png`, blob); done(blob); }, "image/png"));
}

// About five round values between two numbers.
function ticks(low, high) {
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough)), step = power * [1, 2, 5, 10].find(factor => factor * power >= rough);
  const all = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) all.push(rounded(k * step, 6));
  return all;
}

// A curve of the page as SVG.
function svgOf({plot, across, along}, title) {
  const [xs, ys] = plot.data, width = 640, height = 360, left = 80, bottom = 300, right = 620, top = 40;
  const escaped = text => String(text).replace(/[&<>]/g, c => ({"&": "&amp;", "<": "&lt;", ">": "&gt;"})[c]);
  const {min, max} = plot.scales.y, x0 = xs[0], x1 = xs.at(-1);
  const x = value => left + (right - left) * (value - x0) / (x1 - x0 || 1), y = value => bottom - (bottom - top) * (value - min) / (max - min || 1);
  const line = (a, b, c, d) => `<path d="M${a} ${b}L${c} ${d}" stroke="#ccc"/>`;
  const text = (a, b, value, more = "") => `<text x="${a}" y="${b}" ${more}>${escaped(value)}</text>`;
  const grid = [...ticks(x0, x1).map(value => line(x(value), top, x(value), bottom) + text(x(value), bottom + 18, value, 'text-anchor="middle"')),
    ...ticks(min, max).map(value => line(left, y(value), right, y(value)) + text(left - 6, y(value) + 4, value, 'text-anchor="end"'))];
  const points = xs.map((value, i) => [value, ys[i]]).filter(([, value]) => isNumber(value)).map(([a, b]) => `${x(a).toFixed(2)},${y(b).toFixed(2)}`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="13">`
    + `<rect width="100%" height="100%" fill="#fff"/>${grid.join("")}<polyline points="${points.join(" ")}" fill="none" stroke="#0072b2" stroke-width="1.5"/>`
    + text(left, 22, title) + text(0.5 * (left + right), height - 12, across, 'text-anchor="middle"')
    + text(0, 0, along, `text-anchor="middle" transform="translate(18 ${0.5 * (top + bottom)}) rotate(-90)"`) + "</svg>\n";
}
