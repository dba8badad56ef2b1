// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/sensation.hpp"
#include "measures/summary.hpp"
#include "pipeline/observers/recording.hpp"

#include <optional>

namespace shearwake::pipeline {

/// The sums of every frame at every depth (measures/surface_sums.hpp).
class FrameSums : public Recording {
public:
    FrameSums(const Case& c, const Comm& team);
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    /// Throws CaseFailure when the field is not finite.
    void finish() override;

    const std::vector<measures::DepthSeries>& depths() const { return depths_; }

private:
    measures::Region region_;
    std::vector<measures::DepthSeries> depths_;
};

/// The time mean of u_z^2 over the period window, of the first depth [m^2].
class MeanEnergy : public Recording {
public:
    MeanEnergy(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override { all_ = team_.gather(rows_); }

    /// (x, y) row-major. On rank 0 only; empty elsewhere, and when no window fits.
    const std::vector<double>& all() const { return all_; }

private:
    std::vector<double> weights_; // of each frame, with sum 1; empty: no window fits
    std::vector<double> rows_;    // of this rank so far
    std::vector<double> all_;
};

/// The level of sensation in the measured region, if the case computes it.
class SensationLevels : public Recording {
public:
    SensationLevels(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// The complete map. On rank 0 only; empty elsewhere, and where there is no level.
    const measures::SensationMap& map() const { return map_; }

private:
    DistributedRows rows() const;

    std::size_t surface_ = 0; // index of the depth 0
    std::optional<measures::SensationSums> sums_;
    measures::SensationMap map_;
};

} // namespace shearwake::pipeline
