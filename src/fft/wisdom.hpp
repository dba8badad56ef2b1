#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <functional>
#include <type_traits>
#include <optional>
#include <string>

namespace shearwake {

/// Makes plans with the given flags of FFTW's planner (an effort, perhaps FFTW_WISDOM_ONLY) and
/// says whether all came into being. Must not communicate; may be called several times.
using MakePlans = std::function<bool(unsigned flags)>;

/// Which of FFTW's two libraries makes the plans: each has its own wisdom.
enum class Precision { in_double, in_single };
template <class Real>
constexpr Precision precision_of =
    std::is_same_v<Real, float> ? Precision::in_single : Precision::in_double;

/// Measured plans that are the same every time. FFTW's measurements come out differently from run
/// to run and plans differ in the last bits, so only a plan that stands in a file is ever used:
/// rank 0 measures where there is no file for this processor, version of FFTW and `shape`, writes
/// it, reads it again, and every rank plans from those words. The first writer wins: a program that
/// comes second drops what it has measured and takes what is there.
///
/// Promised: while a file is not deleted or damaged, every program of this machine has the same
/// plans for its shape, on any number of ranks. Where no file can be kept (SHEARWAKE_CACHE=off, no
/// folder, read-only, full) or another rank's machine cannot follow it, all ranks use
/// FFTW_ESTIMATE. A damaged file is replaced. No wisdom is left in the process. Collective.
void plan_measured(const Comm& team, const std::string& shape, const MakePlans& make,
                   Precision precision = Precision::in_double);

/// Plans with FFTW_ESTIMATE, whatever was planned before. Not collective.
void plan_estimated(const MakePlans& make, Precision precision = Precision::in_double);

/// The file for a shape in ${SHEARWAKE_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/shearwake}, or none.
std::optional<std::filesystem::path> wisdom_file(const std::string& shape);

} // namespace shearwake
