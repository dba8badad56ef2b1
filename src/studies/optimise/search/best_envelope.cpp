// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/search.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#if SHEARWAKE_NLOPT
#include <nlopt.h>
#endif

namespace shearwake::optimise {
namespace {

struct Search {
    const Forms& forms;
    Required required;
    double rms_m; // unit of the rms along the path
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
    return search.required.strength * search.required.strength - squared_strength(search.forms, e);
}

/// For each point of the path, at most 0 where its rms suffices for the uniformity.
void path_constraints(unsigned points, double* results, unsigned count, const double* values,
                      double* gradient, void* data) {
    const auto& search = *static_cast<const Search*>(data);
    // Rounding in the search must not violate the exact constraint.
    const double uniformity = std::min(1.0, search.required.uniformity * (1.0 + 1e-9));
    const Eigen::VectorXd e = envelope_of(count, values);
    const Eigen::VectorXd rms = rms_along_path(search.forms, e) / search.rms_m;
    Eigen::Map<Eigen::VectorXd>(results, points) =
        Eigen::VectorXd::Constant(points, uniformity * rms.mean()) - rms;
    if (!gradient) return;
    Eigen::MatrixXd slopes(count, points); // of the rms
    for (Eigen::Index k = 0; k < slopes.cols(); ++k) {
        if (rms(k) > 0.0)
            slopes.col(k) = search.forms.path[static_cast<std::size_t>(k)] * e /
                            (rms(k) * search.rms_m * search.rms_m);
        else
            slopes.col(k).setZero();
    }
    const Eigen::VectorXd of_mean = uniformity * slopes.rowwise().mean();
    Eigen::Map<Eigen::MatrixXd>(gradient, count, points) = (-slopes).colwise() + of_mean;
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
    if (search.required.uniformity > 0.0) {
        const std::vector<double> tolerances(search.forms.path.size(), 1e-10);
        nlopt_add_inequality_mconstraint(solver.get(), static_cast<unsigned>(tolerances.size()),
                                         path_constraints, &search, tolerances.data());
    }
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

/// An envelope on the way to the unmodulated load that satisfies all constraints, near the first
/// one; none if neither that envelope nor the unmodulated load does. eta does not depend on the
/// scale, so the largest value is 1.
std::optional<Eigen::VectorXd> feasible(const Forms& forms, const Required& required,
                                        Eigen::VectorXd e) {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(e.size());
    e = e.cwiseMax(0.0).cwiseMin(1.0);
    e = e.maxCoeff() > 0.0 ? Eigen::VectorXd(e / e.maxCoeff()) : ones;
    if (required.is_met_by(forms, e)) return e;
    // The unmodulated load may miss a strength or uniformity of its own by rounding.
    const Required nearly{required.strength * (1.0 - 1e-12), required.uniformity * (1.0 - 1e-12)};
    if (!nearly.is_met_by(forms, ones)) return std::nullopt;
    const auto mixed = [&](double share) -> Eigen::VectorXd { return e + share * (ones - e); };
    double low = 0.0, high = 1.0;
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (required.is_met_by(forms, mixed(middle)) ? high : low) = middle;
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

bool Required::is_met_by(const Forms& forms, const Eigen::VectorXd& envelope) const {
    if (squared_strength(forms, envelope) < strength * strength) return false;
    return !(uniformity > 0.0) ||
           optimise::uniformity(rms_along_path(forms, envelope)) >= uniformity;
}

Envelope best_from(const Forms& forms, const Required& required, const Eigen::VectorXd& start) {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(start.size());
    Search search{forms, required, 1.0};
    if (required.uniformity > 0.0) search.rms_m = rms_along_path(forms, ones).mean();
    Envelope best{.values = ones};
    if (squared_strength(forms, ones) < required.strength * required.strength * (1.0 - 1e-12))
        return best; // no other envelope of this motion is as strong
    const auto store_if_better = [&](const std::optional<Eigen::VectorXd>& e) {
        if (!e) return;
        if (Envelope found = measured(forms, *e); found.eta > best.eta) best = std::move(found);
    };
    const std::optional<Eigen::VectorXd> first = feasible(forms, required, start);
    store_if_better(first);
    Eigen::VectorXd e = first ? *first : start;
    search_from(search, e);
    store_if_better(feasible(forms, required, std::move(e)));
    return best;
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

Envelope best_envelope(const Forms& forms, const Required& required,
                       const std::vector<Eigen::VectorXd>& starts) {
    Envelope best;
    for (const Eigen::VectorXd& start : starts)
        if (Envelope found = best_from(forms, required, start);
            best.values.size() == 0 || found.eta > best.eta)
            best = std::move(found);
    return best;
}

} // namespace shearwake::optimise
