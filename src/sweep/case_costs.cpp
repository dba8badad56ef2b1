#include "sweep/case_costs.hpp"

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/spectral_estimate.hpp"
#include "engines/spectral/time_step.hpp"
#include "model/trajectory.hpp"
#include "sweep/memory.hpp"
#include "sweep/surface_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake {
namespace {

/// 2 s at 0.15 s each.
constexpr std::size_t most_probes = 12;

const SpectralOptions* probing_options(const Case& c) {
    const auto* options = std::get_if<SpectralOptions>(&c.solver);
    return options && !options->time_step_s ? options : nullptr;
}

double apart(double a, double b) {
    return std::abs(std::log((a + 1.0) / (b + 1.0)));
}

/// How far the time step of one case is a bad guess of the other's.
double distance(const Case& a, const Case& b) {
    double far = 0.0;
    // What decides most stands first.
    if (a.load.carrier != b.load.carrier) far += 1e6;
    if (a.medium != b.medium) far += 1e3;
    if (a.load.footprint != b.load.footprint) far += 1e3;
    if (a.time != b.time) far += 10.0;
    if (a.domain != b.domain) far += 1.0;
    return far +
           apart(greatest_envelope_frequency_Hz(a.load.modulation.envelope),
                 greatest_envelope_frequency_Hz(b.load.modulation.envelope)) +
           apart(greatest_speed_m_s(a.load.modulation.trajectory),
                 greatest_speed_m_s(b.load.modulation.trajectory));
}

double written_B(const Case& c, double levels) {
    const double plane = 8.0 * static_cast<double>(c.domain.nx * c.domain.ny);
    const double depths = static_cast<double>(c.measure.depths_m.size());
    double components = 0.0;
    for (const VolumeField field : c.record.volume_fields)
        components += static_cast<double>(components_of(field).size());
    const double series = 8.0 * static_cast<double>(c.time.frames) *
                          (20.0 * depths + 2.0 * static_cast<double>(c.record.traces_m.size()));
    return plane * (depths * static_cast<double>(SurfaceRecorder::kept_frames(c).size()) +
                    levels * components * static_cast<double>(c.record.volumes_s.size())) +
           series + 6e4;
}

} // namespace

double seconds_on(const CaseCost& cost, int ranks, int teams, const Machine& machine) {
    const int used = std::max(1, std::min(ranks, cost.useful_ranks));
    // The slabs of the fullest rank over the mean.
    const double slabs = cost.useful_ranks;
    const double fullest = std::ceil(slabs / used) * used / slabs;
    const double transpose =
        used == 1 ? 0.0 : used * machine.message_s + cost.plane_B / used / machine.transposed_B_s;
    return cost.compute_s / used * fullest + cost.transposes * transpose + machine.file_s +
           cost.written_B * teams / machine.written_B_s;
}

double shared_seconds_on(const CaseCost& cost, int ranks, const Machine&) {
    return cost.shared_s / std::max(1, std::min(ranks, cost.useful_ranks));
}

CaseCosts::CaseCosts(const std::vector<const PlannedCase*>& cases, Machine machine)
    : machine_(std::move(machine)) {
    std::vector<const Case*> open;
    for (const PlannedCase* planned : cases)
        if (probing_options(planned->physics)) open.push_back(&planned->physics);
    const std::size_t wanted = std::min(most_probes, open.size());
    for (std::size_t i = 0; i < wanted; ++i) {
        const Case& c = *open[wanted == 1 ? 0 : i * (open.size() - 1) / (wanted - 1)];
        probes_.push_back({&c, choose_time_step(c, *probing_options(c)).step_s});
    }
}

bool CaseCosts::is_probed(const Case& c) const {
    return !probing_options(c) ||
           std::ranges::any_of(probes_, [&](const Probe& p) { return p.c == &c; });
}

Case CaseCosts::with_step(const Case& c) const {
    Case given = c;
    if (!probing_options(c) || probes_.empty()) return given;
    const auto nearest =
        std::ranges::min_element(probes_, {}, [&](const Probe& p) { return distance(*p.c, c); });
    std::get<SpectralOptions>(given.solver).time_step_s = nearest->step_s;
    return given;
}

const CaseCost& CaseCosts::of(const Case& c) {
    const auto known = known_.find(&c);
    if (known != known_.end()) return known->second;
    const Case given = with_step(c);
    const Estimate e = make_engine(given.solver)->estimate(given, 1);
    const double frames =
        static_cast<double>(c.time.frames) * static_cast<double>(c.measure.depths_m.size());
    CaseCost cost{.compute_s = e.seconds * machine_.layered_factor,
                  .shared_s = e.shared_seconds * machine_.layered_factor,
                  .transposes = frames,
                  .plane_B = 16.0 * static_cast<double>(c.domain.nx * (c.domain.ny / 2 + 1)),
                  .written_B = written_B(c, 0.0),
                  .useful_ranks = e.useful_ranks};
    if (const auto* options = std::get_if<SpectralOptions>(&given.solver)) {
        const TimeStep time = choose_time_step(given, *options);
        const DepthMesh mesh = choose_mesh(given, *options, time.step_s);
        const VariationEstimate v = estimate_variation(given, mesh, time.step_s, 1);
        const double steps = static_cast<double>(c.time.frames * time.per_frame);
        const double passes = v.iterations > 0.0 ? v.iterations + 2.0 : 1.0;
        cost.compute_s = e.seconds * machine_.spectral_factor;
        cost.transposes += 2.0 * v.points * v.components * passes * steps;
        cost.written_B = written_B(c, static_cast<double>(mesh.levels()));
    }
    if (e.all_to_alls > 0.0) {
        cost.compute_s = e.seconds * machine_.spectral_factor; // it steps, too
        cost.transposes = e.all_to_alls;
        cost.plane_B = e.all_to_all_B;
    }
    return known_[&c] = cost;
}

double CaseCosts::memory_per_rank_B(const Case& c, int ranks) {
    const auto known = memory_B_.find({&c, ranks});
    if (known != memory_B_.end()) return known->second;
    return memory_B_[{&c, ranks}] = memory_needed_B(with_step(c), ranks);
}

} // namespace shearwake
