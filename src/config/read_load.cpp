#include "config/read_case.hpp"
#include "config/read_footprint.hpp"

#include <array>

namespace shearwake {
namespace {

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
    const auto peak_Pa = reader.find_number("peak_Pa", Range::above(0.0));
    const FootprintAndPeak read = read_footprint(reader.table("footprint"));
    load.footprint = read.footprint;
    load.peak_Pa = peak_Pa.value_or(read.peak_Pa.value_or(1.0));
    if (read.gives_peak && reader.has("peak_Pa"))
        reader.error("peak_Pa", "and load.footprint.pressure_Pa_m are both given; one of them says "
                                "it all");
    if (!read.gives_peak && !reader.has("peak_Pa")) {
        if (std::holds_alternative<ArrayFootprint>(load.footprint))
            reader.error("peak_Pa", "is missing (or load.footprint.pressure_Pa_m, the strength of "
                                    "the array's pistons)");
        else
            reader.missing("peak_Pa");
    }
    load.carrier = read_carrier(reader);
    Reader modulation = reader.table("modulation");
    load.modulation = read_modulation(modulation, medium, other_kinds, load_text);
    reader.finish();
    return load;
}

} // namespace shearwake
