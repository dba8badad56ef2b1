// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"
#include "config/sections/read_fields.hpp"
#include "config/sections/read_footprint.hpp"

namespace shearwake::config {
namespace {

Carrier read_carrier(Reader& reader) {
    ResolvedCarrier resolved;
    read_fields(reader, resolved);
    if (reader.find_choice("carrier", alternative_names<Carrier>()) == ResolvedCarrier::name)
        return resolved;
    if (reader.has("carrier_kHz"))
        reader.error("carrier_kHz", "applies only with carrier = \"resolved\"");
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
        reader.error("peak_Pa",
                     "and load.footprint.pressure_Pa_m are both given; specify only one of them");
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

} // namespace shearwake::config
