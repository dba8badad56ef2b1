// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/study.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "studies/optimise/search/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::optimise {
namespace {

constexpr const char* modulation_key = "optimise.modulation";
constexpr const char* strength_key = "optimise.strength_at_least";
constexpr const char* part_key = "optimise.part";
constexpr std::uint64_t seed = 1; // of the starts

/// Only what the maximised measure and the strength need.
Case without_record(Case c) {
    c.measure.depths_m.resize(1);
    const Vec2 trace = trace_m(c);
    c.record = RecordOptions{};
    c.record.traces_m = {trace};
    c.afferents.reset();
    return c;
}

/// In the periodic regime, the compared modulations must repeat with the period of the case.
void must_repeat(const Case& c, const std::vector<double>& frequencies_Hz, const char* key) {
    if (c.time.regime != Regime::periodic) return;
    for (const double frequency_Hz : frequencies_Hz) {
        const double periods = frequency_Hz * c.time.duration_s();
        if (std::abs(periods - std::round(periods)) > 1e-6)
            throw UsageError(fmt::format("optimise.{}: {:.8g} Hz has no whole number of periods in "
                                         "the period of the load, {:.8g} ms",
                                         key, frequency_Hz, 1e3 * c.time.duration_s()),
                             ExitCode::bad_job);
    }
}

/// An envelope, and with full force or none according to several limits.
std::vector<Eigen::VectorXd> rounded(const Eigen::VectorXd& envelope) {
    std::vector<Eigen::VectorXd> all = {envelope};
    for (const double limit : {0.25, 0.5, 0.75})
        all.emplace_back((envelope.array() > limit).cast<double>().matrix());
    return all;
}

constexpr std::array modulation_names = {"unmodulated", "optimum", "AM-STM", "SM-STM", "exported"};

/// The case with the modulation of this number; null if there is none.
const Case* of_kind(const ResultCases& cases, std::size_t kind) {
    const std::array<const Case*, modulation_names.size()> all = {
        &cases.unmodulated, &cases.found, &cases.am, cases.sm ? &*cases.sm : nullptr,
        cases.exported ? &*cases.exported : nullptr};
    return all.at(kind);
}

/// Adds a case unless the plan contains it.
void add(Plan& plan, const OptimisedCase& of, const Case& physics, std::vector<Setting> more,
         const std::string& reference_id = "") {
    const std::string id = case_id(physics);
    const auto has_id = [&](const PlannedCase& c) { return c.id == id; };
    if (std::ranges::any_of(plan.cases, has_id)) return;
    PlannedCase planned{.id = id,
                        .physics = physics,
                        .settings = of.base.settings,
                        .reference_id = reference_id == id ? "" : reference_id};
    planned.settings.insert(planned.settings.end(), more.begin(), more.end());
    plan.cases.push_back(std::move(planned));
}

} // namespace

std::vector<OptimisedCase> optimised_cases(const Plan& plan, const OptimiseOptions& options) {
    std::vector<OptimisedCase> cases;
    for (const PlannedCase& planned : plan.cases) {
        if (planned.is_reference) continue;
        if (const std::string reason = why_not(planned.physics, options); !reason.empty())
            throw UsageError(fmt::format("case {} cannot be optimised: {}", planned.id, reason),
                             ExitCode::bad_job);
        OptimisedCase c{.base = planned,
                        .knots = knots_of(planned.physics, options.knot_s),
                        .plain = without_record(planned.physics),
                        .sm = {}};
        must_repeat(c.plain, options.am_frequencies_Hz, "am_frequency_Hz");
        must_repeat(c.plain, options.sm_frequencies_Hz, "sm_frequency_Hz");
        c.sm = sm_cases(c.plain, options);
        if (options.update_rate_Hz >
            0.0) // reports a rate that does not fit before all computations
            waveform_of(c.knots, Eigen::VectorXd::Ones(c.knots.count), options.update_rate_Hz,
                        options.bits);
        cases.push_back(std::move(c));
    }
    return cases;
}

