// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/pstd/scheme/recorder.hpp"
#include "kwave/input.hpp"
#include "kwave/run.hpp"
#include "parallel/comm.hpp"
#include "storage/hdf5/h5.hpp"

#include <utility>

namespace shearwake::kwave {

/// An output file that rank 0 writes.
struct OutputFile {
    hid_t file = -1;
    bool doubles = false; // real numbers of 64 bits instead of 32
    int gzip_level = 0;
};

/// Times of the phases of a run, for the output file.
struct Phases {
    double loading_s = 0.0, preparing_s = 0.0, stepping_s = 0.0;
    Clock::time_point began = Clock::now(), phase = began;
    double next() {
        const auto now = Clock::now(), from = std::exchange(phase, now);
        return seconds_between(from, now);
    }
};

/// Writes scalars and attributes. Not collective.
void write_facts(const OutputFile& output, const Arguments& arguments, const Input& input,
                 long steps, long done, Phases& phases, int ranks, double memory_B);

/// Writes the records after the last step, in the layout of k-Wave: (1, samples, points) or one
/// dataset per cuboid, (samples, z, y, x); grids as (z, y, x). Collective.
template <class Real>
void write_records(const OutputFile& output, const pstd::Recorder& recorder, const Input& input,
                   const pstd::Stepper<Real>& stepper, const Comm& team);

} // namespace shearwake::kwave
