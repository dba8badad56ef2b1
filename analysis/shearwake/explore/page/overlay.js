"use strict";
// What lies over the surface: focus, path, Mach lines, receptors, probe and axes.
class Overlay {
  constructor(canvas, moved) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.probe = [0, 0];  // mm
    this.moved = moved;
    this.sketch = null;  // a path that is being drawn
    canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); this.point(event); });
    canvas.addEventListener("pointermove", event => { if (event.buttons) this.point(event); });
    canvas.addEventListener("keydown", event => this.key(event));
  }
  fit() {
    const box = this.canvas.getBoundingClientRect(), factor = window.devicePixelRatio || 1;
    const width = Math.round(factor * box.width), height = Math.round(factor * box.height);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
    this.factor = factor;
  }
  get extent() { return [WIDTH_mm, HEIGHT_mm]; }
  pixels([x, y]) {
    const [width, height] = this.extent;
    return [(x / width + 0.5) * this.canvas.width, (0.5 - y / height) * this.canvas.height];
  }
  place(event) {  // in mm
    const box = this.canvas.getBoundingClientRect(), [width, height] = this.extent;
    return [((event.clientX - box.left) / box.width - 0.5) * width, (0.5 - (event.clientY - box.top) / box.height) * height];
  }
  point(event) {
    if (this.sketch) return;
    this.move(this.place(event));
  }
  key(event) {
    const step = event.shiftKey ? 10 : 1;
    const by = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]}[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    this.move([this.probe[0] + by[0], this.probe[1] + by[1]]);
  }
  move([x, y]) {
    const [width, height] = this.extent;
    this.probe = [Math.min(0.5 * width, Math.max(-0.5 * width, x)), Math.min(0.5 * height, Math.max(-0.5 * height, y))];
    this.moved();
  }
  line(points, style, width) {
    const context = this.context;
    context.strokeStyle = style;
    context.lineWidth = width * this.factor;
    context.beginPath();
    points.forEach((point, i) => context[i ? "lineTo" : "moveTo"](...this.pixels(point)));
    context.stroke();
  }
  dot(point, radius, style) {
    this.context.fillStyle = style;
    this.context.beginPath();
    this.context.arc(...this.pixels(point), radius * this.factor, 0, 2 * Math.PI);
    this.context.fill();
  }
  ring(point, radius_mm, style) {
    this.context.strokeStyle = style;
    this.context.lineWidth = 2 * this.factor;
    this.context.beginPath();
    this.context.arc(...this.pixels(point), radius_mm * this.canvas.width / this.extent[0], 0, 2 * Math.PI);
    this.context.stroke();
  }
  draw(result, n, options) {
    this.result = result;
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (result) {
      if (options.receptors) this.drawReceptors(result, n);
      if (options.mach) this.drawMach(result, n);
      if (options.focus) this.drawFocus(result, n);
      this.drawProbe();
      this.drawAxes();
    }
    if (this.sketch) this.line(this.sketch, "#d55e00", 3);
  }
  drawFocus(result, n) {
    const from = Math.max(0, n - 40), trail = [];
    for (let k = from; k <= n; ++k) trail.push(result.focus(k));
    this.line(trail, "#0009", 1.5);
    const shifts = result.header.foci_m.length ? result.header.foci_m : [[0, 0]], [x, y] = result.focus(n);
    for (const shift of shifts) this.ring([x + 1e3 * shift[0], y + 1e3 * shift[1]], 0.5e3 * result.header.fwhm_m, "#111");
    this.drawMotion(result, n);
  }
  // Velocity in m/s at a frame.
  velocity(result, n) {
    const [x, y] = result.focus(n), [x0, y0] = result.focus(Math.max(0, n - 1)), dt = result.time[1] - result.time[0];
    return [1e-3 * (x - x0) / dt, 1e-3 * (y - y0) / dt];
  }
  // An arrow in the direction of the motion, ahead of the focus.
  drawMotion(result, n) {
    const [vx, vy] = this.velocity(result, n), speed = Math.hypot(vx, vy);
    if (n < 1 || !(speed > 0.05)) return;
    const [x, y] = result.focus(n), ex = vx / speed, ey = vy / speed, from = 0.6e3 * result.header.fwhm_m + 1, to = from + 9;
    const at = (along, across) => [x + along * ex - across * ey, y + along * ey + across * ex];
    this.line([at(from, 0), at(to, 0)], "#111", 1.5);
    this.line([at(to - 2.5, 1.5), at(to, 0), at(to - 2.5, -1.5)], "#111", 1.5);
  }
  // The number of frames before this one in which the focus has moved straight on and faster than the waves of the surface.
  supersonic(result, n) {
    const [vx, vy] = this.velocity(result, n);
    let frames = 0;
    for (let k = n; k >= 1; --k, ++frames) {
      const [ux, uy] = this.velocity(result, k), speed = Math.hypot(ux, uy);
      if (speed <= result.header.surface_wave_m_s || ux * vx + uy * vy < 0.9999 * speed * Math.hypot(vx, vy)) break;
    }
    return frames;
  }
  // The lines along which waves of the surface add up behind a focus on a straight path that is faster than they are.
  drawMach(result, n) {
    const frames = this.supersonic(result, n);
    this.mach_deg = null;
    if (frames < 5) return;
    const [x, y] = result.focus(n), [x0, y0] = result.focus(n - frames), dt = result.time[n] - result.time[n - frames];
    const speed = 1e-3 * Math.hypot(x - x0, y - y0) / dt, angle = Math.asin(result.header.surface_wave_m_s / speed);
    const back = Math.atan2(y0 - y, x0 - x), length = Math.hypot(x - x0, y - y0);
    this.mach_deg = angle * 180 / Math.PI;
    for (const side of [-1, 1]) {
      const along = length * Math.cos(angle), direction = back + side * angle;
      this.context.setLineDash([6 * this.factor, 4 * this.factor]);
      this.line([[x, y], [x + along * Math.cos(direction), y + along * Math.sin(direction)]], "#000b", 1.5);
      this.context.setLineDash([]);
    }
  }
  // Receptors are dots, which are filled for 2 ms after each spike.
  drawReceptors(result, n) {
    const a = result.arrays;
    if (!a["afferents/x"]) return;
    const now = result.time[n];
    let spike = 0;
    for (let k = 0; k < a["afferents/x"].length; ++k) {
      let fires = false;
      for (let s = 0; s < a["afferents/spike_count"][k]; ++s, ++spike) {
        const since = now - a["afferents/spike_time"][spike];
        fires = fires || (since >= 0 && since < 2e-3);
      }
      const at = [1e3 * a["afferents/x"][k], 1e3 * a["afferents/y"][k]], style = RECEPTORS[a["afferents/class"][k]].colour_on_map;
      if (fires) this.dot(at, 6, style); else this.dot(at, 2, style);
    }
  }
  drawProbe() {
    const [x, y] = this.pixels(this.probe), size = 9 * this.factor, context = this.context;
    context.lineWidth = 2 * this.factor;
    for (const [style, shift] of [["#fff", 1], ["#000", 0]]) {
      context.strokeStyle = style;
      context.beginPath();
      context.moveTo(x - size + shift, y + shift); context.lineTo(x + size + shift, y + shift);
      context.moveTo(x + shift, y - size + shift); context.lineTo(x + shift, y + size + shift);
      context.stroke();
    }
  }
  drawAxes() {
    const context = this.context, [width, height] = this.extent, tick = 1.5;
    context.fillStyle = "#222";
    context.font = `${11 * this.factor}px system-ui, sans-serif`;
    context.textAlign = "center";
    for (let x = -40; x <= 40; x += 20) {
      this.line([[x, -0.5 * height], [x, -0.5 * height + tick]], "#222", 1);
      context.fillText(x === 40 ? "x = 40 mm" : String(x).replace("-", "−"), ...this.pixels([x, -0.5 * height + 2 * tick]));
    }
    context.textAlign = "left";
    for (let y = -20; y <= 40; y += 20) {
      this.line([[-0.5 * width, y], [-0.5 * width + tick, y]], "#222", 1);
      context.fillText(y === 40 ? "y = 40 mm" : String(y).replace("-", "−"), ...this.pixels([-0.5 * width + 2 * tick, y - 0.01 * height]));
    }
  }
}