std::optional<MovedCase> moved_case(const std::vector<OptimisedCase>& cases, std::size_t of,
                                    const MotionChange& change) {
    const OptimisedCase& c = cases[of];
    if (change == MotionChange{})
        return MovedCase{.of = of,
                         .change = change,
                         .physics = c.base.physics,
                         .id = c.base.id,
                         .knots = c.knots};
    const std::optional<Case> physics = with_motion(c.base.physics, change);
    if (!physics) return std::nullopt;
    Knots knots = c.knots;
    knots.interval_s *= change.size / change.speed;
    return MovedCase{
        .of = of, .change = change, .physics = *physics, .id = case_id(*physics), .knots = knots};
}

std::string study_text(const Plan& plan, const OptimiseOptions& options) {
    const auto numbers = [](const std::vector<double>& values) {
        std::string text;
        for (const double value : values)
            text += (text.empty() ? "" : " ") + exact(value);
        return text;
    };
    std::string text = fmt::format("maximise = {}\nover =", options.maximise);
    for (const OptimisedPart part : options.over)
        text += std::string(" ") + name_in_text(part);
    text += fmt::format("\nfactor = {}\nrounds = {}\nknot_s = {}\nstrengths = {}\nstarts = {}\n",
                        exact(options.factor_at_most), options.rounds, exact(options.knot_s),
                        numbers(options.strengths), options.starts);
    text += fmt::format("search = 2\nam_Hz = {}\nsm_Hz = {}\nsm_m_s = {}\n",
                        numbers(options.am_frequencies_Hz), numbers(options.sm_frequencies_Hz),
                        numbers(options.sm_deviations_m_s));
    if (options.uniformity > 0.0)
        text += fmt::format("uniformity = {}\n", exact(options.uniformity));
    for (const PlannedCase& c : plan.cases)
        text += c.id + "\n";
    return text;
}

Plan basis_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<MovedCase>& needed) {
    Plan basis{.name = plan.name, .title = "Basis of the optimisation of " + plan.title};
    basis.swept_keys = plan.swept_keys;
    basis.swept_keys.emplace_back(part_key);
    const auto part = [](std::string name) {
        return std::vector<Setting>{{part_key, std::move(name)}};
    };
    for (const OptimisedCase& c : cases) {
        add(basis, c, c.plain, part("unmodulated"));
        for (const SmCase& sm : c.sm)
            add(basis, c, sm.physics,
                part(fmt::format("SM-STM {:g} Hz, {:g} m/s, {:g} rad", sm.frequency_Hz,
                                 sm.deviation_m_s, sm.phase_rad)));
    }
    for (const MovedCase& c : needed)
        for (Eigen::Index knot = 0; knot < c.knots.count; ++knot)
            add(basis, cases[c.of], knot_case(c.physics, c.knots, knot),
                part(fmt::format("knot {} of {}", knot, c.id)));
    return basis;
}

Envelope best_for(const Forms& forms, double strength, const OptimiseOptions& options,
                  const std::vector<Eigen::VectorXd>& more) {
    std::vector<Eigen::VectorXd> from =
        starts(forms.knots(), static_cast<std::size_t>(options.starts), seed);
    from.insert(from.end(), more.begin(), more.end());
    return best_envelope(forms, {strength, options.uniformity}, from);
}

Optimum optimum(const OptimisedCase& c, const Forms& forms, const MotionChange& change,
                const Forms& moved, double strength, const OptimiseOptions& options) {
    Optimum result{.strength = strength, .change = change};
    result.am = best_am(forms, c.knots, {strength, options.uniformity},
                        am_frequencies_Hz(c.base.physics, c.knots, options));
    result.ceiling = ceiling(moved, strength);
    std::vector<Eigen::VectorXd> more = rounded(relaxed_envelope(moved, result.ceiling));
    more.push_back(result.am.envelope.values);
    result.found = best_for(moved, strength, options, more);
    if (options.uniformity > 0.0 && !(result.found.eta > 0.0))
        throw UsageError(
            fmt::format("case {}: no envelope was found with a strength of {:g} and "
                        "optimise.uniformity = {:g}; the unmodulated load has a uniformity of "
                        "{:.4g}, so choose a smaller value",
                        c.base.id, strength, options.uniformity,
                        uniformity(rms_along_path(moved, Eigen::VectorXd::Ones(moved.knots())))),
            ExitCode::bad_job);
    result.eta_unmodulated = unmodulated(forms).eta;
    return result;
}

