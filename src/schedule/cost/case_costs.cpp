// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/case_costs.hpp"

#include "engines/registry/make_engine.hpp"
#include "pipeline/memory.hpp"
#include "problem/load/motion/trajectory.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake::cost {
namespace {

/// About 2 s in total, at 0.15 s each.
constexpr std::size_t most_chosen = 12;
/// The time after which the choice of a step is given up, as of meshes of 100 elements.
constexpr double most_one_s = 0.75;

double log_distance(double a, double b) {
    return std::abs(std::log((a + 1.0) / (b + 1.0)));
}

/// The seconds of CPU time since `began`: the same cases are estimated on a busy machine.
double used_s(std::clock_t began) {
    return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
}

/// The numbers below `count`, of which the first ones are always spread evenly.
std::vector<std::size_t> spread_order(std::size_t count) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [](std::size_t i) {
        return std::fmod(static_cast<double>(i) * std::numbers::phi, 1.0);
    });
    return order;
}

/// The first case, the ones with most points and with most points times frames, and all others in
/// spread_order().
std::vector<std::size_t> order_of_estimates(const std::vector<const PlannedCase*>& cases) {
    const auto points = [](const PlannedCase* p) {
        return static_cast<double>(p->physics.domain.nx * p->physics.domain.ny);
    };
    const auto work = [&](const PlannedCase* p) {
        return points(p) * static_cast<double>(p->physics.time.frames);
    };
    std::vector<std::size_t> order = spread_order(cases.size());
    const auto to_front = [&](auto largest) {
        const auto number = static_cast<std::size_t>(largest - cases.begin());
        const auto at = std::ranges::find(order, number);
        std::rotate(order.begin(), at, at + 1);
    };
    to_front(std::ranges::max_element(cases, {}, work));
    to_front(std::ranges::max_element(cases, {}, points));
    to_front(cases.begin());
    return order;
}
/// How many of them are always estimated.
constexpr std::size_t least_estimated = 3;

/// Dissimilarity of two cases: the larger, the worse the time step of one case estimates that of
/// the other. The terms are ordered by their influence.
double distance(const Case& a, const Case& b) {
    double far = 0.0;
    if (a.scene.load.carrier != b.scene.load.carrier) far += 1e6;
    if (a.scene.medium != b.scene.medium) far += 1e3;
    if (a.scene.load.footprint != b.scene.load.footprint) far += 1e3;
    if (a.time != b.time) far += 10.0;
    if (a.domain != b.domain) far += 1.0;
    return far +
           log_distance(greatest_envelope_frequency_Hz(a.scene.load.modulation.envelope),
                        greatest_envelope_frequency_Hz(b.scene.load.modulation.envelope)) +
           log_distance(greatest_speed_m_s(a.scene.load.modulation.trajectory),
                        greatest_speed_m_s(b.scene.load.modulation.trajectory));
}

} // namespace

CaseCosts::CaseCosts(const std::vector<const PlannedCase*>& cases, double most_s) {
    std::vector<const PlannedCase*> open;
    for (const PlannedCase* planned : cases) {
        if (is_open(planned->physics)) open.push_back(planned);
    }
    const std::size_t wanted = std::min(most_chosen, open.size());
    const std::clock_t began = std::clock();
    for (const std::size_t i : spread_order(wanted)) {
        if (!chosen_.empty() && used_s(began) > most_s) break;
        const PlannedCase& planned = *open[wanted == 1 ? 0 : i * (open.size() - 1) / (wanted - 1)];
        const Case& c = planned.physics;
        try {
            chosen_.push_back({&c, engine_of(c).step_chooser(c)(
                                       engines::ChoiceLimit(std::max(most_one_s, most_s)))});
        } catch (const engines::StepNotChosen&) {
            break;
        }
    }
}

