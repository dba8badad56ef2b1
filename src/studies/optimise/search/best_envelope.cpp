// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/best_envelope.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#if SHEARWAKE_NLOPT
#include <nlopt.h>
#endif

namespace shearwake::optimise {
namespace {

struct Search {
    const Forms& forms;
    double squared_strength;
};

#if SHEARWAKE_NLOPT
constexpr int most_evaluations = 1000; // of one local search; usually 100 suffice

Eigen::VectorXd envelope_of(unsigned count, const double* values) {
    return Eigen::Map<const Eigen::VectorXd>(values, static_cast<Eigen::Index>(count));
}

void store(const Eigen::VectorXd& gradient, double* out) {
    if (out) std::copy(gradient.begin(), gradient.end(), out);
}

double objective(unsigned count, const double* values, double* gradient, void* data) {
    const auto& search = *static_cast<const Search*>(data);
    const Eigen::VectorXd e = envelope_of(count, values);
    if (!(e.dot(search.forms.denominator * e) > 0.0)) { // a load that is never on
        store(Eigen::VectorXd::Zero(e.size()), gradient);
        return 0.0;
    }
    store(eta_gradient(search.forms, e), gradient);
    return eta(search.forms, e);
}

/// At most 0 where the strength suffices.
double constraint(unsigned count, const double* values, double* gradient, void* data) {
    const auto& search = *static_cast<const Search*>(data);
    const Eigen::VectorXd e = envelope_of(count, values);
    store(-squared_strength_gradient(search.forms, e), gradient);
    return search.squared_strength - squared_strength(search.forms, e);
}

/// Improves the values. A negative code of the solver means that rounding ended the search; the
/// values are the best so far.
void search_from(Search& search, Eigen::VectorXd& e) {
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> solver(
        nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(e.size())), nlopt_destroy);
    nlopt_set_lower_bounds1(solver.get(), 0.0);
    nlopt_set_upper_bounds1(solver.get(), 1.0);
    nlopt_set_max_objective(solver.get(), objective, &search);
    nlopt_add_inequality_constraint(solver.get(), constraint, &search, 1e-10);
    nlopt_set_ftol_rel(solver.get(), 1e-9);
    nlopt_set_maxeval(solver.get(), most_evaluations);
    double reached = 0.0;
    nlopt_optimize(solver.get(), e.data(), &reached);
}
#else
void search_from(Search&, Eigen::VectorXd&) {
    throw Error("built without NLopt");
}
#endif

/// The nearest envelope on the way to the unmodulated load that satisfies all constraints, if that
/// load does. eta does not depend on the scale, so the largest value is 1.
Eigen::VectorXd feasible(const Forms& forms, double squared, Eigen::VectorXd e) {
    Eigen::VectorXd ones = Eigen::VectorXd::Ones(e.size());
    e = e.cwiseMax(0.0).cwiseMin(1.0);
    if (!(e.maxCoeff() > 0.0)) return ones;
    e /= e.maxCoeff();
    const auto mixed = [&](double share) -> Eigen::VectorXd { return e + share * (ones - e); };
    if (squared_strength(forms, e) >= squared) return e;
    double low = 0.0, high = 1.0;
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (squared_strength(forms, mixed(middle)) >= squared ? high : low) = middle;
    }
    return mixed(high);
}

template <class Uniform>
Eigen::VectorXd noise(Eigen::Index knots, Uniform& uniform) {
    Eigen::VectorXd e(knots);
    for (double& value : e)
        value = uniform();
    return e;
}

/// Two to a third of the knots' number of periods.
template <class Uniform>
Eigen::VectorXd sine(Eigen::Index knots, Uniform& uniform) {
    const auto count = static_cast<double>(knots);
    const double periods = std::floor(2.0 + uniform() * (count / 6.0)), phase = uniform();
    Eigen::VectorXd e(knots);
    for (Eigen::Index j = 0; j < knots; ++j)
        e(j) = 0.5 - 0.5 * std::cos(two_pi * (periods * static_cast<double>(j) / count + phase));
    return e;
}

/// Full force with one to four pauses, each up to a third of the knots long.
template <class Uniform>
Eigen::VectorXd pauses(Eigen::Index knots, Uniform& uniform) {
    Eigen::VectorXd e = Eigen::VectorXd::Ones(knots);
    const auto below = [&](Eigen::Index end) {
        return static_cast<Eigen::Index>(uniform() * static_cast<double>(end));
    };
    for (Eigen::Index pause = 1 + below(4); pause > 0; --pause) {
        const Eigen::Index first = below(knots),
                           length = 1 + below(std::max<Eigen::Index>(1, knots / 3));
        for (Eigen::Index j = 0; j < length; ++j)
            e((first + j) % knots) = 0.0;
    }
    return e;
}

} // namespace

const bool can_search = SHEARWAKE_NLOPT;

Envelope measured(const Forms& forms, Eigen::VectorXd values) {
    Envelope envelope{.values = std::move(values)};
    envelope.eta = eta(forms, envelope.values);
    envelope.strength = std::sqrt(squared_strength(forms, envelope.values));
    return envelope;
}

Envelope unmodulated(const Forms& forms) {
    return measured(forms, Eigen::VectorXd::Ones(forms.knots()));
}

Envelope best_from(const Forms& forms, double strength, const Eigen::VectorXd& start) {
    Search search{forms, strength * strength};
    if (squared_strength(forms, Eigen::VectorXd::Ones(start.size())) <
        search.squared_strength * (1.0 - 1e-12))
        return {.values = Eigen::VectorXd::Ones(start.size())};
    const Envelope first = measured(forms, feasible(forms, search.squared_strength, start));
    Eigen::VectorXd e = first.values;
    search_from(search, e);
    Envelope last = measured(forms, feasible(forms, search.squared_strength, std::move(e)));
    return last.eta > first.eta ? last : first;
}

std::vector<Eigen::VectorXd> starts(Eigen::Index knots, std::size_t count, std::uint64_t seed) {
    std::vector<Eigen::VectorXd> found = {Eigen::VectorXd::Ones(knots)};
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
    while (found.size() < count)
        switch (found.size() % 4) {
        case 0:
            found.push_back(noise(knots, uniform));
            break;
        case 1:
            found.push_back(sine(knots, uniform));
            break;
        default:
            found.push_back(pauses(knots, uniform));
        }
    return found;
}

Envelope best_envelope(const Forms& forms, double strength,
                       const std::vector<Eigen::VectorXd>& starts) {
    Envelope best;
    for (const Eigen::VectorXd& start : starts)
        if (Envelope found = best_from(forms, strength, start);
            best.values.size() == 0 || found.eta > best.eta)
            best = std::move(found);
    return best;
}

} // namespace shearwake::optimise
