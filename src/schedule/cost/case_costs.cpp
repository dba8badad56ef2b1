// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/case_costs.hpp"

#include "engines/registry/make_engine.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/memory.hpp"
#include "problem/load/motion/trajectory.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <limits>

namespace shearwake::cost {
namespace {

/// About 2 s in total, at 0.15 s each.
constexpr std::size_t most_probes = 12;

double log_distance(double a, double b) {
    return std::abs(std::log((a + 1.0) / (b + 1.0)));
}

/// Dissimilarity of two cases: the larger, the worse the time step of one case estimates that of
/// the other. The terms are ordered by their influence.
double distance(const Case& a, const Case& b) {
    double far = 0.0;
    if (a.scene().load.carrier != b.scene().load.carrier) far += 1e6;
    if (a.scene().medium != b.scene().medium) far += 1e3;
    if (a.scene().load.footprint != b.scene().load.footprint) far += 1e3;
    if (a.time != b.time) far += 10.0;
    if (a.domain != b.domain) far += 1.0;
    return far +
           log_distance(greatest_envelope_frequency_Hz(a.scene().load.modulation.envelope),
                        greatest_envelope_frequency_Hz(b.scene().load.modulation.envelope)) +
           log_distance(greatest_speed_m_s(a.scene().load.modulation.trajectory),
                        greatest_speed_m_s(b.scene().load.modulation.trajectory));
}

double core_s() {
    return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

} // namespace

double seconds_on(const CaseCost& cost, int ranks, int teams, const Machine& machine) {
    const int used = std::max(1, std::min(ranks, cost.useful_ranks));
    // Ratio of the most slabs per rank to the mean.
    const double slabs = cost.useful_ranks;
    const double fullest = std::ceil(slabs / used) * used / slabs;
    const double transpose =
        used == 1 ? 0.0 : used * machine.message_s + cost.plane_B / used / machine.transposed_B_s;
    return cost.serial_s + cost.compute_s / used * fullest + cost.transposes * transpose +
           machine.file_s + cost.written_B * teams / machine.written_B_s;
}

double shared_seconds_on(const CaseCost& cost, int ranks, const Machine&) {
    return cost.shared_s / std::max(1, std::min(ranks, cost.useful_ranks));
}

CaseCosts::CaseCosts(const std::vector<const PlannedCase*>& cases, Machine machine,
                     const BeforeProbe& before_probe)
    : machine_(std::move(machine)) {
    std::vector<const PlannedCase*> open;
    for (const PlannedCase* planned : cases) {
        cases_.push_back(&planned->physics);
        if (is_open(planned->physics)) open.push_back(planned);
    }
    const std::size_t wanted = std::min(most_probes, open.size());
    for (std::size_t i = 0; i < wanted; ++i) {
        const PlannedCase& planned = *open[wanted == 1 ? 0 : i * (open.size() - 1) / (wanted - 1)];
        if (before_probe) before_probe(planned, i + 1, wanted);
        const Case& c = planned.physics;
        const double began_s = core_s();
        const double step_s = engine_of(c).probed_step_s(c);
        probes_.push_back({&c, step_s, core_s() - began_s});
    }
}

engines::Engine& CaseCosts::engine_of(const Case& c) const {
    auto& engine = engines_[c.solver.index()];
    if (!engine) engine = engines::make_engine(c.solver);
    return *engine;
}

bool CaseCosts::is_open(const Case& c) const {
    return engine_of(c).probes_step(c);
}

bool CaseCosts::is_probed(const Case& c) const {
    return !is_open(c) || std::ranges::any_of(probes_, [&](const Probe& p) { return p.c == &c; });
}

const CaseCosts::Probe& CaseCosts::nearest_probe(const Case& c) const {
    return *std::ranges::min_element(probes_, {},
                                     [&](const Probe& p) { return distance(*p.c, c); });
}

Case CaseCosts::with_step(const Case& c) const {
    if (!is_open(c) || probes_.empty()) return c;
    return engine_of(c).with_step(c, nearest_probe(c).step_s);
}

const CaseCosts::Amounts& CaseCosts::amounts(const Case& c) {
    const auto known = amounts_.find(&c);
    if (known != amounts_.end()) return known->second;
    const Case given = with_step(c);
    const engines::Estimate e = engine_of(c).estimate(given, 1);
    Amounts found{e.work, e.shared, {}};
    const std::vector<engines::Work> receptors = pipeline::receptors_work(c);
    found.work.insert(found.work.end(), receptors.begin(), receptors.end());
    found.cost = {.serial_s = is_open(c) && !probes_.empty() ? nearest_probe(c).took_s : 0.0,
                  .transposes = e.all_to_alls,
                  .plane_B = e.all_to_all_B,
                  .written_B = pipeline::case_file_B(c, e.written_B),
                  .useful_ranks = e.useful_ranks,
                  .kinds = engine_name(c.solver)};
    for (const engines::Work& part : found.work)
        found.cost.kinds += std::string(" ") + part.kind.name;
    return amounts_[&c] = std::move(found);
}

std::vector<engines::Work> CaseCosts::work_of(const Case& c) {
    std::vector<engines::Work> all = amounts(c).work;
    all.insert(all.end(), amounts(c).shared.begin(), amounts(c).shared.end());
    return all;
}

const CaseCost& CaseCosts::of(const Case& c) {
    const auto known = known_.find(&c);
    if (known != known_.end()) return known->second;
    const Amounts& found = amounts(c);
    CaseCost cost = found.cost;
    cost.compute_s = engines::time_s(found.work, machine_.rates);
    cost.shared_s = engines::time_s(found.shared, machine_.rates);
    return known_[&c] = cost;
}

std::set<std::string> CaseCosts::kinds() {
    std::set<std::string> all;
    for (const Case* c : cases_)
        for (const auto* work : {&amounts(*c).work, &amounts(*c).shared})
            for (const engines::Work& part : *work)
                if (part.amount > 0.0) all.insert(part.kind.name);
    return all;
}

void CaseCosts::use(Machine machine) {
    machine_ = std::move(machine);
    known_.clear();
}

double CaseCosts::memory_per_rank_B(const Case& c, int ranks) {
    const auto known = memory_B_.find({&c, ranks});
    if (known != memory_B_.end()) return known->second;
    return memory_B_[{&c, ranks}] = pipeline::memory_needed_B(with_step(c), ranks);
}

} // namespace shearwake::cost

namespace shearwake::schedule {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// The existing folder in which `path` is, or will be.
fs::path existing_parent(const fs::path& path) {
    std::error_code unknown;
    fs::path at = fs::absolute(path, unknown);
    while (!fs::exists(at, unknown) && at.has_relative_path())
        at = at.parent_path();
    return at;
}

} // namespace

Demand least_demand(const std::vector<const PlannedCase*>& cases, int ranks) {
    const auto end = std::chrono::steady_clock::now() + 1s;
    Demand demand;
    for (const PlannedCase* planned : cases) {
        const Case& given = planned->physics;
        const auto engine = engines::make_engine(given.solver);
        const Case c =
            engine->probes_step(given) ? engine->with_step(given, given.time.interval_s) : given;
        demand.memory_per_rank_B =
            std::max(demand.memory_per_rank_B, pipeline::memory_needed_B(c, ranks));
        demand.disk_B += pipeline::case_file_B(c, engine->estimate(c, ranks).written_B);
        if (std::chrono::steady_clock::now() > end) break;
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
