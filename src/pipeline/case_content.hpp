// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "measures/summary.hpp"
#include "neural/hand/hand.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/surface_recorder.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/volume.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The content of a case file in addition to its surface fields, on rank 0: that of
/// field_content(), the level of sensation in /sensation, the spikes and pins in their groups, and
/// the velocities of a vibrometer in /vibrometer. Not collective.
std::vector<VariableGroup> case_content(const Case& c, const SurfaceRecorder& recorder,
                                        AfferentResult afferents);

/// What follows from the frames: series and scalars in the root group, the traces with their
/// spectra in /traces, and the time mean of u_z^2 on the surface, unless empty, in /mean.
std::vector<VariableGroup> field_content(const Case& c,
                                         const std::vector<measures::DepthSeries>& depths,
                                         const std::vector<measures::TraceSeries>& traces,
                                         const std::optional<measures::MachFit>& mach,
                                         const std::vector<double>& mean_u2);

/// Columns of the table as scalars of a group.
void add_columns(const std::vector<measures::Column>& columns, VariableGroup& group);

/// Names of the columns of the root group that count samples of the grid, separated by spaces.
std::string columns_in_samples(const VariableGroup& root);

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

/// The results of a case in addition to its surface fields.
struct CaseResults {
    engines::SolverReport solver;       // empty without a report
    std::vector<std::string> afferents; // warnings about the afferents, lines "key: message"
    // On rank 0 only.
    std::vector<VariableGroup> groups;          // as in the case file
    std::vector<double> mean_u2;                // see SurfaceRecorder::mean_u2()
    std::vector<measures::SurfaceSums> surface; // at the first measured depth at each frame
};

/// Mean of u_z^2 over the edges of the domain divided by its mean over the domain: the share of the
/// energy that waves carry beyond a periodic edge. `mean_u2` has the shape [nx][ny]. 0 without
/// motion. Not collective.
double edge_share(const Domain& domain, const std::vector<double>& mean_u2);

/// The warnings that are stored with a complete case: those of `check` (`expected`), of the solver
/// and of the afferents. The computed mean of u_z^2 (empty: unknown) decides on waves that may
/// return through periodic edges. If they carry too much energy, the severity is `error`: the
/// readings are not valid. If they carry almost none, the warning is omitted. The sums at each
/// frame (empty: unknown) decide on the uplift by images. Not collective.
std::vector<Remark> case_warnings(const Case& c, const CaseResults& results,
                                  const std::vector<Remark>& expected);

} // namespace shearwake::pipeline
