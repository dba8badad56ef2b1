// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/inside_bodies.hpp"

#include "engines/spectral/bodies/rigid_choice.hpp"

#include <cmath>

namespace shearwake::spectral {

InsideBodies::InsideBodies(const Case& c, const fft::SlabShare& share)
    : bodies_(rigid_bodies(c)), domain_(c.domain), share_(share) {
    // Complete layers are at rest and have no motion.
    std::size_t moving = 0;
    for (const Body& body : bodies_)
        motion_.push_back(endless_along(body, c.domain) == Endless::both ? std::nullopt
                                                                         : std::optional(moving++));
}

template <class Use>
void InsideBodies::each_point(double depth_m, const Use& use) const {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const Bounds box = bounds(bodies_[body]);
        if (depth_m < box.low_m.z || depth_m > box.high_m.z) continue;
        const Vec3 centre = bodies_[body].centre_m;
        for (std::ptrdiff_t i = 0; i < share_.x_count; ++i)
            for (std::ptrdiff_t j = 0; j < domain_.ny; ++j) {
                // A body continues beyond the periodic edge.
                const Vec3 offset{std::remainder(domain_.x_m(share_.x_start + i) - centre.x,
                                                 domain_.extent_x_m()),
                                  std::remainder(domain_.y_m(j) - centre.y, domain_.extent_y_m()),
                                  depth_m - centre.z};
                if (volume_fraction(bodies_[body], centre + offset, {}) > 0.5)
                    use(i * share_.padded_ny + j, body, offset);
            }
    }
}

void InsideBodies::set_displacement(double depth_m, std::size_t component,
                                    const std::vector<RigidMotion>& motions, double* plane) const {
    each_point(depth_m, [&](std::ptrdiff_t at, std::size_t body, Vec3 offset) {
        const Vec3 u = motion_[body] ? motions[*motion_[body]].at(offset) : Vec3{};
        plane[at] = component == 0 ? u.x : component == 1 ? u.y : u.z;
    });
}

void InsideBodies::clear(double depth_m, double* plane) const {
    each_point(depth_m, [&](std::ptrdiff_t at, std::size_t, Vec3) { plane[at] = 0.0; });
}

} // namespace shearwake::spectral
