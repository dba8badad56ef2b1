// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/mach_angle.hpp"
#include "pipeline/observers/recording.hpp"
#include "storage/case_file/case_file_writer.hpp"

#include <optional>

namespace shearwake::pipeline {

/// The frames that a case stores: all, or those closest to the requested snapshots.
std::vector<std::ptrdiff_t> recorded_frames(const Case& c);

/// Passes the frames and volumes that a case stores to its file.
class StoredFields : public Recording {
public:
    StoredFields(const Case& c, const Comm& team, storage::CaseFileWriter& writer);
    void frame(const engines::Frame& frame) override;
    void volume_levels(const std::vector<double>& z_m) override;
    void volume(const engines::VolumePlane& plane) override;
    /// Flushes the data stored so far to the disk.
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    /// Throws CaseFailure when a volume is not complete.
    void finish() override;

private:
    storage::CaseFileWriter& writer_;
    std::vector<std::ptrdiff_t> frames_;
    double volume_planes_ = 0.0; // so far
};

/// Stores the surface at the instant `measure.at` and fits the angle of the wake to it.
class InstantSurface : public Recording {
public:
    InstantSurface(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// On rank 0 only; empty elsewhere.
    const std::optional<measures::MachFit>& mach() const { return mach_; }

private:
    measures::MachFit fit(const std::vector<double>& surface) const;

    std::ptrdiff_t instant_;
    std::vector<double> rows_;
    // Whether the frame of the instant was received; this rank may have no rows of it.
    bool has_instant_ = false;
    std::optional<measures::MachFit> mach_;
};

} // namespace shearwake::pipeline
