// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "pipeline/surface_recorder.hpp"
#include "problem/case/case.hpp"
#include "support/on_root.hpp"

#include <array>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace shearwake::test {

/// True in the long form of the tests (scripts/test --long).
inline bool is_long_form() {
    return std::getenv("SHEARWAKE_LONG") != nullptr;
}

/// The parameters of a test: all of them in the long form, otherwise only the first ones.
template <class T>
std::vector<T> parameters(std::ptrdiff_t count, std::vector<T> all) {
    if (!is_long_form()) all.erase(all.begin() + count, all.end());
    return all;
}

/// The reference layer of tests/verify/test_reference_table.cpp: 1000 kg/m^3, c_s = 5 m/s, 1 Pa s.
inline Layer tissue(double c_p_m_s = 50.0, double viscosity_Pa_s = 1.0) {
    Layer layer{.name = "tissue",
                .thickness_m = 0.0,
                .density_kg_m3 = 1000.0,
                .c_p_m_s = c_p_m_s,
                .c_s_m_s = 5.0,
                .loss = KelvinVoigt{viscosity_Pa_s}};
    if (viscosity_Pa_s == 0.0) layer.loss = Lossless{};
    return layer;
}

inline Medium half_space(const Layer& layer) {
    return {{layer}, Base::half_space};
}

/// A focus of 1 Pa and 3 mm that starts at x = -49 mm at t = 0 and moves until the end of the run.
inline Case moving_focus(const Medium& medium, const Motion& motion) {
    Case c;
    c.scene.medium = medium;
    c.scene.load.peak_Pa = 1.0;
    c.scene.load.footprint = GaussianFootprint{3e-3};
    c.scene.load.modulation.kind = "STM";
    c.scene.load.modulation.trajectory = {{Travel{{{-49e-3, 0.0}, {300e-3, 0.0}}, motion}}};
    c.domain = {256, 192, 0.75e-3, 0.0};
    c.time = {224, 62.5e-6};
    c.measure = {.at_s = 14e-3, .settled_after_s = 4e-3, .focal_radius_m = 3e-3};
    c.solver = LayeredOptions{};
    return c;
}

/// The path and motion of moving_focus().
inline Travel& travel_of(Case& c) {
    return std::get<Travel>(c.scene.load.modulation.trajectory.parts[0]);
}

/// A 3 mm focus at 7 m/s from (`from_m`, 0) to (`to_m`, 0) over layers of tissue of these
/// thicknesses on a rigid base.
inline Case focus_over_rigid_base(double viscosity_Pa_s, const std::vector<double>& thicknesses_m,
                                  double from_m, double to_m = 200e-3) {
    Medium medium{{}, Base::rigid};
    for (const double thickness_m : thicknesses_m) {
        medium.layers.push_back(tissue(1500.0, viscosity_Pa_s));
        medium.layers.back().thickness_m = thickness_m;
    }
    Case c = moving_focus(medium, ConstantSpeed{7.0});
    travel_of(c).path = {{from_m, 0.0}, {to_m, 0.0}};
    return c;
}

/// Base of observers that store one part of a run.
class IgnoringObserver : public engines::Observer {
public:
    void begin(const engines::Slab& /*slab*/) override {}
    void frame(const engines::Frame& /*frame*/) override {}
    void stress(const engines::StressFrame& /*frame*/) override {}
    void tangential(const engines::TangentialFrame& /*frame*/) override {}
    void volume_levels(const std::vector<double>& /*z_m*/) override {}
    void volume(const engines::VolumePlane& /*plane*/) override {}
    void solved(const engines::SolverReport& /*report*/) override {}
    void save(StateWriter& /*state*/) override {}
    void restore(const StateReader& /*state*/) override {}
};

/// Stores every frame of a run on this rank's slab.
class FrameStore : public IgnoringObserver {
public:
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void frame(const engines::Frame& frame) override {
        frames_[{static_cast<long>(frame.depth), frame.number}] = values_of(frame.u_z_m);
    }
    const engines::Slab& slab() const { return slab_; }
    std::size_t planes() const { return frames_.size(); }
    const std::vector<double>& at(std::ptrdiff_t number, std::size_t depth = 0) const {
        return frames_.at({static_cast<long>(depth), number});
    }
    /// Replaces the frames by those of the root. Collective.
    void take_from_root(const Comm& world) { broadcast(frames_, world); }

protected:
    static std::vector<double> values_of(const View2<const double>& plane) {
        std::vector<double> values;
        for (std::ptrdiff_t i = 0; i < plane.rows(); ++i) {
            const auto row = plane.row(i);
            values.insert(values.end(), row.begin(), row.end());
        }
        return values;
    }

    engines::Slab slab_;
    std::map<std::array<long, 2>, std::vector<double>> frames_; // by depth and number
};

/// All frames of a case, or what another store keeps, computed on this rank alone.
template <class Store = FrameStore>
Store frames_of(const Case& c) {
    Store store;
    engines::make_engine(c.solver)->run(c, alone(), store);
    return store;
}

/// The same, computed on the root alone, on all ranks. Collective.
template <class Store = FrameStore>
Store frames_of_root(const Case& c, const Comm& world) {
    Store store;
    on_root_alone(world,
                  [&](const Comm& alone) { engines::make_engine(c.solver)->run(c, alone, store); });
    store.take_from_root(world);
    return store;
}

/// The columns of the table for a case, computed on a team. Collective.
inline std::map<std::string, double> columns_of(const Case& c, engines::Engine& engine,
                                                const Comm& team) {
    pipeline::SurfaceRecorder recorder(c, team, {});
    engine.run(c, team, recorder);
    recorder.finish();
    std::map<std::string, double> values;
    for (const measures::Column& column :
         measures::summarise(c, recorder.depths(), recorder.traces(), recorder.mach()))
        values[column.name] = column.value;
    return values;
}

} // namespace shearwake::test
