// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/cost/machine.hpp"

#include <filesystem>
#include <functional>
#include <set>
#include <string>

namespace shearwake::cost {

/// Settings of a calibration.
struct CalibrationHooks {
    std::function<void(const std::string&)> report; // prints messages; called on rank 0
    std::filesystem::path files; // folder in which files are timed; empty: use default rates
    /// Whether to end early, at the next time step or stage; may differ between ranks. Empty:
    /// never.
    std::function<bool()> stop = {};
};

/// Those kinds of work, among `kinds` and the kinds that their calibrations contain, whose rate is
/// not `known` but can be calibrated.
std::set<std::string> kinds_to_measure(const std::set<std::string>& kinds,
                                       const engines::Rates& known);

/// The kinds of work of all engines and receptors.
std::set<std::string> every_kind();

/// Measures the rates of these kinds and adds them to `known`. All ranks measure at the same time,
/// since they share the memory bandwidth of the machine, each with a communicator of its own. Times
/// are CPU times, which other processes disturb less. Files and all-to-alls are measured only if
/// nothing has been measured before. If a measurement fails or is stopped, `known` is returned.
/// Collective.
Machine calibrated(const Machine& known, const std::set<std::string>& kinds, const Comm& world,
                   const CalibrationHooks& hooks);

/// Sets the machine of `costs`. Rates that the cases need and that the file of this machine lacks
/// are calibrated and added to the file. `ranks` is the number of ranks to plan for; if a file for
/// this number exists and is complete, it is used. `report` and `stop`: see CalibrationHooks.
/// Collective.
void calibrate_for(CaseCosts& costs, int ranks, const Comm& world,
                   const std::function<void(const std::string&)>& report,
                   const std::function<bool()>& stop = {});

} // namespace shearwake::cost