std::optional<Waveform> exported(const Knots& knots, const Optimum& optimum,
                                 const OptimiseOptions& options) {
    if (!(options.update_rate_Hz > 0.0)) return std::nullopt;
    return waveform_of(knots, optimum.found.values, options.update_rate_Hz, options.bits);
}

ResultCases result_cases(const OptimisedCase& c, const MovedCase& moved, const Optimum& optimum,
                         const BestSm& sm, const OptimiseOptions& options) {
    const Case& base = c.base.physics;
    // The unmodulated load as an envelope of ones: with the time samples of the others.
    ResultCases cases{.unmodulated =
                          with_envelope(base, c.knots, Eigen::VectorXd::Ones(c.knots.count)),
                      .found = with_envelope(moved.physics, moved.knots, optimum.found.values),
                      .am = with_envelope(base, c.knots, optimum.am.envelope.values),
                      .sm = std::nullopt,
                      .exported = std::nullopt};
    if (sm)
        cases.sm = with_oscillating_speed(base, c.sm[*sm].frequency_Hz, c.sm[*sm].deviation_m_s,
                                          c.sm[*sm].phase_rad);
    if (const auto waveform = exported(moved.knots, optimum, options)) {
        cases.exported = moved.physics;
        cases.exported->scene.load.modulation.envelope.gains = {gain_of(*waveform)};
    }
    return cases;
}

Plan final_plan(const Plan& plan, const Optima& optima, const OptimiseOptions& options) {
    Plan final{.name = plan.name, .title = plan.title};
    final.swept_keys = plan.swept_keys;
    final.swept_keys.insert(final.swept_keys.end(), {strength_key, modulation_key});
    final.table = {.x = strength_key, .series = plan.swept_keys};
    final.table.series.emplace_back(modulation_key);
    for (std::size_t i = 0; i < optima.cases.size(); ++i) {
        std::vector<ResultCases> results;
        for (std::size_t s = 0; s < optima.optima[i].size(); ++s)
            results.push_back(optima.results(i, s, options));
        const std::string reference = case_id(results.front().unmodulated);
        // Consecutive cases have the same time samples, so that they share transfer functions.
        for (std::size_t kind = 0; kind < modulation_names.size(); ++kind)
            for (std::size_t s = 0; s < results.size(); ++s)
                if (const Case* physics = of_kind(results[s], kind))
                    add(final, optima.cases[i], *physics,
                        {{strength_key, optima.optima[i][s].strength},
                         {modulation_key, std::string(modulation_names[kind])}},
                        reference);
    }
    return final;
}

std::vector<RobustCase> robust_cases(const Optima& optima, const OptimiseOptions& options) {
    std::vector<RobustCase> cases;
    if (!(options.robust_to > 0.0)) return cases;
    // Consecutive cases have the same tissue, so that they share its transfer functions.
    for (std::size_t i = 0; i < optima.cases.size(); ++i)
        for (const Difference& difference : differences_by(options.robust_to))
            for (std::size_t s = 0; s < optima.optima[i].size(); ++s) {
                if (!options.is_robust_strength(optima.optima[i][s].strength)) continue;
                const ResultCases results = optima.results(i, s, options);
                const auto found = with_difference(without_record(results.found), difference);
                const auto unmodulated =
                    with_difference(without_record(results.unmodulated), difference);
                if (found && unmodulated)
                    cases.push_back({i, s, difference.name, *found, *unmodulated});
            }
    return cases;
}

Plan robust_plan(const Plan& plan, const Optima& optima, const std::vector<RobustCase>& cases) {
    Plan robust{.name = plan.name, .title = "Robustness of the optima of " + plan.title};
    robust.swept_keys = plan.swept_keys;
    robust.swept_keys.insert(robust.swept_keys.end(),
                             {strength_key, "optimise.difference", modulation_key});
    for (const RobustCase& c : cases) {
        const auto put = [&](const Case& physics, const char* name) {
            add(robust, optima.cases[c.of], physics,
                {{strength_key, optima.optima[c.of][c.strength].strength},
                 {"optimise.difference", c.difference},
                 {modulation_key, std::string(name)}});
        };
        put(c.unmodulated, "unmodulated");
        put(c.found, "optimum");
    }
    return robust;
}

} // namespace shearwake::optimise
