#include "base/error.hpp"
#include "config/presets.hpp"
#include "config/read_case.hpp"
#include "model/bulk_modulus.hpp"

#include <array>
#include <fmt/format.h>

namespace shearwake {
namespace {

ShearLoss kelvin_voigt(double viscosity_Pa_s) {
    if (viscosity_Pa_s == 0.0) return Lossless{}; // the same medium, so the same case
    return KelvinVoigt{viscosity_Pa_s};
}

ShearLoss read_law(Reader reader) {
    static const std::array<std::string, 4> laws = {"none", "kelvin-voigt", "fractional",
                                                    "standard-linear"};
    if (!reader.has("law")) reader.missing("law");
    const std::string law = reader.find_choice("law", laws).value_or("");
    ShearLoss loss = Lossless{};
    if (law == "kelvin-voigt")
        loss = kelvin_voigt(reader.number("viscosity_Pa_s", Range::at_least(0.0)));
    if (law == "fractional")
        loss = FractionalKelvinVoigt{.tau_s = reader.number("tau_us", Range::above(0.0)),
                                     .exponent = reader.number("exponent", Range::inside(0, 1))};
    if (law == "standard-linear")
        loss = StandardLinearSolid{.tau_s = reader.number("tau_us", Range::above(0.0)),
                                   .strength = reader.number("strength", Range::above(0.0))};
    if (!law.empty() || !reader.has("law")) reader.finish(); // else its keys are another law's
    return loss;
}

ShearLoss read_loss(Reader& reader) {
    const auto viscosity_Pa_s = reader.find_number("viscosity_Pa_s", Range::at_least(0.0));
    const NodePtr loss = reader.node("loss");
    if (!loss) return viscosity_Pa_s ? kelvin_voigt(*viscosity_Pa_s) : Lossless{};
    if (reader.has("viscosity_Pa_s"))
        reader.error("loss", "and viscosity_Pa_s are both given; one of them says it all");
    if (std::holds_alternative<TableNode>(loss->value)) return read_law(reader.table("loss"));
    const auto* word = std::get_if<std::string>(&loss->value);
    if (!word || *word != "none")
        reader.error("loss", "must be \"none\" or a table { law = \"fractional\", ... }");
    return Lossless{};
}

void read_thickness(Reader& reader, bool endless, Layer& layer) {
    if (!endless) {
        layer.thickness_m = reader.number("thickness_mm", Range::above(0.0));
    } else if (reader.has("thickness_mm")) {
        reader.error("thickness_mm",
                     "has no meaning: the last layer over a half-space goes on for ever; leave "
                     "it out, or give medium.base = \"rigid\"");
    }
}

Layer read_layer(Reader reader, std::size_t number, bool endless) {
    const std::size_t before = reader.findings().errors();
    if (reader.has("preset")) reader.find_choice("preset", layer_preset_names());
    Layer layer;
    layer.name = reader.find_word("name").value_or(fmt::format("layer {}", number));
    read_thickness(reader, endless, layer);
    layer.density_kg_m3 = reader.number("density_kg_m3", Range::above(0.0));
    layer.c_p_m_s = reader.number("c_p_m_s", Range::above(0.0));
    layer.c_s_m_s = reader.number("c_s_m_s", Range::above(0.0));
    layer.loss = read_loss(reader);
    reader.finish();
    if (reader.findings().errors() == before &&
        !has_positive_bulk_modulus({layer.c_p_m_s, layer.c_s_m_s}))
        reader.error("c_p_m_s",
                     fmt::format("must be above {:.6g}, 1.1547 times c_s_m_s = {:.6g} "
                                 "(a positive bulk modulus), and is {:.6g}",
                                 layer.c_s_m_s * least_speed_ratio, layer.c_s_m_s, layer.c_p_m_s));
    return layer;
}

/// The layer's table with its preset filled in. A half-space has no thickness to fill in.
NodePtr prepared(const NodePtr& layer, bool endless) {
    if (!std::holds_alternative<TableNode>(layer->value)) return layer;
    const bool given = std::get<TableNode>(layer->value).find("thickness_mm") != nullptr;
    const NodePtr filled = with_layer_preset(layer);
    return endless && !given ? without(filled, "thickness_mm") : filled;
}

void read_layers(Reader& reader, Medium& medium) {
    const std::vector<Reader> layers = reader.tables("layer");
    if (reader.has("layer") && layers.empty()) reader.error("layer", "must hold a layer");
    const NodePtr list = reader.node("layer");
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const bool endless = medium.base == Base::half_space && i + 1 == layers.size();
        const NodePtr table = prepared(std::get<ListNode>(list->value)[i], endless);
        medium.layers.push_back(
            read_layer(Reader(table, layers[i].path(), reader.findings()), i + 1, endless));
    }
}

std::shared_ptr<const MaterialMap> read_map(Reader& reader, const MapLoader& load_map) {
    const auto file = reader.find_word("map");
    if (!file) return nullptr;
    if (!load_map) {
        reader.error("map", "names a file, and no files are read here");
        return nullptr;
    }
    try {
        return load_map(*file);
    } catch (const UsageError& problem) {
        reader.error("map", fmt::format("cannot be used: {}", problem.what()));
        return nullptr;
    }
}

/// Where the map gives one of the speeds, the other one may be the layer's.
void check_bulk_modulus_of_map(const Reader& reader, const Medium& medium) {
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const Speeds speeds = softest_against_pressure(medium, i);
        if (!has_positive_bulk_modulus(speeds))
            reader.error("map",
                         fmt::format("makes c_p = {:.6g} and c_s = {:.6g} m/s somewhere in layer "
                                     "\"{}\": c_p must be above {:.6g}, 1.1547 times c_s (a "
                                     "positive bulk modulus)",
                                     speeds.c_p_m_s, speeds.c_s_m_s, excerpt(medium.layers[i].name),
                                     speeds.c_s_m_s * least_speed_ratio));
    }
}

/// `around` is without layers when they have mistakes: nothing is compared with them then.
std::vector<Body> read_bodies(Reader& reader, const Medium& around) {
    const std::vector<Reader> bodies = reader.tables("body");
    const NodePtr list = reader.node("body");
    std::vector<Body> read;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const NodePtr table = with_body_preset(std::get<ListNode>(list->value)[i]);
        read.push_back(
            read_body(Reader(table, bodies[i].path(), reader.findings()), i + 1, around));
    }
    return read;
}

} // namespace

Medium read_medium(Reader& reader, const MapLoader& load_map) {
    static const std::array<std::string, 2> bases = {"rigid", "half-space"};
    if (reader.empty()) return {};
    Medium medium;
    medium.base = reader.choice("base", bases) == "rigid" ? Base::rigid : Base::half_space;
    const bool preset_is_known =
        !reader.has("preset") || reader.find_choice("preset", preset_names()).has_value();
    if (preset_is_known && reader.has("preset") && reader.has("layer"))
        reader.error("preset", "fills in all the layers, but medium.layer is given as well; name "
                               "the preset in a layer, or take the layers out");
    if (preset_is_known && !reader.has("layer")) reader.missing("layer");
    const std::size_t before = reader.findings().errors();
    read_layers(reader, medium);
    medium.map = read_map(reader, load_map);
    if (reader.findings().errors() == before && medium.map)
        check_bulk_modulus_of_map(reader, medium);
    const bool is_sound = reader.findings().errors() == before;
    medium.bodies = read_bodies(reader, is_sound ? medium : Medium{});
    reader.finish();
    return medium;
}

} // namespace shearwake
