// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/cases.hpp"

namespace shearwake::test {

/// Stores every plane of the volumes of a run, on this rank's slab.
class VolumeStore : public FrameStore {
public:
    void volume_levels(const std::vector<double>& z_m) override { z_m_ = z_m; }
    void volume(const engines::VolumePlane& plane) override {
        planes_[key(plane.snapshot, plane.field, plane.component, plane.level)] =
            values_of(plane.values);
    }
    const std::vector<double>& z_m() const { return z_m_; }
    std::size_t planes() const { return planes_.size(); }
    const std::vector<double>& at(std::size_t snapshot, std::size_t field, std::size_t component,
                                  std::size_t level) const {
        return planes_.at(key(snapshot, field, component, level));
    }
    /// Replaces the planes by those of the root. Collective.
    void take_from_root(const Comm& world) { broadcast(planes_, world); }

private:
    using Key = std::array<long, 4>;
    static Key key(std::size_t snapshot, std::size_t field, std::size_t component,
                   std::size_t level) {
        return {static_cast<long>(snapshot), static_cast<long>(field), static_cast<long>(component),
                static_cast<long>(level)};
    }
    std::vector<double> z_m_;
    std::map<Key, std::vector<double>> planes_;
};

} // namespace shearwake::test
