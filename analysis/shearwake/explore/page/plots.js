"use strict";
// The curves next to the surface.
const pen = {stroke: "#0072b2", width: 1.5, points: {show: false}};

class Plot {
  constructor(box, across, along, name, points = {show: false}) {
    Object.assign(this, {box, name, across});
    box.setAttribute("role", "img");
    const axis = label => ({label, labelSize: 16, size: 44, font: "11px system-ui", labelFont: "11px system-ui", stroke: "#333"});
    this.plot = new uPlot({
      width: Math.max(200, box.clientWidth), height: 150, legend: {show: false}, cursor: {y: false},
      scales: {x: {time: false}}, series: [{}, {...pen, points, label: name}],
      axes: [{...axis(across), size: 30}, axis(along)],
      hooks: {draw: [plot => this.mark(plot)]},
    }, [[], []], box);
    this.at = null;  // a vertical line
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

// One-sided amplitude spectrum with a Hann window, at frequencies up to `most` Hz.
function amplitudeSpectrum(values, interval_s, most) {
  const n = values.length, mean = values.reduce((a, b) => a + b, 0) / n, frequencies = [], amplitudes = [];
  const window = values.map((_, i) => 0.5 - 0.5 * Math.cos(2 * Math.PI * i / n));
  const step = 1 / (4 * n * interval_s);  // padded to four times the length
  for (let f = 0; f <= Math.min(most, 0.5 / interval_s); f += step) {
    let re = 0, im = 0;
    for (let i = 0; i < n; ++i) {
      const value = (values[i] - mean) * window[i], angle = 2 * Math.PI * f * i * interval_s;
      re += value * Math.cos(angle);
      im -= value * Math.sin(angle);
    }
    frequencies.push(f);
    amplitudes.push(4 * Math.hypot(re, im) / n);  // the mean of the window is 1/2
  }
  return [frequencies, amplitudes];
}

class Plots {
  constructor() {
    const box = name => document.getElementById("plot-" + name);
    this.eta = new Plot(box("eta"), "time [ms]", "η", "η");
    this.force = new Plot(box("force"), "time [ms]", "force [mN]", "force");
    this.spectrum = new Plot(box("spectrum"), "frequency [Hz]", "|u| [µm]", "amplitude");
    this.trace = new Plot(box("trace"), "time [ms]", "u [µm]", "u");
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
    this.spectrum.show(...amplitudeSpectrum(trace, result.time[1] - result.time[0], 1500));
  }
  showTime(n) { for (const plot of [this.eta, this.force, this.trace]) plot.pointAt(this.ms[n]); }
  fit() { this.all.forEach(plot => plot.fit()); }
}
