// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/stepper.hpp"
#include "engines/work.hpp"

namespace shearwake::pstd {

/// Per point and step: lossless and lossy, in double and in single precision. Accurate within about
/// 20 % for other grid sizes, because the caches favour small grids while short FFTs are less
/// efficient.
inline constexpr engines::WorkKind of_step[4] = {{"pstd.step.double", 50e-9},
                                                 {"pstd.step.double.lossy", 70e-9},
                                                 {"pstd.step.single", 32e-9},
                                                 {"pstd.step.single.lossy", 45e-9}};
inline constexpr engines::WorkKind of_begin = {"pstd.begin", 1e-7}; // per point
inline constexpr engines::WorkKind of_inclusions = {
    "pstd.inclusions", 1e-6}; // per point of a medium with bodies or a map
inline constexpr engines::WorkKind of_column = {"pstd.column",
                                                5e-8}; // per column of the grid and step: the load
inline constexpr engines::WorkKind of_frame = {"pstd.frame",
                                               1e-8}; // per point of the domain, frame and depth
inline constexpr engines::WorkKind of_volume = {"pstd.volume", 5e-9}; // per point and step

inline const engines::WorkKind& step_kind(Absorption absorption, Precision precision) {
    return of_step[(precision == Precision::single_precision ? 2 : 0) +
                   (absorption != Absorption::none ? 1 : 0)];
}

} // namespace shearwake::pstd
