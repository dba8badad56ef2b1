// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "parallel/agree.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::pipeline {

/// Base of the parts of SurfaceRecorder, each of which records one kind of data and ignores the
/// others: it receives the field, is saved to and restored from checkpoints, and combines the slabs
/// at the end.
class Recording : public engines::Observer {
public:
    Recording(const Case& c, const Comm& team) : case_(c), team_(team) {}
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void frame(const engines::Frame&) override {}
    void stress(const engines::StressFrame&) override {}
    void tangential(const engines::TangentialFrame&) override {}
    void volume_levels(const std::vector<double>&) override {}
    void volume(const engines::VolumePlane&) override {}
    void solved(const engines::SolverReport&) override {}
    void save(StateWriter&) override {}
    void restore(const StateReader&) override {}
    /// Collective, once, after the engine. Throws CaseFailure on all ranks together.
    virtual void finish() = 0;

protected:
    const Case& case_;
    const Comm& team_;
    engines::Slab slab_; // of this rank
};

/// The frame nearest to a time, from 0.
std::ptrdiff_t frame_at(const Case& c, double t_s);

/// The rows of the surface that a slab holds.
inline DistributedRows surface_rows(const Domain& domain, const engines::Slab& slab) {
    return {domain.nx, slab.x_start, slab.x_count, domain.ny};
}

/// Arrays of which every rank saves its own part. With the same number of ranks, each rank restores
/// its part bit for bit; otherwise each rank receives several parts or none, which `take` combines.
class RankParts {
public:
    explicit RankParts(const Comm& team) : team_(team) {}
    /// Once per checkpoint. Collective, as all functions here.
    void save_ranks(StateWriter& state) const;
    void save(StateWriter& state, const std::string& name, const std::vector<double>& mine) const;
    /// Calls `take` with each part of `length` numbers that belongs to this rank.
    void restore(const StateReader& state, const std::string& name, std::size_t length,
                 const std::function<void(std::span<const double>)>& take) const;

private:
    const Comm& team_;
};

} // namespace shearwake::pipeline
