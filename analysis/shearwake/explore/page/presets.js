"use strict";
// The presets of config/document/presets.cpp, as layers that can be edited.
const SOFT = {density_kg_m3: 1000, c_p_m_s: 1500};
const PRESETS = {
  "thesis-tissue": {label: "Tissue of the thesis", base: "rigid",
    layers: [{name: "thesis-tissue", ...SOFT, thickness_mm: 20, c_s_m_s: 5, viscosity_Pa_s: 1}]},
  "forearm": {label: "Forearm", base: "rigid",
    layers: [{name: "forearm", ...SOFT, thickness_mm: 20, c_s_m_s: 2.8035691537752375, viscosity_Pa_s: 5.03}]},
  "three-layer-skin": {label: "Skin of three layers", base: "half-space",
    layers: [{name: "epidermis", ...SOFT, thickness_mm: 0.1, c_s_m_s: 36.469165057620936, viscosity_Pa_s: 0.1},
             {name: "dermis", ...SOFT, thickness_mm: 2, c_s_m_s: 3.6469165057620936, viscosity_Pa_s: 1},
             {name: "fat", ...SOFT, c_s_m_s: 2.23606797749979, viscosity_Pa_s: 1}]},
  "ecoflex": {label: "Ecoflex phantom", base: "rigid",
    layers: [{name: "ecoflex", density_kg_m3: 1070, c_p_m_s: 1000, thickness_mm: 20, c_s_m_s: 5.1, tau_us: 260, exponent: 0.27}]},
};
