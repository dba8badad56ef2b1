// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/study_data.hpp"
#include "problem/load/load.hpp"
#include "problem/medium/medium.hpp"

#include <memory>
#include <variant>

namespace shearwake {

/// A medium and the load on its surface.
struct Scene {
    Medium medium;
    Load load;
    bool operator==(const Scene&) const = default;
};

/// A simulation that is defined node by node. The measures refer to the path of the focus and to
/// the layers of `scene`, which have no effect on the solution.
struct GridStudy {
    std::shared_ptr<const StudyData> data; // shared by the cases of a sweep, since it may be large
    Scene scene;
    bool operator==(const GridStudy& other) const {
        return *data == *other.data && scene == other.scene;
    }
};

/// What an engine computes.
using Problem = std::variant<Scene, GridStudy>;

/// The scene of a problem, which is either the problem itself or that of a grid study.
auto& scene_of(auto& problem) {
    auto* study = std::get_if<GridStudy>(&problem);
    return study ? study->scene : std::get<Scene>(problem);
}

} // namespace shearwake
