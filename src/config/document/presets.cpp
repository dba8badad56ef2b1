// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/presets.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>

namespace shearwake::config {

namespace {

struct Preset {
    std::string_view name;
    std::string_view source; // of measured values, and which values were chosen for this program
    std::string_view toml;   // the content of [medium]
};

constexpr std::array presets = {
    Preset{"palm",
           "Palm above its bones. Chosen for this program: c_s of the thesis, 5 m/s, which is not "
           "measured on a palm; viscosity 2 Pa s, between those of the presets thesis-tissue and "
           "forearm; 10 mm of soft tissue on rigid bones, since the thickness varies between "
           "places and people (Spartacus 2021, doi 10.1371/journal.pone.0261008); rho and c_p of "
           "soft tissue.",
           R"(
base = "rigid"
[[layer]]
name = "palm"
thickness_mm = 10.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 2.0
)"},
    Preset{"thesis-tissue",
           "The thesis on focused-ultrasound shear waves, figures 2.1 and 2.2: c_s 5 "
           "m/s, rho 1000 kg/m3, c_p 1500 m/s. Chosen for this program: viscosity, "
           "thickness and the rigid base.",
           R"(
base = "rigid"
[[layer]]
name = "thesis-tissue"
thickness_mm = 20.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 1.0
)"},
    Preset{"ecoflex",
           "Ecoflex phantom, doi 10.5281/zenodo.10371481: rho 1070 kg/m3, shear speed "
           "5.10 m/s (mu0 27.8 kPa), mu(omega) = mu0 (1 + (i omega tau)^n) with tau 260 "
           "us, n 0.27. Chosen for this program: c_p (that of silicone rubbers is near "
           "1000 m/s), thickness and the rigid base.",
           R"(
base = "rigid"
[[layer]]
name = "ecoflex"
thickness_mm = 20.0
density_kg_m3 = 1070.0
c_p_m_s = 1000.0
c_s_m_s = 5.10
loss = { law = "fractional", tau_us = 260.0, exponent = 0.27 }
)"},
    Preset{"forearm",
           "Forearm, Zhang 2011 (PMID 20888282): mu 7.86 kPa, viscosity 5.03 Pa s. "
           "Chosen for this program: rho and c_p of soft tissue, with which c_s = "
           "sqrt(7860 / 1000); thickness and the rigid base.",
           R"(
base = "rigid"
[[layer]]
name = "forearm"
thickness_mm = 20.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 2.8035691537752375
viscosity_Pa_s = 5.03
)"},
    Preset{"fingertip",
           "Pulp of a fingertip above the distal phalanx. Chosen for this program: c_s of the "
           "dermis of the preset three-layer-skin (Feng 2022: 40 kPa, so 3.65 m/s); viscosity 2 "
           "Pa s as in the preset palm; 4 mm of soft tissue on rigid bone, of which skin is about "
           "3 mm (Wu 2006, thesis, MIT); rho and c_p of soft tissue. The pulp is flat and has no "
           "edges.",
           R"(
base = "rigid"
[[layer]]
name = "fingertip"
thickness_mm = 4.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 3.6469165057620936
viscosity_Pa_s = 2.0
)"},
    Preset{"three-layer-skin",
           "Skin of three layers, Feng 2022: E = 4 MPa, 40 kPa, 15 kPa, so mu = 1.33 "
           "MPa, 13.3 kPa, 5 kPa; epidermis 0.1 mm, dermis 2 mm, then fat. Chosen for "
           "this program: the fat is a half-space, rho 1000 kg/m3 and c_p 1500 m/s "
           "throughout, so c_s = sqrt(mu / rho), and the viscosities, for which that "
           "source has no numbers: 1 Pa s, but 0.1 Pa s in the epidermis.",
           R"(
base = "half-space"
[[layer]]
name = "epidermis"
thickness_mm = 0.1
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 36.469165057620936
viscosity_Pa_s = 0.1
[[layer]]
name = "dermis"
thickness_mm = 2.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 3.6469165057620936
viscosity_Pa_s = 1.0
[[layer]]
name = "fat"
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 2.23606797749979
viscosity_Pa_s = 1.0
)"},
};

// Presets for [[medium.body]].
constexpr std::array body_presets = {
    Preset{"cortical-bone",
           "Cortical bone of the human tibia, Hoffmeister 2000 (\"Anisotropy of Young's "
           "modulus of human tibial cortical bone\", Med Biol Eng Comput 38): c11, c22, "
           "c33 = 19.5, 20.1, 30.9 GPa and c44, c55, c66 = 5.72, 5.17, 4.05 GPa. Chosen "
           "for this program: the isotropic mean, 23.5 and 4.98 GPa; rho 1900 kg/m3 out "
           "of 1800 to 2200 (doi 10.1016/j.mechmat.2011.08.007, table 3, which has 3200 "
           "to 4000 m/s for c_p); c_p = sqrt(23.5e9 / rho), c_s = sqrt(4.98e9 / rho); no "
           "loss.",
           R"(
density_kg_m3 = 1900.0
c_p_m_s = 3516.876
c_s_m_s = 1618.966
viscosity_Pa_s = 0.0
)"},
};

const NodePtr& layers_of(const NodePtr& medium) {
    return std::get<TableNode>(medium->value).find("layer")->value;
}

/// The known name that is most similar to an unknown one, or else the last one: errors elsewhere in
/// the table are then found in the same pass, and no key is reported as missing that the preset
/// would supply.
std::string known_name(const std::string& name, const std::vector<std::string>& known) {
    return nearest(name.substr(0, 60), known).value_or(known.back());
}

bool is_single(const Preset& preset) {
    return preset.toml.find("[[layer]]") == preset.toml.rfind("[[layer]]");
}

void add_if_absent(TableNode& table, const Entry& entry) {
    if (!table.find(entry.key)) table.entries.push_back(entry);
}

const std::string* preset_named_in(const NodePtr& node) {
    const auto* table = node ? std::get_if<TableNode>(&node->value) : nullptr;
    const Entry* entry = table ? table->find("preset") : nullptr;
    return entry ? std::get_if<std::string>(&entry->value->value) : nullptr;
}

/// The table of a preset at `place`. The text is parsed once, since every case of a sweep asks for
/// it.
NodePtr table_of(const Preset& preset, const Place& place) {
    thread_local std::map<std::string_view, NodePtr> parsed; // by text
    NodePtr& table = parsed[preset.toml];
    DiagnosticList none;
    if (!table) table = parse_toml(preset.toml, "preset", none);
    return moved_to(table, place);
}

} // namespace

std::string layer_and_body_presets() {
    std::string text =
        "# Media: [medium] preset = \"NAME\"; one of a single layer also as [[medium.layer]] "
        "preset = \"NAME\".\n";
    const auto add = [&](const Preset& preset) {
        text += fmt::format("\n# {}\n# {}{}", preset.name, preset.source, preset.toml);
    };
    for (const Preset& preset : presets)
        add(preset);
    text += "\n# Bodies: [[medium.body]] preset = \"NAME\".\n";
    for (const Preset& preset : body_presets)
        add(preset);
    return text;
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : presets)
        names.emplace_back(preset.name);
    return names;
}

