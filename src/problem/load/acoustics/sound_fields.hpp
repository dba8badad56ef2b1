// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

namespace shearwake {

/// The ultrasound of a source in air: `frequency_Hz` and `sound_speed_m_s`.
template <class Walk, class Source>
void walk_sound_fields(Walk& walk, Source& source) {
    walk(source.frequency_Hz, {.key = "frequency_kHz",
                               .range = Range::between(10.0, 200.0),
                               .meaning = "frequency of the ultrasound"});
    walk(source.sound_speed_m_s,
         {.key = "sound_speed_m_s",
          .range = Range::between(100.0, 2000.0),
          .meaning = "speed of sound in air; the default is for 25 degrees Celsius"});
}

} // namespace shearwake
