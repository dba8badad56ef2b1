"use strict";
// The curves next to the surface. Their colours are those of the page, which follow the system.
const hue = name => () => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);

class Plot {
  constructor(box, across, along, name, points = {show: false}) {
    Object.assign(this, {box, name, across, along});
    box.setAttribute("role", "img");
    const axis = label => ({label, labelSize: 16, size: 44, font: "11px system-ui", labelFont: "11px system-ui", stroke: hue("ink"),
      grid: {stroke: hue("line"), width: 1}, ticks: {stroke: hue("line"), width: 1}});
    this.plot = new uPlot({
      width: Math.max(200, box.clientWidth), height: 150, legend: {show: false}, cursor: {y: false},
      scales: {x: {time: false}}, series: [{}, {stroke: hue("link"), width: 1.5, points, label: name}],
      axes: [{...axis(across), size: 30}, axis(along)],
      hooks: {draw: [plot => this.mark(plot)]},
    }, [[], []], box);
    this.at = null;  // a vertical line
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.plot.redraw());
  }
  mark(plot) {
    if (this.at === null) return;
    const x = plot.valToPos(this.at, "x", true), {top, height} = plot.bbox;
    plot.ctx.fillStyle = "#d55e00";
    plot.ctx.fillRect(x - 1, top, 2, height);
  }
  show(x, y) {
    this.plot.setData([x, y]);
    const most = y.reduce((best, value, i) => Math.abs(value) > Math.abs(y[best]) ? i : best, 0);
    this.box.setAttribute("aria-label", `${this.name} over ${this.across}: at the end ${digits(y.at(-1))}, largest ${digits(y[most])} at ${digits(x[most])}`);
  }
  pointAt(x) {
    this.at = x;
    this.plot.redraw(false);
  }
  fit() {
    const width = Math.max(200, this.box.clientWidth);
    if (width !== this.plot.width) this.plot.setSize({width, height: 150});
  }
}

// One-sided amplitude spectrum at frequencies up to `most` Hz: the lines of a motion that repeats after the last value, or else, with a
// Hann window, of the motion padded to four times its length.
function amplitudeSpectrum(values, interval_s, most, repeats) {
  const n = values.length, mean = values.reduce((a, b) => a + b, 0) / n, frequencies = [], amplitudes = [];
  const window = values.map((_, i) => repeats ? 1 : 1 - Math.cos(2 * Math.PI * i / n));  // their mean is 1
  const step = 1 / ((repeats ? 1 : 4) * n * interval_s);
  for (let k = 0; k * step <= Math.min(most, 0.5 / interval_s); ++k) {
    let re = 0, im = 0;
    for (let i = 0; i < n; ++i) {
      const value = (values[i] - mean) * window[i], angle = 2 * Math.PI * k * step * i * interval_s;
      re += value * Math.cos(angle);
      im -= value * Math.sin(angle);
    }
    frequencies.push(k * step);
    amplitudes.push(2 * Math.hypot(re, im) / n);
  }
  return [frequencies, amplitudes];
}

class Plots {
  constructor() {
    const box = name => document.getElementById("plot-" + name);
    this.eta = new Plot(box("eta"), "time (ms)", "η", "η");
    this.force = new Plot(box("force"), "time (ms)", "force (mN)", "force");
    this.spectrum = new Plot(box("spectrum"), "frequency (Hz)", "|u| (µm)", "amplitude");
    this.trace = new Plot(box("trace"), "time (ms)", "u (µm)", "u");
  }
  get all() { return [this.eta, this.force, this.spectrum, this.trace]; }
  show(result, probe) {
    this.ms = Array.from(result.time, t => 1e3 * t);
    const eta = result.arrays.eta;
    if (eta) this.eta.show(this.ms, Array.from(eta.subarray(0, result.frames)));
    this.force.show(this.ms, Array.from(result.arrays.force, f => 1e3 * f));
    this.showProbe(result, probe);
  }
  showProbe(result, probe) {
    const trace = result.trace(...probe);
    this.trace.show(this.ms, trace);
    this.spectrum.show(...amplitudeSpectrum(trace, result.time[1] - result.time[0], 1500, isSteady(result.settings)));
  }
  showTime(n) { for (const plot of [this.eta, this.force, this.trace]) plot.pointAt(this.ms[n]); }
  fit() { this.all.forEach(plot => plot.fit()); }
}
