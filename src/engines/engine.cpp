// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"

namespace shearwake::engines {

double volumes_B(const Case& c, double levels) {
    double components = 0.0;
    for (const VolumeField field : c.record.volume_fields)
        components += static_cast<double>(components_of(field).size());
    return sizeof(double) * levels * components * static_cast<double>(c.domain.nx * c.domain.ny) *
           static_cast<double>(c.record.volumes_s.size());
}

} // namespace shearwake::engines
