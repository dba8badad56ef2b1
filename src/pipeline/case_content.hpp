// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "measures/summary.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/record.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The content of a case file in addition to its surface fields: series and scalars in the root
/// group, the traces with their spectra in /traces, and the time mean of u_z^2 on the surface,
/// unless empty, in /mean.
std::vector<VariableGroup> case_content(const Case& c,
                                        const std::vector<measures::DepthSeries>& depths,
                                        const std::vector<measures::TraceSeries>& traces,
                                        const std::optional<measures::MachFit>& mach,
                                        const std::vector<double>& mean_u2);

/// The energies of a period as columns; none without them.
std::vector<measures::Column> energy_columns(const engines::SolverReport& solver);

/// Columns of the table as scalars of a group.
void add_columns(const std::vector<measures::Column>& columns, VariableGroup& group);

/// Names of the columns of the root group that count samples of the grid, separated by spaces.
std::string columns_in_samples(const VariableGroup& root);

/// The recorded data of the sensor of a study, group /sensor of the file.
VariableGroup sensor_group(const StudyData& study,
                           const std::vector<engines::SensorSeries>& sensors);

/// When and on which resources the case was computed.
struct RunFacts {
    std::string job_title;
    std::string job_text;
    std::string overrides;
    int ranks = 1;
    double wall_s = 0.0;
    std::string started, ended; // UTC
    engines::SolverReport solver;
    std::vector<Remark> warnings;
    std::string columns_in_samples;
};

/// Root attributes that identify the case and its origin.
std::vector<Attribute> case_attributes(const PlannedCase& planned, const RunFacts& facts);

} // namespace shearwake::pipeline
