"use strict";
// Where results come from: the engine behind the WebSocket.

// A result: the header of serve (docs/reference/serve.md) and its arrays by name.
class Result {
  constructor(header, bytes) {
    this.header = header;
    this.arrays = {};
    let offset = 0;
    for (const array of header.arrays) {
      const count = array.shape.reduce((a, b) => a * b, 1), kind = array.type === "float32" ? Float32Array : Float64Array;
      const size = count * kind.BYTES_PER_ELEMENT;  // a slice is aligned
      this.arrays[array.name] = new kind(bytes.slice(offset, offset + size));
      offset += size;
    }
    [this.frames, this.nx, this.ny] = header.arrays[0].shape;
    this.u = this.arrays.u_z;
    this.time = this.arrays.time;
    this.spacing = 1e3 * header.spacing_m;
    [this.peak, this.wake] = this.largest();
  }
  // The largest displacement, and the largest one farther than two focal diameters from the focus, but at least a fifth of the former.
  largest() {
    let peak = 0, away = 0;
    const shifts = this.header.foci_m.length ? this.header.foci_m : [[0, 0]], far2 = (2e3 * this.header.fwhm_m) ** 2;
    for (let n = 0; n < this.frames; ++n) {
      const frame = this.frame(n), foci = shifts.map(s => [this.focus(n)[0] + 1e3 * s[0], this.focus(n)[1] + 1e3 * s[1]]);
      for (let k = 0; k < frame.length; ++k) {
        const value = Math.abs(frame[k]);
        if (value > peak) peak = value;
        if (value <= away) continue;
        const x = (Math.floor(k / this.ny) - this.nx / 2) * this.spacing, y = (k % this.ny - this.ny / 2) * this.spacing;
        if (foci.every(([a, b]) => (x - a) ** 2 + (y - b) ** 2 > far2)) away = value;
      }
    }
    return [peak, Math.max(away, 0.2 * peak)];
  }
  column(name) { return this.header.columns[name] ?? {value: null, note: ""}; }
  frame(n) { return this.u.subarray(n * this.nx * this.ny, (n + 1) * this.nx * this.ny); }
  // The level of sensation in dB on the grid of the frames, NaN where there is none.
  get level() {
    if (this.levels) return this.levels;
    const {"sensation/x": x = [], "sensation/y": y = [], "sensation/level": found} = this.arrays;
    this.levels = new Float32Array(this.nx * this.ny).fill(NaN);
    for (let i = 0; i < x.length; ++i)
      for (let j = 0; j < y.length; ++j) {
        const [row, column] = this.index(1e3 * x[i], 1e3 * y[j]);
        this.levels[row * this.ny + column] = found[i * y.length + j];
      }
    return this.levels;
  }
  // What the map of this style shows; NaN is unknown.
  shown(n, style) { return style === "level" ? this.level : this.frame(n); }
  // Whether a value in view is unknown.
  hasUnknown(n, style) {
    return this.shown(n, style).some((value, k) => Number.isNaN(value) && Math.abs(Math.floor(k / this.ny) - this.nx / 2) * this.spacing <= 0.5 * WIDTH_mm
      && Math.abs(k % this.ny - this.ny / 2) * this.spacing <= 0.5 * HEIGHT_mm);
  }
  focus(n) { return [1e3 * this.arrays.focus_x[n], 1e3 * this.arrays.focus_y[n]]; }
  // Index of the grid point that is nearest to a place in mm.
  index(x, y) {
    const i = Math.min(this.nx - 1, Math.max(0, Math.round(x / this.spacing + this.nx / 2)));
    const j = Math.min(this.ny - 1, Math.max(0, Math.round(y / this.spacing + this.ny / 2)));
    return [i, j];
  }
  trace(x, y) {
    const [i, j] = this.index(x, y), values = new Array(this.frames);
    for (let n = 0; n < this.frames; ++n) values[n] = 1e6 * this.u[(n * this.nx + i) * this.ny + j];
    return values;
  }
}

class EngineSource {
  constructor(receive) {
    this.receive = receive;  // called with {type, ...} and, for results, a Result
    this.number = 0;
    this.pause_ms = 500;
    this.connect();
  }
  connect() {
    this.socket = new WebSocket(`ws://${location.host}/socket`);
    this.socket.binaryType = "arraybuffer";
    this.socket.addEventListener("open", () => { this.pause_ms = 500; this.receive({type: "open"}); });
    this.socket.addEventListener("close", () => {
      this.receive({type: "closed"});
      setTimeout(() => this.connect(), this.pause_ms);
      this.pause_ms = Math.min(10000, 2 * this.pause_ms);
    });
    this.socket.addEventListener("message", event => {
      if (typeof event.data !== "string") {
        this.receive(this.header, new Result(this.header, event.data));
        return;
      }
      const message = JSON.parse(event.data);
      if (message.type === "result") this.header = message; else this.receive(message);
    });
  }
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return -1;
    this.socket.send(JSON.stringify({...message, id: ++this.number}));
    return this.number;
  }
  compute(settings) { return this.send({type: "compute", job: jobText(settings)}); }
  sweep(job, key, values, more) { return this.send({type: "sweep", job, key, values, more}); }
  stopSweep() { this.socket.send(JSON.stringify({type: "stop_sweep"})); }
}