std::vector<std::string> layer_preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : presets)
        if (is_single(preset)) names.emplace_back(preset.name);
    return names;
}

NodePtr medium_preset(std::string_view name, const Place& place) {
    for (const Preset& preset : presets)
        if (preset.name == name) return table_of(preset, place);
    return nullptr;
}

NodePtr with_layer_preset(const NodePtr& layer) {
    const std::string* name = preset_named_in(layer);
    if (!name) return layer;
    const std::vector<std::string> known = layer_preset_names();
    const std::string& used =
        std::ranges::find(known, *name) != known.end() ? *name : known_name(*name, known);
    const NodePtr medium = medium_preset(used, find(layer, {{"preset"}})->at);
    if (!medium || std::get<ListNode>(layers_of(medium)->value).size() != 1) return layer;
    TableNode filled = std::get<TableNode>(layer->value);
    // The job and the preset specify the same quantity by different keys: the key of the job
    // replaces that of the preset.
    const bool has_loss = filled.find("loss") || filled.find("viscosity_Pa_s");
    const NodePtr only = std::get<ListNode>(layers_of(medium)->value).front();
    for (const Entry& entry : std::get<TableNode>(only->value).entries)
        if (!has_loss || (entry.key != "loss" && entry.key != "viscosity_Pa_s"))
            add_if_absent(filled, entry);
    return make_node(std::move(filled), layer->at);
}

std::vector<std::string> body_preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : body_presets)
        names.emplace_back(preset.name);
    return names;
}

NodePtr with_body_preset(const NodePtr& body) {
    const std::string* name = preset_named_in(body);
    if (!name) return body;
    for (const Preset& preset : body_presets) {
        if (preset.name != *name) continue;
        const NodePtr given = table_of(preset, find(body, {{"preset"}})->at);
        TableNode filled = std::get<TableNode>(body->value);
        for (const Entry& entry : std::get<TableNode>(given->value).entries)
            add_if_absent(filled, entry);
        return make_node(std::move(filled), body->at);
    }
    return body;
}

NodePtr with_medium_preset(const NodePtr& root) {
    const NodePtr medium = find(root, {{"medium"}});
    const std::string* name = preset_named_in(medium);
    if (!name || std::get<TableNode>(medium->value).find("layer")) return root;
    const Place& at = find(medium, {{"preset"}})->at;
    NodePtr preset = medium_preset(*name, at);
    const bool is_known = preset != nullptr;
    if (!is_known) preset = medium_preset(known_name(*name, preset_names()), at);
    TableNode filled = std::get<TableNode>((is_known ? without(medium, "preset") : medium)->value);
    for (const Entry& entry : std::get<TableNode>(preset->value).entries)
        add_if_absent(filled, entry);
    std::string problem;
    return with(root, {{"medium"}}, make_node(std::move(filled), medium->at), medium->at, problem);
}

std::string_view instead_of_zero(std::string_view key, std::string_view kind) {
    if (key == "am_frequency_Hz" && kind != "AM-STM")
        return "for a constant amplitude, set am_depth = 0";
    if (key == "am_frequency_Hz")
        return "for a case without modulation, set am_depth = 0, or use kind = \"STM\" instead of "
               "\"AM-STM\"; a sweep is compared with it by reference = { kind = \"STM\" } in "
               "[table]";
    if (key == "sm_frequency_Hz") return "for a constant speed, use kind = \"STM\"";
    if (key == "lm_frequency_Hz")
        return "for a focus that does not move, use kind = \"AM\" with am_depth = 0";
    return {};
}

} // namespace shearwake::config
