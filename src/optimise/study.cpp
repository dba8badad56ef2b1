// SPDX-License-Identifier: BSD-3-Clause
#include "optimise/study.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::optimise {
namespace {

constexpr const char* modulation_key = "optimise.modulation";
constexpr const char* strength_key = "optimise.strength_at_least";
constexpr const char* part_key = "optimise.part";
constexpr std::uint64_t seed = 1; // of the starts

Case without_record(Case c) {
    c.measure.depths_m.resize(1);
    c.measure.bands.clear();
    c.record = RecordOptions{};
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
        if (const std::string reason = why_not(planned.physics); !reason.empty())
            throw UsageError(fmt::format("case {} cannot be optimised: {}", planned.id, reason),
                             ExitCode::bad_job);
        OptimisedCase c{.base = planned,
                        .knots = knots_of(planned.physics, options.knot_s),
                        .plain = without_record(planned.physics),
                        .sm = {}};
        must_repeat(c.plain, options.am_frequencies_Hz, "am_frequency_Hz");
        must_repeat(c.plain, options.sm_frequencies_Hz, "sm_frequency_Hz");
        c.sm = sm_cases(c.plain, options);
        cases.push_back(std::move(c));
    }
    return cases;
}

std::string study_text(const Plan& plan, const OptimiseOptions& options) {
    std::string text =
        fmt::format("knot_s = {}\nstrengths = {}\nstarts = {}\n", exact(options.knot_s),
                    fmt::join(options.strengths, " "), options.starts);
    text += fmt::format(
        "am_Hz = {}\nsm_Hz = {}\nsm_m_s = {}\nupdate_Hz = {}\nbits = {}\n",
        fmt::join(options.am_frequencies_Hz, " "), fmt::join(options.sm_frequencies_Hz, " "),
        fmt::join(options.sm_deviations_m_s, " "), options.update_rate_Hz, options.bits);
    for (const PlannedCase& c : plan.cases)
        text += c.id + "\n";
    return text;
}

Plan basis_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<bool>& has_forms) {
    Plan basis{.name = plan.name, .title = "Basis of the optimisation of " + plan.title};
    basis.swept_keys = plan.swept_keys;
    basis.swept_keys.emplace_back(part_key);
    const auto part = [](std::string name) {
        return std::vector<Setting>{{part_key, std::move(name)}};
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const OptimisedCase& c = cases[i];
        add(basis, c, c.plain, part("unmodulated"));
        for (const SmCase& sm : c.sm)
            add(basis, c, sm.physics,
                part(fmt::format("SM-STM {:g} Hz, {:g} m/s, {:g} rad", sm.frequency_Hz,
                                 sm.deviation_m_s, sm.phase_rad)));
        if (has_forms[i]) continue;
        for (Eigen::Index knot = 0; knot < c.knots.count; ++knot)
            add(basis, c, knot_case(c.base.physics, c.knots, knot),
                part(fmt::format("knot {}", knot)));
    }
    return basis;
}

Optimum optimum(const OptimisedCase& c, const Forms& forms, double strength,
                const OptimiseOptions& options) {
    Optimum result{.strength = strength};
    result.am =
        best_am(forms, c.knots, strength, am_frequencies_Hz(c.base.physics, c.knots, options));
    std::vector<Eigen::VectorXd> from =
        starts(c.knots.count, static_cast<std::size_t>(options.starts), seed);
    from.push_back(result.am.envelope.values);
    result.found = best_envelope(forms, strength, from);
    result.ceiling = ceiling(forms, strength);
    result.eta_unmodulated = eta(forms, Eigen::VectorXd::Ones(c.knots.count));
    return result;
}

std::optional<Waveform> exported(const OptimisedCase& c, const Optimum& optimum,
                                 const OptimiseOptions& options) {
    if (!(options.update_rate_Hz > 0.0)) return std::nullopt;
    return waveform_of(c.knots, optimum.found.values, options.update_rate_Hz, options.bits);
}

ResultCases result_cases(const OptimisedCase& c, const Optimum& optimum, const BestSm& sm,
                         const OptimiseOptions& options) {
    const Case& base = c.base.physics;
    // The unmodulated load as an envelope of ones: with the time samples of the others.
    ResultCases cases{.unmodulated =
                          with_envelope(base, c.knots, Eigen::VectorXd::Ones(c.knots.count)),
                      .found = with_envelope(base, c.knots, optimum.found.values),
                      .am = with_envelope(base, c.knots, optimum.am.envelope.values),
                      .sm = std::nullopt,
                      .exported = std::nullopt};
    if (sm)
        cases.sm = with_oscillating_speed(base, c.sm[*sm].frequency_Hz, c.sm[*sm].deviation_m_s,
                                          c.sm[*sm].phase_rad);
    if (const auto waveform = exported(c, optimum, options)) {
        cases.exported = base;
        cases.exported->scene().load.modulation.envelope.gains = {gain_of(*waveform)};
    }
    return cases;
}

Plan final_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<std::vector<Optimum>>& optima,
                const std::vector<std::vector<BestSm>>& sm, const OptimiseOptions& options) {
    Plan final{.name = plan.name, .title = plan.title};
    final.swept_keys = plan.swept_keys;
    final.swept_keys.insert(final.swept_keys.end(), {strength_key, modulation_key});
    final.table = {.x = strength_key, .series = plan.swept_keys};
    final.table.series.emplace_back(modulation_key);
    for (std::size_t i = 0; i < cases.size(); ++i)
        for (std::size_t s = 0; s < optima[i].size(); ++s) {
            const Optimum& of = optima[i][s];
            const ResultCases results = result_cases(cases[i], of, sm[i][s], options);
            const std::string reference = case_id(results.unmodulated);
            const auto put = [&](const Case& physics, const char* name) {
                add(final, cases[i], physics,
                    {{strength_key, of.strength}, {modulation_key, std::string(name)}}, reference);
            };
            add(final, cases[i], results.unmodulated,
                {{strength_key, of.strength}, {modulation_key, std::string("unmodulated")}});
            put(results.found, "optimum");
            put(results.am, "AM-STM");
            if (results.sm) put(*results.sm, "SM-STM");
            if (results.exported) put(*results.exported, "exported");
        }
    return final;
}

} // namespace shearwake::optimise
