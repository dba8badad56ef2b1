#pragma once

#include "measures/summary.hpp"
#include "model/case.hpp"
#include "model/check.hpp"
#include "model/plan.hpp"
#include "model/point_motion.hpp"
#include "model/record.hpp"
#include "neural/response.hpp"
#include "parallel/comm.hpp"
#include "sweep/surface_recorder.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// What a motion makes nerve fibres do, as it is written and told.
struct AfferentResult {
    std::vector<VariableGroup> groups; // "afferents", "pins", "hand"
    std::vector<Column> columns;
    std::vector<std::string> notes; // what is doubtful, one line each
    std::vector<neural::ClassResponse> classes;
};

/// What is needed of a case beside its motion.
struct FeltMotion {
    PointMotion pins; // of the input "pins"; else only their places and the duration count
    std::vector<std::vector<double>> compression_Pa; // of the input "stress": a line an afferent
    std::vector<Vec2> path_m;   // places of the focus, for the spread; on the patch
    double modulation_Hz = 0.0; // 0: none
    std::string name;           // the key of the noise: a case's id
};

/// The motion of a case's pins from t = 0, where nothing has moved, to the last frame but one: as
/// many samples as the run has intervals. And what else its afferents are asked about.
FeltMotion felt_motion(const PlannedCase& planned, const SurfaceRecorder& recorder);

/// The recorder keeps the stress at the receptors of a case that asks for it. Before the run;
/// collective.
void keep_receptors(const Case& c, SurfaceRecorder& recorder);

/// Afferents are shared out among the ranks; on rank 0 the result holds all of them, elsewhere
/// none. The same spikes on any number of ranks. Throws CaseFailure, on all ranks alike, when pins
/// or traces have a mistake. Collective.
AfferentResult felt(const FeltMotion& motion, const AfferentOptions& options, const Comm& team);

/// What the afferents of a case need on a rank beside the engine [B].
double afferents_memory_B(const Case& c);

/// Mistakes and doubts about a case's pins, or receptors, that need no simulation.
std::vector<Remark> check_afferents(const Case& c);

} // namespace shearwake
