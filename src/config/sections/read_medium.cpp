// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "config/document/presets.hpp"
#include "config/sections/read_case.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/medium/material_field.hpp"

#include <fmt/format.h>

namespace shearwake::config {
namespace {

ShearLoss kelvin_voigt(double viscosity_Pa_s) {
    if (viscosity_Pa_s == 0.0) return Lossless{}; // the same medium and therefore the same case
    return KelvinVoigt{viscosity_Pa_s};
}

ShearLoss read_law(Reader reader) {
    if (!reader.has("law")) reader.missing("law");
    const std::string law = reader.find_choice("law", alternative_names<ShearLoss>()).value_or("");
    ShearLoss loss = read_alternative<ShearLoss>(reader, law).value_or(Lossless{});
    if (const auto* viscous = std::get_if<KelvinVoigt>(&loss))
        loss = kelvin_voigt(viscous->viscosity_Pa_s);
    if (!law.empty() || !reader.has("law"))
        reader.finish(); // otherwise its keys belong to another law
    return loss;
}

ShearLoss read_loss(Reader& reader) {
    const auto viscosity_Pa_s =
        reader.find_number("viscosity_Pa_s", range_of<Layer>("viscosity_Pa_s"));
    const NodePtr loss = reader.node("loss");
    if (!loss) return viscosity_Pa_s ? kelvin_voigt(*viscosity_Pa_s) : Lossless{};
    if (reader.has("viscosity_Pa_s"))
        reader.conflict("loss",
                        "and viscosity_Pa_s are both given; remove one of them from the job");
    if (std::holds_alternative<TableNode>(loss->value)) return read_law(reader.table("loss"));
    const auto* word = std::get_if<std::string>(&loss->value);
    if (!word || *word != "none")
        reader.error("loss", "must be \"none\" or a table { law = \"fractional\", ... }");
    return Lossless{};
}

void read_thickness(Reader& reader, bool endless, Layer& layer) {
    if (!endless) {
        layer.thickness_m = reader.number("thickness_mm", range_of<Layer>("thickness_mm"));
    } else if (reader.has("thickness_mm")) {
        reader.error("thickness_mm",
                     "does not apply: with medium.base = \"half-space\", the last layer extends to "
                     "infinity; remove the key, or set medium.base = \"rigid\"");
    }
}

Layer read_layer(Reader reader, std::size_t number, bool endless) {
    const std::size_t before = reader.diagnostics().errors();
    if (reader.has("preset")) reader.find_choice("preset", layer_preset_names());
    Layer layer;
    layer.name = fmt::format("layer {}", number);
    read_thickness(reader, endless, layer);
    read_fields(reader, layer);
    layer.loss = read_loss(reader);
    reader.finish();
    if (reader.diagnostics().errors() == before &&
        !has_positive_bulk_modulus({layer.c_p_m_s, layer.c_s_m_s}))
        reader.error("c_p_m_s",
                     fmt::format("must be above {:.6g}, 1.1547 times c_s_m_s = {:.6g}, for a "
                                 "positive bulk modulus, but is {:.6g}",
                                 layer.c_s_m_s * least_speed_ratio, layer.c_s_m_s, layer.c_p_m_s));
    return layer;
}

/// The table of the layer with its preset applied. The thickness is omitted for a half-space.
NodePtr prepared(const NodePtr& layer, bool endless) {
    if (!std::holds_alternative<TableNode>(layer->value)) return layer;
    const bool given = std::get<TableNode>(layer->value).find("thickness_mm") != nullptr;
    const NodePtr filled = with_layer_preset(layer);
    return endless && !given ? without(filled, "thickness_mm") : filled;
}

void read_layers(Reader& reader, Medium& medium) {
    const std::vector<Reader> layers = reader.tables("layer");
    if (reader.has("layer") && layers.empty())
        reader.error("layer", "must contain at least one layer");
    const NodePtr list = reader.node("layer");
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const bool endless = medium.base == Base::half_space && i + 1 == layers.size();
        const NodePtr table = prepared(std::get<ListNode>(list->value)[i], endless);
        medium.layers.push_back(
            read_layer(Reader(table, layers[i].path(), reader.diagnostics()), i + 1, endless));
    }
}

std::shared_ptr<const MaterialMap> read_map(Reader& reader, const MapLoader& load_map) {
    return load_named(reader, "map", load_map).value_or(nullptr);
}

/// If the map gives one of the speeds, the other one may be that of the layer.
void check_bulk_modulus_of_map(const Reader& reader, const Medium& medium) {
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const Speeds speeds = softest_against_pressure(medium, i);
        if (!has_positive_bulk_modulus(speeds))
            reader.error(
                "map", fmt::format(
                           "gives c_p = {:.6g} and c_s = {:.6g} m/s somewhere in layer \"{}\": c_p "
                           "must be above {:.6g}, 1.1547 times c_s, for a positive bulk modulus",
                           speeds.c_p_m_s, speeds.c_s_m_s, excerpt(medium.layers[i].name),
                           speeds.c_s_m_s * least_speed_ratio));
    }
}

/// `around` has no layers if they have errors: then nothing is compared with them.
std::vector<Body> read_bodies(Reader& reader, const Medium& around) {
    const std::vector<Reader> bodies = reader.tables("body");
    const NodePtr list = reader.node("body");
    std::vector<Body> read;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const NodePtr table = with_body_preset(std::get<ListNode>(list->value)[i]);
        read.push_back(
            read_body(Reader(table, bodies[i].path(), reader.diagnostics()), i + 1, around));
    }
    return read;
}

} // namespace

Medium read_medium(Reader& reader, const MapLoader& load_map) {
    if (reader.empty()) return {};
    Medium medium;
    read_fields(reader, medium);
    const std::size_t before_preset = reader.diagnostics().errors();
    reader.find_choice("preset", preset_names());
    const bool preset_is_known = reader.diagnostics().errors() == before_preset;
    if (preset_is_known && reader.has("preset") && reader.has("layer"))
        reader.error("preset", "defines all layers, but medium.layer is also given; use the preset "
                               "in a layer, or remove the layers");
    if (preset_is_known && !reader.has("layer")) reader.missing("layer");
    const std::size_t before = reader.diagnostics().errors();
    read_layers(reader, medium);
    medium.map = read_map(reader, load_map);
    if (reader.diagnostics().errors() == before && medium.map)
        check_bulk_modulus_of_map(reader, medium);
    const bool is_sound = reader.diagnostics().errors() == before;
    medium.bodies = read_bodies(reader, is_sound ? medium : Medium{});
    reader.finish();
    return medium;
}

} // namespace shearwake::config
