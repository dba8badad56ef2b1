"use strict";
// The player of the surface. Each picture contains sign(u) sqrt(|u| / peak) as grey levels, see player.py.
class Field {
  constructor(width, height, values) { Object.assign(this, {width, height, values}); }
  static async read(url, peak) {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = image.naturalWidth;
    canvas.height = image.naturalHeight;
    const context = canvas.getContext("2d", {willReadFrequently: true});
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
    const values = new Float32Array(canvas.width * canvas.height);
    for (let i = 0; i < values.length; ++i) {
      const root = (pixels[4 * i] - 127.5) / 127.5;
      values[i] = root * Math.abs(root) * peak;
    }
    return new Field(canvas.width, canvas.height, values);
  }
  coloured(palette, end) {
    const canvas = document.createElement("canvas"), last = palette.length - 1;
    canvas.width = this.width;
    canvas.height = this.height;
    const context = canvas.getContext("2d"), image = context.createImageData(this.width, this.height);
    this.values.forEach((u, i) => {
      const level = Math.round(last * Math.min(1, Math.max(0, 0.5 + 0.5 * u / end)));
      image.data.set(palette[level], 4 * i);
      image.data[4 * i + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    return canvas;
  }
}

const MARGIN = {left: 42, right: 6, top: 6, bottom: 36};

class Panel {
  constructor(player, box, index) {
    Object.assign(this, {player, box, canvas: box.querySelector("canvas"), index});
    this.output = box.querySelector("output");
    this.chosen = box.querySelector(".chosen");
    this.selectors();
    this.connect();
  }
  // One select per swept axis, and one for the case itself or its reference.
  selectors() {
    const {axes, cases, reference, first} = this.player.data, holder = this.box.querySelector(".axes-of-cases");
    const add = (name, values) => {
      const label = document.createElement("label"), select = document.createElement("select");
      values.forEach((text, i) => select.add(new Option(text, i)));
      label.append(name + " ", select);
      holder.append(label);
      return select;
    };
    this.load = cases.some(c => c.reference !== undefined) ? add("Load", [this.player.data.load, reference]) : null;
    this.selects = axes.filter(axis => axis.values.length > 1).map(axis => add(axis.name, axis.values));
    this.shownAxes = axes.map((axis, i) => i).filter(i => axes[i].values.length > 1);
    const isReference = !cases[this.index].at;
    this.own = isReference ? [...first, ...cases.keys()].find(i => cases[i].reference === this.index) ?? first[0] : this.index;
    if (this.load) this.load.value = isReference ? 1 : 0;
    this.show();
    this.selects.forEach((select, n) => select.addEventListener("change", () => this.choose(n)));
    this.load?.addEventListener("change", () => { this.player.stop(); this.show(); this.player.retime(); });
  }
  choose(changed) {  // the case with the value that was chosen and as many of the other values as possible
    const wanted = this.selects.map(select => Number(select.value)), cases = this.player.data.cases;
    const score = c => c.at && c.at[this.shownAxes[changed]] === wanted[changed]
      ? this.shownAxes.filter((axis, n) => c.at[axis] === wanted[n]).length : -1;
    this.own = cases.map((c, i) => [score(c), -i]).sort((a, b) => b[0] - a[0] || b[1] - a[1])[0][1] * -1;
    this.player.stop();
    this.show();
    this.player.retime();
  }
  show() {
    const own = this.player.data.cases[this.own];
    this.index = this.load?.value === "1" && own.reference !== undefined ? own.reference : this.own;
    const common = this.index !== this.own && this.player.data.cases.every(c => !c.at || c.reference === this.index);
    this.selects.forEach((select, n) => {
      if (own.at) select.value = own.at[this.shownAxes[n]];
      select.parentElement.hidden = common;  // the reference of all cases has no such values
    });
  }
  get shown() { return this.player.data.cases[this.index]; }
  frame() {  // the last picture up to the time of the player; a load that repeats starts again after its period
    const period = this.shown.period, last = this.shown.times.length - 1;
    const time = period ? this.player.time() - period * Math.floor(this.player.time() / period - 1e-9) : this.player.time();
    const shown = this.shown.times.filter(t => t <= time + 1e-6).length - 1;
    return shown < 0 && period ? last : Math.max(0, shown);
  }
  scale() {  // pixels per mm and the size of the canvas in CSS pixels
    const [x0, x1, y0, y1] = this.player.view, width = this.box.clientWidth;
    const factor = (width - MARGIN.left - MARGIN.right) / (x1 - x0);
    return {factor, width, height: MARGIN.top + MARGIN.bottom + factor * (y1 - y0)};
  }
  place(x, y) {
    const {factor} = this.scale(), view = this.player.view;
    return [MARGIN.left + factor * (x - view[0]), MARGIN.top + factor * (view[3] - y)];
  }
  coordinates(event) {
    const box = this.canvas.getBoundingClientRect(), {factor} = this.scale(), view = this.player.view;
    return [view[0] + (event.clientX - box.left - MARGIN.left) / factor,
      view[3] - (event.clientY - box.top - MARGIN.top) / factor];
  }
  value(x, y) {
    const [x0, x1, y0, y1] = this.shown.extent, field = this.field;
    if (!field || x < x0 || x >= x1 || y <= y0 || y > y1) return null;
    return field.values[Math.floor((y1 - y) / (y1 - y0) * field.height) * field.width
      + Math.floor((x - x0) / (x1 - x0) * field.width)];
  }
  connect() {
    let start = null;
    this.canvas.addEventListener("pointerdown", event => { start = this.coordinates(event); });
    this.canvas.addEventListener("pointermove", event => this.player.point(this.coordinates(event)));
    this.canvas.addEventListener("pointerleave", () => { start = null; this.player.point(null); });
    this.canvas.addEventListener("pointerup", event => {
      const end = this.coordinates(event);
      if (start && Math.abs(end[0] - start[0]) > 1 && Math.abs(end[1] - start[1]) > 1)
        this.player.look([Math.min(start[0], end[0]), Math.max(start[0], end[0]),
          Math.min(start[1], end[1]), Math.max(start[1], end[1])]);
      else this.player.point(end);
      start = null;
    });
    this.canvas.addEventListener("dblclick", () => this.player.look(this.player.data.view));
  }
  async draw() {
    const frame = this.frame(), key = this.index + "/" + frame;
    this.wanted = key;
    const field = await this.player.field(this.index, frame);
    if (this.wanted !== key) return;  // another picture was requested meanwhile
    this.field = field;
    const end = this.player.end(this.shown.peaks[frame]), image = field.coloured(this.player.data.palette, end);
    const {factor, width, height} = this.scale(), sharp = devicePixelRatio;
    this.canvas.width = width * sharp;
    this.canvas.height = height * sharp;
    this.canvas.style.height = height + "px";
    const context = this.canvas.getContext("2d");
    context.scale(sharp, sharp);
    context.save();
    context.beginPath();
    context.rect(MARGIN.left, MARGIN.top, width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom);
    context.clip();
    const [x0, x1, y0, y1] = this.shown.extent, corner = this.place(x0, y1);
    context.drawImage(image, ...corner, factor * (x1 - x0), factor * (y1 - y0));
    this.marks(context, frame, factor);
    context.restore();
    this.axes(context, width, height);
    this.chosen.textContent = this.shown.label;  // a select cuts a label that is wider than itself
    this.canvas.dataset.frame = key;
    this.canvas.dataset.focus = JSON.stringify(this.shown.focus[frame]);
    this.report();
  }
  marks(context, frame, factor) {  // dotted path, focal disc with its centre, and the position of the pointer
    context.fillStyle = "#111";
    context.setLineDash([1, 4]);
    context.lineCap = "round";
    for (const [colour, width] of [["#fff", 2.6], ["#111", 1.1]])  // a white edge, visible on every colour
      for (const [dx, dy] of this.shown.offsets) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        this.shown.path.forEach(([x, y]) => context.lineTo(...this.place(x + dx, y + dy)));
        context.stroke();
      }
    context.lineCap = "butt";
    context.setLineDash([]);
    const focus = this.shown.focus[frame];
    for (const [dx, dy] of focus ? this.shown.offsets : []) {
      const centre = this.place(focus[0] + dx, focus[1] + dy);
      for (const [colour, width] of [["#fff", 4], ["#111", 1.8]]) {  // a white edge, unlike the path
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        context.arc(...centre, factor * this.shown.radius, 0, 2 * Math.PI);
        context.stroke();
      }
      context.beginPath();
      context.arc(...centre, 2.2, 0, 2 * Math.PI);
      context.fill();
    }
    if (!this.player.at) return;
    const [px, py] = this.place(...this.player.at);
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(px - 8, py); context.lineTo(px + 8, py);
    context.moveTo(px, py - 8); context.lineTo(px, py + 8);
    context.stroke();
  }
  axes(context, width, height) {
    const ink = getComputedStyle(document.body).color, [x0, x1, y0, y1] = this.player.view;
    const bottom = height - MARGIN.bottom, step = (low, high) => {
      const least = (high - low) / 5, power = 10 ** Math.floor(Math.log10(least));
      return [1, 2, 5, 10].map(f => f * power).find(v => v >= least);
    };
    context.strokeStyle = "#888";
    context.fillStyle = ink;
    context.font = "12px sans-serif";
    context.lineWidth = 1;
    context.strokeRect(MARGIN.left, MARGIN.top, width - MARGIN.left - MARGIN.right, bottom - MARGIN.top);
    context.textAlign = "center";
    const dx = step(x0, x1), dy = step(y0, y1);
    for (let x = Math.ceil(x0 / dx) * dx; x <= x1; x += dx)
      context.fillText(numberText(Number(x.toFixed(6))), this.place(x, 0)[0], bottom + 15);
    context.fillText("x (mm)", (MARGIN.left + width - MARGIN.right) / 2, bottom + 31);
    context.textAlign = "right";
    for (let y = Math.ceil(y0 / dy) * dy; y <= y1; y += dy)
      context.fillText(numberText(Number(y.toFixed(6))), MARGIN.left - 5, this.place(0, y)[1] + 4);
    context.save();
    context.translate(11, (MARGIN.top + bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("y (mm)", 0, 0);
    context.restore();
  }
  report() {  // the values at the pointer
    const at = this.player.at, frame = this.frame();
    let text = "t = " + numberText(this.shown.times[frame]) + " ms, largest |u| " + numberText(this.shown.peaks[frame]) + " µm";
    if (at) {
      const u = this.value(...at);
      text = "x " + numberText(at[0]) + " mm, y " + numberText(at[1]) + " mm: u " + numberText(u) + " µm";
    }
    this.output.textContent = text;
  }
}

// The times of the pictures of a load that repeats, up to `end`.
function repeated(shown, end) {
  const times = [];
  for (let start = 0; start + shown.times[0] <= end + 1e-6; start += shown.period)
    times.push(...shown.times.map(t => Number((start + t).toFixed(6))).filter(t => t <= end + 1e-6));
  return times;
}

class Player {
  constructor(root) {
    Object.assign(this, {root, data: JSON.parse(root.querySelector("script").textContent), fields: new Map(), at: null});
    this.view = this.data.view;
    const find = name => root.querySelector(name);
    this.slider = find("input[type=range]");
    this.timed = [find(".play"), find(".back"), find(".forward"), this.slider, find(".speed").parentElement];
    this.button = find(".play");
    this.clock = find(".clock");
    this.speed = find(".speed");
    this.scaling = find(".scaling");
    this.panels = Array.from(root.querySelectorAll(".player-panel"), (box, i) => new Panel(this, box, this.data.first[i]));
    this.slider.addEventListener("input", () => { this.stop(); this.draw(); });
    this.button.addEventListener("click", () => this.timer ? this.stop() : this.play());
    find(".back").addEventListener("click", () => this.step(-1));
    find(".forward").addEventListener("click", () => this.step(1));
    find(".whole").addEventListener("click", () => this.look(this.data.view));
    find(".closer").addEventListener("click", () => this.zoom(0.5));
    this.scaling.addEventListener("change", () => this.draw());
    addEventListener("resize", () => this.draw());
    this.retime();
    this.slider.value = this.times.length - 1;
    this.draw();
  }
  time() { return this.times[Number(this.slider.value)]; }
  retime() {  // the times of the cases shown; keeps the time as far as possible
    const before = this.times ? this.time() : 0;
    const end = Math.max(...this.panels.map(panel => panel.shown.times[panel.shown.times.length - 1]));
    const times = this.panels.flatMap(panel => panel.shown.period ? repeated(panel.shown, end) : panel.shown.times);
    this.times = [...new Set(times)].sort((a, b) => a - b);
    for (const part of this.timed) part.hidden = this.times.length < 2;  // a single time cannot be played
    this.slider.max = this.times.length - 1;
    this.slider.value = Math.max(0, this.times.filter(t => t <= before + 1e-9).length - 1);
    this.draw();
  }
  field(index, frame) {
    const key = index + "/" + frame, shown = this.data.cases[index];
    if (!this.fields.has(key)) {
      if (this.fields.size > 400) this.fields.delete(this.fields.keys().next().value);
      this.fields.set(key, Field.read("data:image/webp;base64," + shown.pictures[frame], shown.peaks[frame]));
    }
    return this.fields.get(key);
  }
  end(peak) {
    return {wake: this.data.wake, half: this.data.wake / 2, peak: this.data.peak, own: peak || 1}[this.scaling.value];
  }
  draw() {
    this.clock.textContent = numberText(this.time()) + " ms";
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    const own = this.scaling.value === "own", end = numberText(this.end(0));
    this.root.querySelector(".low").textContent = own ? "−largest |u|" : "\u2212" + end;
    this.root.querySelector(".high").textContent = own ? "largest |u| of each picture" : end + " µm";
    return Promise.all(this.panels.map(panel => panel.draw()));
  }
  point(at) {
    this.at = at;
    this.panels.forEach(panel => panel.draw());
  }
  look(view) { this.view = view; this.draw(); }
  zoom(factor) {  // around the focus of the first panel
    const [x0, x1, y0, y1] = this.view, panel = this.panels[0], focus = panel.shown.focus[panel.frame()];
    const [x, y] = focus || [(x0 + x1) / 2, (y0 + y1) / 2], w = factor * (x1 - x0) / 2, h = factor * (y1 - y0) / 2;
    this.look([x - w, x + w, y - h, y + h]);
  }
  step(by) {
    this.stop();
    this.slider.value = (Number(this.slider.value) + by + this.times.length) % this.times.length;
    this.draw();
  }
  stop() { clearTimeout(this.timer); this.timer = null; this.button.textContent = "Play"; }
  play() {
    this.button.textContent = "Pause";
    const run = this.run = {};  // another press of Play starts another run
    const next = async () => {
      const now = (Number(this.slider.value) + 1) % this.times.length, before = performance.now();
      this.slider.value = now;
      await this.draw();
      if (!this.timer || this.run !== run) return;
      const again = this.panels.every(panel => panel.shown.period) ? this.times[0] * Number(this.speed.value) : 1000;
      const pause = now + 1 < this.times.length ? (this.times[now + 1] - this.times[now]) * Number(this.speed.value) : again;
      this.timer = setTimeout(next, Math.max(15, pause - (performance.now() - before)));
    };
    this.timer = setTimeout(next, 0);
  }
}

document.querySelectorAll(".player").forEach(root => { root.player = new Player(root); });
