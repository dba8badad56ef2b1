"use strict";
// A short tour for a first visit.
const STOPS = [
  ["#stage", "This is the skin from above. The focus moves over it, and the colours are the displacement. Everything is computed by the engine of shearwake run."],
  ["#controls", "Change a setting: the surface follows within a fraction of a second. A change of the tissue takes a little longer."],
  ["#overlay", "Click on the surface, or use the arrow keys, to move the probe. Its motion and its spectrum are shown with the results."],
  ["#results", "η is the share of the energy that is at the focus. Faster than the waves of the skin, the focus leaves a Mach cone, and η falls."],
  ["nav", "Pin settings to compare them, compare all kinds of modulation, save a picture, or send the setting to a sweep. The space bar stops and starts the playback."],
];

class Tour {
  constructor() {
    this.box = document.getElementById("tour");
    document.getElementById("start-tour").addEventListener("click", () => this.show(0));
    document.getElementById("tour-next").addEventListener("click", () => this.show(this.step + 1));
    document.getElementById("tour-end").addEventListener("click", () => this.end());
    document.addEventListener("keydown", event => { if (event.key === "Escape" && !this.box.hidden) this.end(); });
  }
  startOnFirstVisit() {
    try {
      if (localStorage.getItem("shearwake-tour")) return;
    } catch { return; }
    this.show(0);
  }
  show(step) {
    this.target?.classList.remove("toured");
    if (step >= STOPS.length) { this.end(); return; }
    this.step = step;
    const [selector, text] = STOPS[step];
    this.target = document.querySelector(selector);
    this.target.classList.add("toured");
    document.getElementById("tour-text").textContent = text;
    document.getElementById("tour-step").textContent = `${step + 1} of ${STOPS.length}`;
    this.box.hidden = false;
    // The tour has a row of its own: below the header, or on a phone at the end of the window.
    (getComputedStyle(this.box).position === "fixed" ? this.target : document.body).scrollIntoView();
    document.getElementById("tour-next").focus();
  }
  end() {
    this.target?.classList.remove("toured");
    this.box.hidden = true;
    try { localStorage.setItem("shearwake-tour", "seen"); } catch { /* a browser without storage shows the tour again */ }
  }
}
