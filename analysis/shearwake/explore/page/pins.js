"use strict";
// Settings that are kept next to the current one, each with its surface at the same time and on the same scale.
const MOST_PINS = 4;
const COMPARED = [["eta_at_1", "η at the end"], ["peak_um", "peak"], ["focal_rms_um", "RMS at the focus"]];

const digits = value => value === null || value === undefined ? "–" : Number(value).toPrecision(4);
const unitOf = column => !column.units || column.units === "1" ? "" : " " + column.units.replace("um", "µm");

class Pins {
  constructor(box, restore) { Object.assign(this, {box, restore, all: []}); }
  add(settings, result) {
    if (this.all.length === MOST_PINS) return `${MOST_PINS} settings are pinned; remove one of them first`;
    const title = this.title(settings), canvas = element("canvas");
    const remove = element("button", {type: "button", textContent: "Remove", ariaLabel: `Remove ${title}`});
    const use = element("button", {type: "button", textContent: "Use", ariaLabel: `Use ${title}`});
    const card = element("article", {className: "pinned", ariaLabel: `Pinned: ${title}`}, canvas, element("p", {textContent: title}),
      element("dl", {}, ...COMPARED.flatMap(([name, label]) => [element("dt", {textContent: label}),
        element("dd", {textContent: digits(result.column(name).value) + unitOf(result.column(name))})])), use, " ", remove);
    const pin = {settings: structuredClone(settings), result, card};
    this.box.append(card);
    pin.surface = new Surface(canvas);
    remove.addEventListener("click", () => {
      pin.surface.gl?.getExtension("WEBGL_lose_context")?.loseContext();
      this.all = this.all.filter(other => other !== pin);
      card.remove();
    });
    use.addEventListener("click", () => this.restore(structuredClone(pin.settings)));
    this.all.push(pin);
    return `pinned: ${title}`;
  }
  title(s) {
    if (CONFIGURATION.stored) return CONFIGURATION.stored[s.stored].title;
    const parts = [s.layers ? "edited layers" : PRESETS[s.preset].label, s.kind];
    if (MOVES(s)) parts.push(`${s.speed} m/s`, s.path);
    if (s.kind !== "STM") parts.push(`${s.am} Hz`);
    parts.push(s.focus === "array" ? "array" : `${s.fwhm} mm`);
    return parts.join(", ");
  }
  get peak() { return Math.max(0, ...this.all.map(pin => pin.result.peak)); }
  draw(time_s, scale_m, relief) {
    for (const {surface, result} of this.all) {
      const n = Math.min(result.frames - 1, Math.max(0, Math.round(time_s / result.time[0]) - 1));
      surface.fit(400);
      surface.draw(result, n, scale_m, relief);
    }
  }
}
