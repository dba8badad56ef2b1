"use strict";
// Shows the values of the maps of a picture under the pointer, see hover.py.
function unpacked(map) {
  if (map.values) return map.values;
  const bytes = Uint8Array.from(atob(map.packed), letter => letter.charCodeAt(0));
  const numbers = new DataView(bytes.buffer);
  return Array.from({length: bytes.length / 2}, (_, i) => {
    const whole = numbers.getInt16(2 * i, true);
    return whole === -32768 ? null : whole * map.scale;
  });
}

// The column or row at a coordinate, and its name; null outside the map.
function cellAt(at, [first, last], count, names) {
  const index = Math.floor((at - first) / (last - first) * count);
  return index < 0 || index >= count ? null : {index, name: names ? names[index] : numberText(at)};
}

// The text for a point of a picture, given in fractions from its lower left corner; "" outside all maps.
function mapText(maps, across, up) {
  for (const map of maps) {
    const [left, bottom, width, height] = map.box, fx = (across - left) / width, fy = (up - bottom) / height;
    if (fx < 0 || fx > 1 || fy < 0 || fy > 1) continue;
    const [[x0, x1], [y0, y1]] = map.limits, [rows, columns] = map.shape;
    const x = cellAt(x0 + fx * (x1 - x0), map.x, columns, map.x_names);
    const y = cellAt(y0 + fy * (y1 - y0), map.y, rows, map.y_names);
    if (!x || !y) return "";
    map.numbers ??= unpacked(map);
    const value = map.numbers[y.index * columns + x.index];
    const place = [map.title, `${map.x_label} ${x.name}`, `${map.y_label} ${y.name}`].map(text => text.trim());
    return `${place.filter(text => text).join(", ")}: ${map.what} `
      + (value === null ? "no value" : numberText(value) + (map.unit ? " " + map.unit : ""))
      + (map.error?.[y.index * columns + x.index] != null ? " ± " + numberText(map.error[y.index * columns + x.index]) : "")
      + (map.invalid?.includes(y.index * columns + x.index) ? " (not valid)" : "");
  }
  return "";
}

// The values of maps as tables, which are made when they are opened; of a map with many values some rows and columns.
function mapTables(maps) {
  const part = document.createElement("details"), summary = document.createElement("summary"), most = 24;
  part.className = "data";
  summary.textContent = "Data of this picture";
  part.append(summary);
  part.addEventListener("toggle", () => {
    if (!part.open || part.children.length > 1) return;
    for (const map of maps) {
      map.numbers ??= unpacked(map);
      const [height, width] = map.shape, down = Math.ceil(height / most), across = Math.ceil(width / most);
      const name = (index, count, [first, last], names) => names ? names[index] : numberText(first + (index + 0.5) / count * (last - first));
      const columns = Array.from({length: Math.ceil(width / across)}, (_, i) => i * across);
      const rows = Array.from({length: Math.ceil(height / down)}, (_, i) => i * down).map(y => [name(y, height, map.y, map.y_names),
        ...columns.map(x => { const k = y * width + x, value = map.numbers[k], error = map.error?.[k];
          return value === null ? "" : numberText(value) + (error != null ? " ± " + numberText(error) : "") + (map.invalid?.includes(k) ? " (not valid)" : ""); })]);
      const thinned = down > 1 || across > 1 ? `; 1 of ${down} rows and 1 of ${across} columns` : "";
      part.append(scrolled(tableOf([map.title, map.what + (map.unit ? ` (${map.unit})` : "")].filter(text => text).join(", ") + thinned,
        [[map.y_label, map.x_label].filter(text => text).join(" \\ "), ...columns.map(x => name(x, width, map.x, map.x_names))], rows)));
    }
  });
  return part;
}

for (const holder of document.querySelectorAll(".maps")) {
  const image = holder.querySelector("img"), output = holder.querySelector("output");
  const maps = JSON.parse(holder.querySelector("script").textContent);
  const show = event => {
    const box = image.getBoundingClientRect();
    const text = mapText(maps, (event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height);
    if (text) output.textContent = text;
  };
  nameAfterHeading(holder);
  holder.append(mapTables(maps));
  image.addEventListener("pointermove", show);
  image.addEventListener("pointerdown", show);
}
