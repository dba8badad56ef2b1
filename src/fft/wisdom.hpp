// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <functional>
#include <type_traits>
#include <optional>
#include <string>

namespace shearwake::fft {

/// Creates plans with the given FFTW planner flags (an effort, possibly with FFTW_WISDOM_ONLY) and
/// returns whether all could be created. Must not communicate; may be called several times.
using MakePlans = std::function<bool(unsigned flags)>;

/// The FFTW library that creates the plans. Each has its own wisdom.
enum class Precision { in_double, in_single };
/// The FFTW library for values of type `Real`.
template <class Real>
constexpr Precision precision_of =
    std::is_same_v<Real, float> ? Precision::in_single : Precision::in_double;

/// Creates measured plans that are the same in every run. FFTW's measurements vary from run to run,
/// and different plans differ in the last bits. Therefore all plans are created from a file of
/// wisdom: if there is no file for this CPU, FFTW version and `shape`, rank 0 measures the plans,
/// writes the file and reads it again; the other ranks receive its text. If several processes
/// measure at the same time, the first file is kept and used by all.
///
/// As long as a file is neither deleted nor damaged, all programs on this machine use the same
/// plans for this shape on any number of ranks. All ranks use FFTW_ESTIMATE instead if no file can
/// be kept (SHEARWAKE_CACHE=off, no folder, read-only or full disk), or if the machine of another
/// rank cannot use it. A damaged file is replaced. No wisdom remains in the process afterwards.
/// Throws Error if FFTW cannot create a plan. Collective.
void plan_measured(const Comm& team, const std::string& shape, const MakePlans& make,
                   Precision precision = Precision::in_double);

/// Creates plans with FFTW_ESTIMATE, independent of earlier planning. Throws Error if FFTW cannot
/// create a plan. Not collective.
void plan_estimated(const MakePlans& make, Precision precision = Precision::in_double);

/// Path of the wisdom file for `shape` in the cache folder (base/cache.hpp), or nothing if there is
/// no cache. Not collective.
std::optional<std::filesystem::path> wisdom_file(const std::string& shape);

} // namespace shearwake::fft
