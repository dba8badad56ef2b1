// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"
#include "config/sections/read_fields.hpp"

#include <fmt/format.h>

namespace shearwake::config {
namespace {

Carrier read_array_carrier(Reader& reader) {
    ResolvedCarrier resolved;
    read_fields(reader, resolved);
    if (reader.find_choice("carrier", alternative_names<Carrier>()) == ResolvedCarrier::name)
        return resolved;
    if (reader.has("carrier_kHz"))
        reader.error("carrier_kHz", "applies only with carrier = \"resolved\"");
    return AveragedCarrier{};
}

/// The pattern of a lens can neither move nor be multiplied.
void check_static(Reader& reader, const Modulation& modulation) {
    if (greatest_speed_m_s(modulation.trajectory) > 0.0)
        reader.error("kind", "moves the focus, but the pattern of a lens is static: use kind = "
                             "\"AM\", or footprint.shape = \"array\"");
    if (!modulation.foci_m.empty())
        reader.error("foci_mm", "does not apply to a lens, whose foci are those of "
                                "load.footprint.target_foci_mm");
}

} // namespace

Load read_load(Reader& reader, const Medium& medium, OtherKinds other_kinds,
               const FileLoaders& files) {
    if (reader.empty()) return {};
    Load load;
    const auto peak_Pa = reader.find_number("peak_Pa", range_of<Load>("peak_Pa"));
    const FootprintAndPeak read = read_footprint(reader.table("footprint"), files);
    load.footprint = read.footprint;
    load.peak_Pa = peak_Pa.value_or(read.peak_Pa.value_or(1.0));
    const bool is_lens = std::holds_alternative<LensFootprint>(load.footprint);
    if (read.defines_peak && reader.has("peak_Pa"))
        reader.error("peak_Pa",
                     fmt::format("and load.footprint.{} are both given; specify only one of them",
                                 is_lens ? "pressure_Pa" : "pressure_Pa_m"));
    if (!read.defines_peak && !reader.has("peak_Pa")) {
        if (is_lens)
            reader.error("peak_Pa", "is missing (or load.footprint.pressure_Pa, the amplitude of "
                                    "the sound behind the lens)");
        else if (std::holds_alternative<ArrayFootprint>(load.footprint))
            reader.error("peak_Pa", "is missing (or load.footprint.pressure_Pa_m, the strength of "
                                    "the array's pistons)");
        else
            reader.missing("peak_Pa");
    }
    load.carrier = read_array_carrier(reader);
    Reader modulation = reader.table("modulation");
    load.modulation = read_modulation(modulation, medium, other_kinds, files.load_text);
    if (is_lens) check_static(modulation, load.modulation);
    reader.finish();
    return load;
}

} // namespace shearwake::config
