// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/study_material.hpp"

#include <algorithm>

namespace shearwake::pstd {

MaterialOfNode material_of(const StudyData& study) {
    return [&study](Node node) {
        const std::ptrdiff_t at = (node[0] * study.points[1] + node[1]) * study.points[2] + node[2];
        const auto value = [&](const std::vector<double>& values) {
            if (values.empty()) return 0.0;
            return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(at)];
        };
        return NodeMaterial{value(study.density_kg_m3), value(study.c_p_m_s), value(study.c_s_m_s),
                            value(study.chi_Pa_s), value(study.eta_Pa_s)};
    };
}

bool is_uneven(const StudyData& study) {
    return std::max({study.density_kg_m3.size(), study.c_p_m_s.size(), study.c_s_m_s.size(),
                     study.eta_Pa_s.size(), study.chi_Pa_s.size()}) > 1;
}

} // namespace shearwake::pstd
