// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/transfer_table.hpp"
#include "problem/case/case.hpp"

namespace shearwake::layered {

/// Errors of the field due to the time step, relative to its maximum at any depth: for which the
/// step is chosen, and above which a case has a warning.
inline constexpr double step_accuracy = 2e-5, stated_accuracy = 1e-4;
/// Larger estimates of the error are not printed: the step does not resolve the load.
inline constexpr double largest_estimate = 0.1;

/// Sample spacing and period of the time transform of a case. The step divides the output interval
/// and, unless the options specify it, is the longest one that
///
/// - resolves 1.25 times the combined bandwidth of footprint, scan, envelope and carrier (up to
/// where
///   the spectrum of the footprint has fallen to 1e-6), and five times the frequency of a
///   sinusoidal gain,
/// - is at most 0.35 of the time in which a shear wave crosses a standard deviation of the
/// footprint, if
///   the load has jumps or kinks,
/// - and represents the response of the medium to the start of the load, and to its other jumps and
///   kinks, with step_accuracy, see BreakError.
///
/// Throws UsageError if this results in more than most_samples. Not collective.
TimeTransform time_transform(const Case& c, const LayeredOptions& options);

/// Number of samples of the transform before breaks of the load are considered, by arithmetic
/// alone, and the largest one that is supported. Not collective.
double least_samples(const Case& c, const LayeredOptions& options);
inline constexpr double most_samples = 4e6;

/// Estimated error of the field for a step, relative to its maximum: that of BreakError and of
/// edges, the part of the spectrum of a moving focus above the roll-off of the transform, and 1 for
/// a sine gain above it. Not collective.
double step_error(const Case& c, double step_s);

/// Number of output intervals per sample of the transform.
std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time);

} // namespace shearwake::layered
