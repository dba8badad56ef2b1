"use strict";
// The form with the settings.
function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

let controlNumber = 0;

function slider(spec, value, change) {
  const id = `control-${++controlNumber}`, digits = Math.max(0, Math.ceil(-Math.log10(spec.step) - 1e-9));
  const shown = v => Number(v).toFixed(Math.abs(v / spec.step - Math.round(v / spec.step)) < 1e-6 ? digits : digits + 1);  // between two steps
  const text = v => `${shown(v)}${spec.unit ? " " + spec.unit : ""}`;
  const input = element("input", {type: "range", id, min: spec.min, max: spec.max, step: spec.step, value});
  const output = element("output", {value: text(value)});
  output.setAttribute("for", id);
  input.setAttribute("aria-valuetext", text(value));
  input.addEventListener("input", () => {
    output.value = text(input.value);
    input.setAttribute("aria-valuetext", text(input.value));
    change(Number(input.value));
  });
  return element("div", {className: "control"}, element("label", {htmlFor: id, textContent: spec.label}), output, input);
}

function choice(label, options, value, change) {
  const id = `control-${++controlNumber}`, select = element("select", {id});
  for (const [name, text] of Object.entries(options)) select.add(new Option(text, name, false, name === value));
  select.addEventListener("change", () => change(select.value));
  return element("div", {className: "control"}, element("label", {htmlFor: id, textContent: label}), select);
}

class Controls {
  // `changed` is called after every change, `draw` to draw a path by hand.
  constructor(form, settings, changed, draw) {
    Object.assign(this, {form, settings, changed, draw});
    form.addEventListener("submit", event => event.preventDefault());
    this.build();
  }
  set(key, value, rebuild) {
    this.settings[key] = value;
    if (rebuild) this.build();
    this.changed();
  }
  group(title, ...parts) {
    return element("fieldset", {}, element("legend", {textContent: title}), ...parts.filter(part => part));
  }
  sliders(...names) {
    return names.filter(name => SLIDERS[name].shows(this.settings)).map(name => {
      const control = slider(SLIDERS[name], this.settings[name], value => this.set(name, value));
      control.dataset.setting = name;
      return control;
    });
  }
  build() {
    const s = this.settings, focused = document.activeElement?.closest(".control")?.querySelector("label")?.textContent;
    this.form.replaceChildren(
      this.group("Tissue", ...this.tissue()),
      this.group("Modulation", choice("Kind", MODULATIONS, s.kind, value => this.set("kind", value, true)),
        ...this.sliders("am", "depth", "dv", "lm")),
      this.group("Motion", MOVES(s) && choice("Path", PATHS, s.path, value => this.choosePath(value)), ...this.sliders("speed", "radius", "length"),
        MOVES(s) && s.path === "drawn" && element("button", {type: "button", textContent: "Draw again", onclick: () => this.draw()}),
        choice("State", {steady: "steady state", rest: "started from rest"}, s.steady ? "steady" : "rest", value => this.set("steady", value === "steady", true)),
        ...this.sliders("duration")),
      this.group("Focus", choice("Shape", FOCI, s.focus, value => this.set("focus", value, true)),
        ...this.sliders("fwhm", "peak", "distance", "pressure")),
      this.group("Receptors and grid", this.check(`${VIBRATION_NAMES} receptors`, "receptors"),
        slider({label: "Grid spacing", unit: "mm", min: 0.5, max: 2, step: 0.1}, s.spacing, value => this.set("spacing", value))));
    for (const control of this.form.querySelectorAll(".control"))
      if (focused && control.querySelector("label").textContent === focused) control.querySelector("input, select").focus();
  }
  check(label, key) {
    const input = element("input", {type: "checkbox", checked: this.settings[key]});
    input.addEventListener("change", () => this.set(key, input.checked));
    return element("div", {className: "control"}, element("label", {}, input, " " + label));
  }
  choosePath(value) {
    this.settings.path = value;
    this.build();
    if (value === "drawn" && !this.settings.drawn) this.draw(); else this.changed();
  }
  tissue() {
    const s = this.settings, presets = Object.fromEntries(Object.entries(PRESETS).map(([name, preset]) => [name, preset.label]));
    const assumed = !s.layers && ASSUMED[s.preset] && element("p", {className: "hint", textContent: assumption(ASSUMED[s.preset])});
    const parts = [choice("Preset", presets, s.preset, value => {
      s.layers = s.layers && structuredClone(PRESETS[value].layers);
      s.base = PRESETS[value].base;
      this.set("preset", value, true);
    })];
    const edit = element("button", {type: "button", textContent: s.layers ? "Use the preset" : "Edit the layers"});
    edit.addEventListener("click", () => {
      s.base = PRESETS[s.preset].base;
      this.set("layers", s.layers ? null : structuredClone(PRESETS[s.preset].layers), true);
    });
    if (s.layers) parts.push(...s.layers.map((layer, i) => this.layer(layer, i)), this.layerButtons(),
      choice("Below the layers", {"rigid": "rigid base", "half-space": "the last layer has no end"}, s.base, value => this.set("base", value, true)));
    return [...parts, assumed, edit];
  }
  layer(layer, i) {
    const s = this.settings, endless = i === s.layers.length - 1 && s.base === "half-space";
    const names = Object.keys(LAYER_SLIDERS).filter(key => !(endless && key === "thickness_mm") && !(key === "viscosity_Pa_s" && layer.tau_us !== undefined));
    return element("div", {className: "layer"}, element("p", {textContent: `Layer ${i + 1}: ${layer.name}`}), ...names.map(key => {
      const spec = {...LAYER_SLIDERS[key], label: `${LAYER_SLIDERS[key].label}, layer ${i + 1}`};
      const control = slider(spec, layer[key] ?? 20, value => { layer[key] = value; this.changed(); });
      control.dataset.setting = `layer${i + 1}.${key}`;
      return control;
    }));
  }
  layerButtons() {
    const layers = this.settings.layers;
    const add = element("button", {type: "button", textContent: "Add a layer", disabled: layers.length >= 4});
    add.addEventListener("click", () => {
      layers.push({...structuredClone(layers.at(-1)), name: `layer-${layers.length + 1}`, thickness_mm: 10});
      layers.at(-2).thickness_mm ??= 5;
      this.set("layers", layers, true);
    });
    const remove = element("button", {type: "button", textContent: "Remove the last layer", disabled: layers.length < 2});
    remove.addEventListener("click", () => { layers.pop(); layers.at(-1).thickness_mm ??= 20; this.set("layers", layers, true); });
    return element("div", {className: "bar"}, add, remove);
  }
}
