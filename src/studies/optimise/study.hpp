// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/optimise_options.hpp"
#include "problem/case/plan.hpp"
#include <Eigen/Core>
#include "studies/optimise/search/search.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// A case of a job whose envelope is optimised, and the cases from which its forms are computed and
/// with which its optimum is compared.
struct OptimisedCase {
    PlannedCase base; // without envelope
    Knots knots;
    Case plain; // as the cases of the knots, but with the unmodulated load, and without frames
    std::vector<SmCase> sm; // without frames; the search adds more
};

/// An optimised case whose focus moves as in the job or as changed by the search.
struct MovedCase {
    std::size_t of = 0; // position of the optimised case
    MotionChange change;
    Case physics; // without envelope
    std::string id;
    Knots knots;
};

/// The cases of a plan, without references. Throws UsageError for a case that cannot be optimised.
std::vector<OptimisedCase> optimised_cases(const Plan& plan, const OptimiseOptions& options);

/// The case with a changed motion; none if it is not a valid case then.
std::optional<MovedCase> moved_case(const std::vector<OptimisedCase>& cases, std::size_t of,
                                    const MotionChange& change);

/// The text that identifies a study: its cases and options.
std::string study_text(const Plan& plan, const OptimiseOptions& options);

/// The plan of the cases from which the forms of `needed` are computed, and of those with which the
/// optima are compared.
Plan basis_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<MovedCase>& needed);

/// The results for one case and strength.
struct Optimum {
    double strength = 0.0; // required
    MotionChange change;
    Envelope found;
    Certificate ceiling;
    AmEnvelope am; // with the motion of the job, as eta_unmodulated
    double eta_unmodulated = 0.0;
};

/// The best envelope for a motion, from starts that do not depend on the motion and from `more`.
Envelope best_for(const Forms& forms, double strength, const OptimiseOptions& options,
                  const std::vector<Eigen::VectorXd>& more);

/// Searches for the best envelope, proves the ceiling, and finds the best AM-STM. `forms`, `moved`:
/// with the motion of the job, and as changed. Not collective.
Optimum optimum(const OptimisedCase& c, const Forms& forms, const MotionChange& change,
                const Forms& moved, double strength, const OptimiseOptions& options);

/// The position in OptimisedCase::sm of the best SM-STM; none if none reaches the strength.
using BestSm = std::optional<std::size_t>;

/// An exported waveform of an optimum; none without update_rate_Hz.
std::optional<Waveform> exported(const Knots& knots, const Optimum& optimum,
                                 const OptimiseOptions& options);

/// The cases of one optimum, as they are in the final plan.
struct ResultCases {
    Case unmodulated, found, am;
    std::optional<Case> sm, exported;
};
ResultCases result_cases(const OptimisedCase& c, const MovedCase& moved, const Optimum& optimum,
                         const BestSm& sm, const OptimiseOptions& options);

/// Everything that is known before the cases of the result are computed: [case][strength].
struct Optima {
    std::vector<OptimisedCase> cases;
    std::vector<std::vector<Optimum>> optima;
    std::vector<std::vector<MovedCase>> moved; // of the optima
    std::vector<std::vector<BestSm>> sm;
    ResultCases results(std::size_t i, std::size_t s, const OptimiseOptions& options) const {
        return result_cases(cases[i], moved[i][s], optima[i][s], sm[i][s], options);
    }
};

/// The plan of the output folder: for each case and strength the optimum, the unmodulated load, the
/// best AM-STM and SM-STM, and the exported waveform.
Plan final_plan(const Plan& plan, const Optima& optima, const OptimiseOptions& options);

/// The load of an optimum and the unmodulated load in another tissue or at another speed.
struct RobustCase {
    std::size_t of = 0, strength = 0; // positions of the optimum
    std::string difference;
    Case found, unmodulated;
};
std::vector<RobustCase> robust_cases(const Optima& optima, const OptimiseOptions& options);
Plan robust_plan(const Plan& plan, const Optima& optima, const std::vector<RobustCase>& cases);

/// The forms of a case, and one of its optima with the certificate, as JSON. Numbers are read back
/// exactly. The readers throw UsageError (environment) for a damaged text; `name` is for this
/// message. Not collective.
std::string forms_text(const std::string& id, const Knots& knots, const Forms& forms);
Forms read_forms(const std::string& text, const std::string& name);
/// `forms_id`: of the file with the forms of the motion of the optimum.
std::string optimum_text(const std::string& id, const std::string& forms_id,
                         const Optimum& optimum);
Optimum read_optimum(const std::string& text, const std::string& name);

} // namespace shearwake::optimise
