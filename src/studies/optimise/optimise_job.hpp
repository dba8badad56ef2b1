// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/optimise/optimise_study.hpp"

#include <string>

namespace shearwake::optimise {

/// A job file whose only case has the motion of an optimum and this envelope, so that `run`
/// reproduces it: the job of the study with its overrides and the swept values of the case, and
/// without the tables [sweep], [table], [uncertain] and [optimise]. Not collective.
std::string job_of_optimum(const Study& study, const OptimisedCase& of, const MovedCase& moved,
                           const SampledGain& envelope);

} // namespace shearwake::optimise
