#pragma once

#include "engines/engine.hpp"
#include "measures/summary.hpp"
#include "model/plan.hpp"
#include "model/record.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// What is written of a case beside its surface fields: series and scalars in the root group, the
/// traces with their spectra in /traces, the surface's time mean of u_z^2, unless empty, in /mean.
std::vector<VariableGroup> case_content(const Case& c, const std::vector<DepthSeries>& depths,
                                        const std::vector<TraceSeries>& traces,
                                        const std::optional<MachFit>& mach,
                                        const std::vector<double>& mean_u2);

/// Columns of the table as scalars of a group.
void add_columns(const std::vector<Column>& columns, VariableGroup& group);

/// What a study's sensor has heard, /sensor of the file.
VariableGroup sensor_group(const GridStudy& study, const std::vector<SensorSeries>& sensors);

/// How and when it was computed.
struct RunFacts {
    std::string job_title;
    std::string job_text;
    std::string overrides;
    int ranks = 1;
    double wall_s = 0.0;
    std::string started, ended; // UTC
    SolverReport solver;
};

/// Root attributes: what the case is and where it comes from.
std::vector<Attribute> case_attributes(const PlannedCase& planned, const RunFacts& facts);

} // namespace shearwake
