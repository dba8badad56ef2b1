#include "config/read_case.hpp"

#include <array>

namespace shearwake {
namespace {

Footprint read_footprint(Reader reader) {
    static const std::array<std::string, 1> shapes = {"gaussian"};
    GaussianFootprint footprint;
    const bool known = !reader.has("shape") || reader.find_choice("shape", shapes).has_value();
    if (!reader.has("shape")) reader.missing("shape");
    if (!known) return footprint; // its other keys are another shape's
    footprint.fwhm_m = reader.number("fwhm_mm", Range::between(0.01, 1000.0));
    reader.finish();
    return footprint;
}

Carrier read_carrier(Reader& reader) {
    static const std::array<std::string, 2> carriers = {"averaged", "resolved"};
    const auto frequency_Hz = reader.find_number("carrier_kHz", Range::between(1.0, 1000.0));
    if (reader.choice_or("carrier", "averaged", carriers) == "resolved")
        return ResolvedCarrier{frequency_Hz.value_or(ResolvedCarrier{}.frequency_Hz)};
    if (reader.has("carrier_kHz"))
        reader.error("carrier_kHz", "has a meaning only with carrier = \"resolved\"");
    return AveragedCarrier{};
}

} // namespace

Load read_load(Reader& reader, const Medium& medium, OtherKinds other_kinds,
               const TextLoader& load_text) {
    if (reader.empty()) return {};
    Load load;
    load.peak_Pa = reader.number("peak_Pa", Range::above(0.0));
    load.footprint = read_footprint(reader.table("footprint"));
    load.carrier = read_carrier(reader);
    Reader modulation = reader.table("modulation");
    load.modulation = read_modulation(modulation, medium, other_kinds, load_text);
    reader.finish();
    return load;
}

} // namespace shearwake
