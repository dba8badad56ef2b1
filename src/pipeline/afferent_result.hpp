// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "measures/summary.hpp"
#include "neural/hand/hand.hpp"
#include "neural/respond.hpp"
#include "neural/response.hpp"
#include "parallel/comm.hpp"
#include "pipeline/surface_recorder.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/volume.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The response of nerve fibres to a motion, as written to files and reported.
struct AfferentResult {
    std::vector<VariableGroup> groups; // "afferents", "pins", "hand"
    std::vector<measures::Column> columns;
    std::vector<std::string> notes; // warnings, one line each
    std::vector<neural::ClassResponse> classes;
};

/// Data of a case in addition to its motion.
struct ReceptorMotion {
    PointMotion pins; // for the input "pins"; otherwise only positions and duration are used
    std::vector<std::vector<double>> compression_Pa; // for the input "stress": one row per afferent
    neural::Repetitions repetitions; // of these motions and stresses, in the periodic regime
    std::vector<Vec2> path_m;        // positions of the focus on the patch, for the spread
    double near_m = 0.0;             // distance up to which receptors are near the path
    double modulation_Hz = 0.0;      // 0: none
    std::string name;                // the key of the noise: a case's id
};

/// The places of the afferents and pins of a case, nothing without afferents. The check, plan,
/// probe and run of a case share them, as do cases with equal options that follow. Not collective.
std::shared_ptr<const neural::Scene> receptors_of(const Case& c);

/// The motion of the pins of a case from t = 0, where nothing has moved, to the last but one frame,
/// with one sample per interval of the run, and the other inputs of its afferents. In the periodic
/// regime, one period of the motion, and how often it is repeated.
ReceptorMotion receptor_motion(const PlannedCase& planned, const SurfaceRecorder& recorder,
                               const neural::Scene& scene);

/// How often the receptors of a case feel the run: once, or in the periodic regime the run-in, the
/// counted periods, and a run-out. Not collective.
neural::Repetitions receptor_repetitions(const Case& c, const neural::Scene& scene);

/// Makes the recorder store the stress at the receptors, if the case requests it. Call before the
/// run; collective.
void record_receptors(const Case& c, const std::shared_ptr<const neural::Scene>& scene,
                      SurfaceRecorder& recorder);

/// Distributes the afferents over the ranks; the result contains all of them on rank 0 and none
/// elsewhere. The spikes do not depend on the number of ranks. Throws CaseFailure on all ranks if
/// pins or traces are not valid. Collective.
AfferentResult simulate_afferents(const ReceptorMotion& motion, const AfferentOptions& options,
                                  const neural::Scene& scene, const Comm& team);

/// Errors and warnings about the pins or receptors of a case that require no simulation.
std::vector<Remark> check_afferents(const Case& c);

/// The number of operations of all ranks for the afferents of a case, in waves of a pin at an
/// afferent and a sample.
double receptors_work(const Case& c, const neural::Scene& scene);

/// Memory per rank for the afferents of a case, in addition to the engine [B].
double afferents_memory_B(const Case& c, const neural::Scene& scene, int ranks);
/// Size of their groups in the case file, for the average number of spikes under vibration [B].
double afferents_file_B(const Case& c, const neural::Scene& scene);

} // namespace shearwake::pipeline