std::size_t CaseCosts::limit_resources(const std::vector<const PlannedCase*>& cases, double most_s,
                                       int ranks) {
    const std::clock_t began = std::clock();
    std::vector<bool> is_computed(cases.size(), false);
    std::size_t count = 0;
    for (const std::size_t i : order_of_estimates(cases)) {
        if (count++ >= least_estimated && used_s(began) > most_s) break;
        resources(cases[i]->physics, ranks);
        is_computed[i] = true;
    }
    const Case* before = nullptr;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& c = cases[i]->physics;
        if (is_computed[i])
            before = &c;
        else
            neighbour_[&c] = before;
    }
    return cases.size() - neighbour_.size();
}

engines::Engine& CaseCosts::engine_of(const Case& c) const {
    auto& engine = engines_[c.solver.index()];
    if (!engine) engine = engines::make_engine(c.solver);
    return *engine;
}

bool CaseCosts::is_open(const Case& c) const {
    return engine_of(c).step_chooser(c) != nullptr;
}

bool CaseCosts::is_step_chosen(const Case& c) const {
    return !is_open(c) ||
           std::ranges::any_of(chosen_, [&](const ChosenStep& p) { return p.c == &c; });
}

Case CaseCosts::with_step(const Case& c) const {
    if (!is_open(c)) return c;
    const auto nearest = std::ranges::min_element(
        chosen_, {}, [&](const ChosenStep& step) { return distance(*step.c, c); });
    Case given = c;
    std::visit(
        [&](auto& options) {
            if constexpr (requires { options.time_step_s; })
                options.time_step_s =
                    nearest == chosen_.end() ? c.time.interval_s : nearest->step_s;
        },
        given.solver);
    return given;
}

const engines::Resources& CaseCosts::resources(const Case& given, int ranks) {
    const auto other = neighbour_.find(&given);
    const Case& c = other == neighbour_.end() ? given : *other->second;
    const auto known = known_.find({&c, ranks});
    if (known != known_.end()) return known->second;
    return known_[{&c, ranks}] = pipeline::plan_case(with_step(c), ranks, engine_of(c)).needs;
}

} // namespace shearwake::cost

namespace shearwake::schedule {
namespace {

namespace fs = std::filesystem;

/// The existing folder in which `path` is, or will be.
fs::path existing_parent(const fs::path& path) {
    std::error_code ignored;
    fs::path at = fs::absolute(path, ignored);
    while (!fs::exists(at, ignored) && at.has_relative_path())
        at = at.parent_path();
    return at;
}

} // namespace

Demand least_demand(const std::vector<const PlannedCase*>& cases, int ranks) {
    constexpr double most_s = 0.25;
    Demand demand;
    cost::CaseCosts costs({}, 0.0); // without time steps
    costs.limit_resources(cases, most_s, ranks);
    for (const PlannedCase* planned : cases) {
        const engines::Resources& needs = costs.resources(planned->physics, ranks);
        demand.memory_per_rank_B = std::max(demand.memory_per_rank_B, needs.memory_per_rank_B());
        demand.disk_B += needs.written_B;
    }
    return demand;
}

std::string excess(const Demand& demand, double memory_per_rank_B, const fs::path& out,
                   std::string_view remedy) {
    if (demand.memory_per_rank_B > memory_per_rank_B)
        return fmt::format("the largest case needs {:.0f} MB per rank, and a rank may use "
                           "{:.0f} MB: increase domain.spacing_mm, decrease domain.extent_mm, use "
                           "more ranks, or {}",
                           demand.memory_per_rank_B / 1e6, memory_per_rank_B / 1e6, remedy);
    const fs::path disk = existing_parent(out);
    const double free_B = storage::free_bytes(disk);
    if (demand.disk_B > free_B)
        return fmt::format("the files of the cases need {:.0f} MB, and the disk with {} has "
                           "{:.0f} MB left: record less ([record]), free disk space, or {}",
                           demand.disk_B / 1e6, disk.string(), free_B / 1e6, remedy);
    return "";
}

} // namespace shearwake::schedule
