// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/afferent_result.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "measures/measure_table.hpp"
#include "neural/skin/stimulus.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace shearwake::pipeline {

namespace {

using neural::Scene;
using neural::SpikeTimes;

/// The duration of the motion or stress without its repetitions.
double cycle_duration_s(const ReceptorMotion& motion) {
    const auto& lines = motion.compression_Pa.empty() ? motion.pins.u_m : motion.compression_Pa;
    return static_cast<double>(lines.empty() ? 0 : lines.front().size()) / motion.pins.rate_Hz;
}

neural::CountedTime counted_time(const ReceptorMotion& motion) {
    if (!motion.repetitions.is_periodic()) return {};
    const double from_s = static_cast<double>(motion.repetitions.run_in) * cycle_duration_s(motion);
    return {from_s,
            from_s + static_cast<double>(motion.repetitions.counted) * cycle_duration_s(motion)};
}

neural::Course course_of(const ReceptorMotion& motion) {
    return motion.repetitions.is_periodic() ? neural::Course::periodic : neural::Course::once;
}

neural::PinStimulus stimulus_of(const ReceptorMotion& motion, const AfferentOptions& options,
                                const Scene& scene) {
    const PointMotion& pins = motion.pins;
    const double radius_mm = 1e3 * options.pin_radius_m;
    if (const auto* carrier = std::get_if<CarrierInput>(&options.input))
        return neural::carrier_stimulus(*carrier, scene.pins_mm, radius_mm,
                                        static_cast<double>(motion.repetitions.total()) *
                                            cycle_duration_s(motion));
    neural::PinStimulus stimulus{
        .at_mm = scene.pins_mm, .radius_mm = radius_mm, .rate_Hz = pins.rate_Hz};
    stimulus.indentation_mm = neural::Lines(pins.u_m.size(), pins.u_m.front().size());
    for (std::size_t p = 0; p < pins.u_m.size(); ++p)
        std::transform(pins.u_m[p].begin(), pins.u_m[p].end(),
                       stimulus.indentation_mm.line(p).begin(), [](double u) { return 1e3 * u; });
    if (motion.repetitions.is_periodic())
        stimulus.indentation_mm =
            neural::repeated(stimulus.indentation_mm, motion.repetitions.total());
    return stimulus;
}

/// The stress of some afferents, with its repetitions.
neural::Lines stress_of(const ReceptorMotion& motion, std::size_t first, std::size_t count) {
    const auto& all_Pa = motion.compression_Pa;
    neural::Lines lines(count, all_Pa.empty() ? 0 : all_Pa.front().size());
    for (std::size_t i = 0; i < count; ++i)
        std::transform(all_Pa.at(first + i).begin(), all_Pa.at(first + i).end(),
                       lines.line(i).begin(), [](double value_Pa) { return 1e-6 * value_Pa; });
    return neural::repeated(lines, motion.repetitions.total());
}

/// The response to stress of the afferents of this rank. Afferents are processed in groups, since
/// all of their repeated lines would need too much memory.
SpikeTimes response_by_group(const ReceptorMotion& motion, const Scene& scene, std::size_t first,
                             std::size_t count, const AfferentOptions& options, std::uint64_t key) {
    constexpr std::size_t group = 64; // a multiple of eight
    SpikeTimes all_s;
    for (std::size_t begin = first; begin < first + count; begin += group) {
        const std::size_t size = std::min(group, first + count - begin);
        auto times_s = response_to_stress(stress_of(motion, begin, size), motion.pins.rate_Hz,
                                          1e3 * options.pin_radius_m, scene, begin, size, options,
                                          key, counted_time(motion));
        std::ranges::move(times_s, std::back_inserter(all_s));
    }
    return all_s;
}

/// Returns warnings and throws errors, on all ranks alike.
std::vector<std::string> texts_of(const std::vector<Remark>& remarks) {
    std::vector<std::string> texts;
    for (const Remark& remark : remarks) {
        const std::string text = fmt::format("afferents.{}: {}", remark.key, remark.message);
        if (remark.severity == Severity::error) throw CaseFailure(text);
        texts.push_back(text);
    }
    return texts;
}

std::vector<std::string> notes_on(const neural::PinStimulus& stimulus,
                                  const AfferentOptions& options, const Scene& scene,
                                  neural::Course course) {
    std::vector<std::string> notes =
        texts_of(neural::check_stimulus(stimulus, options.silence_s, scene.skin_mm, course));
    if (const auto* carrier = std::get_if<CarrierInput>(&options.input))
        if (carrier->wave == CarrierWave::signed_)
            notes.insert(notes.begin(), "afferents.carrier.wave: a signed carrier has no component "
                                        "below 2.5 kHz, the range to which skin and nerves "
                                        "respond: afferents respond only to its start and end");
    return notes;
}

/// Gathers the spikes of all ranks on rank 0; counts and times are transferred as numbers.
SpikeTimes gathered(const SpikeTimes& mine, const Comm& team) {
    std::vector<double> counts, times_s;
    for (const auto& train : mine) {
        counts.push_back(static_cast<double>(train.size()));
        times_s.insert(times_s.end(), train.begin(), train.end());
    }
    counts = team.gather(counts);
    times_s = team.gather(times_s);
    SpikeTimes all;
    auto next = times_s.begin();
    for (const double count : counts) {
        const auto end = next + static_cast<std::ptrdiff_t>(count);
        all.emplace_back(next, end);
        next = end;
    }
    return all;
}

/// What times of spikes and of pins are relative to.
std::string since(const ReceptorMotion& motion) {
    return motion.repetitions.is_periodic() ? "since the counted periods began"
                                            : "since the load began";
}

/// "0: SA1, 1: RA, 2: PC".
std::string class_numbers() {
    std::string text;
    for (const AfferentClass kind : all_classes)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", static_cast<int>(kind),
                            name_of(kind));
    return text;
}

VariableGroup afferents_group(const ReceptorMotion& motion, const Scene& scene,
                              const SpikeTimes& times_s) {
    std::vector<double> number, x, y, hand_x, hand_y, depth, kind, row, count, spike, time;
    for (std::size_t i = 0; i < scene.afferents.size(); ++i) {
        const neural::Afferent& one = scene.afferents[i];
        const Vec2 at_m = on_patch_m(scene.patch, one.at_mm);
        number.push_back(static_cast<double>(i));
        x.push_back(at_m.x);
        y.push_back(at_m.y);
        hand_x.push_back(1e-3 * one.at_mm.x);
        hand_y.push_back(1e-3 * one.at_mm.y);
        depth.push_back(1e-3 * neural::depth_mm(one.kind));
        kind.push_back(static_cast<double>(one.kind));
        row.push_back(static_cast<double>(one.row));
        count.push_back(static_cast<double>(times_s[i].size()));
        for (const double t_s : times_s[i]) {
            spike.push_back(static_cast<double>(spike.size()));
            time.push_back(t_s);
        }
    }
    const std::vector<std::string> each = {"afferent"};
    VariableGroup group{"afferents", {}};
    group.add("afferent", each, number, "1", "number of the afferent");
    group.add("spike", {"spike"}, spike, "1", "number of the spike, afferent by afferent");
    group.add("x", each, x, "m", "position along x of the simulated patch");
    group.add("y", each, y, "m", "position along y of the simulated patch");
    group.add("hand_x", each, hand_x, "m",
              "position on the hand, from the index finger's pad to the wrist");
    group.add("hand_y", each, hand_y, "m",
              "position on the hand, from the thumb to the little finger");
    group.add("depth", each, depth, "m", "depth of the receptor");
    group.add("class", each, kind, "1", class_numbers());
    group.add_attribute("colours", class_colours());
    group.add("row", each, row, "1", "index of the neuron fitted to this class, from 0");
    group.add("spike_count", each, count, "1", "spikes of the afferent");
    group.add("spike_time", {"spike"}, time, "s",
              fmt::format("time of the spike {}, ascending per afferent", since(motion)));
    return group;
}

VariableGroup pins_group(const ReceptorMotion& motion, const AfferentOptions& options,
                         const Scene& scene) {
    std::vector<double> number, x, y, hand_x, hand_y, time, u;
    for (std::size_t p = 0; p < scene.pins_mm.size(); ++p) {
        const Vec2 at_m = options.pins_m[p];
        number.push_back(static_cast<double>(p));
        x.push_back(at_m.x);
        y.push_back(at_m.y);
        hand_x.push_back(1e-3 * scene.pins_mm[p].x);
        hand_y.push_back(1e-3 * scene.pins_mm[p].y);
    }
    const std::vector<std::string> each = {"pin"};
    VariableGroup group{"pins", {}};
    group.add("pin", each, number, "1", "number of the pin");
    group.add("x", each, x, "m", "position along x of the simulated patch");
    group.add("y", each, y, "m", "position along y of the simulated patch");
    group.add("hand_x", each, hand_x, "m", "position on the hand along its x");
    group.add("hand_y", each, hand_y, "m", "position on the hand along its y");

    if (!follows_skin(options.input)) return group; // a prescribed motion follows from the case
    const std::size_t counted = motion.repetitions.counted;
    for (std::size_t k = 0; k < counted * motion.pins.u_m.front().size(); ++k)
        time.push_back(static_cast<double>(k) / motion.pins.rate_Hz);
    for (const auto& line : motion.pins.u_m)
        for (std::size_t repetition = 0; repetition < counted; ++repetition)
            u.insert(u.end(), line.begin(), line.end());
    group.add("time", {"time"}, time, "s", "time " + since(motion));
    group.add("u_z", {"pin", "time"}, u, "m",
              "normal displacement of the pin, positive into the tissue");
    return group;
}

/// The corners of the outline of the hand on which the afferents are.
VariableGroup hand_group(const Scene& scene) {
    std::vector<double> number, x, y;
    for (const Vec2 corner_mm : scene.hand.outline_mm) {
        number.push_back(static_cast<double>(number.size()));
        x.push_back(1e-3 * corner_mm.x);
        y.push_back(1e-3 * corner_mm.y);
    }
    VariableGroup group{"hand", {}};
    group.add("corner", {"corner"}, number, "1", "number of the corner");
    group.add("hand_x", {"corner"}, x, "m", "outline of the hand along its x");
    group.add("hand_y", {"corner"}, y, "m", "outline of the hand along its y");
    return group;
}

/// The reason why phase locking is undefined although there are spikes.
std::string without_locking(const neural::ClassResponse& r, double modulation_Hz,
                            double duration_s) {
    if (!(modulation_Hz > 0.0)) return "there is no modulation";
    return fmt::format(
        "no {} afferent fires {} times; the most active one fires {} in {:.3g} periods",
        name_of(r.kind), neural::fewest_for_locking, counted(r.most_spikes, "time"),
        modulation_Hz * duration_s);
}

/// The columns that state which periods of a periodic motion count.
std::vector<measures::Column> columns_of(const ReceptorMotion& motion) {
    if (!motion.repetitions.is_periodic()) return {};
    return {measures::column_of("receptor_periods_1",
                                static_cast<double>(motion.repetitions.counted), {}),
            measures::column_of("receptor_run_in_periods_1",
                                static_cast<double>(motion.repetitions.run_in), {})};
}

std::vector<measures::Column> columns_of(const ReceptorMotion& motion,
                                         const std::vector<neural::ClassResponse>& classes,
                                         double duration_s) {
    std::vector<measures::Column> columns = columns_of(motion);
    const double modulation_Hz = motion.modulation_Hz;
    const bool has_first = !motion.repetitions.is_periodic();
    for (const neural::ClassResponse& r : classes) {
        const std::string kind = name_of(r.kind);
        const std::string silent = r.spikes > 0 ? "" : "no afferent of this class fires";
        const auto add = [&](const char* name, double value, const std::string& note) {
            measures::Column column =
                measures::column_of(name, value, std::array{measures::Detail{"class", kind}});
            if (std::isnan(value)) column.note = note;
            columns.push_back(std::move(column));
        };
        add("{class}_spikes_1", static_cast<double>(r.spikes), "");
        add("{class}_active_1", static_cast<double>(r.active), "");
        add("{class}_total_rate_Hz", r.total_rate_Hz, "");
        add("{class}_peak_rate_Hz", r.peak_rate_Hz,
            fmt::format("the response lasts {:.4g} ms, less than 50 ms", 1e3 * duration_s));
        add("{class}_near_path_1", motion.near_m > 0.0 ? r.near_share : not_a_number,
            motion.near_m > 0.0 ? silent : "there is no focal radius");
        add("{class}_rate_Hz", r.mean_rate_Hz, silent);
        add("{class}_spread_mm", r.spread_mm, silent);
        add("{class}_vector_strength_1", r.vector_strength,
            !silent.empty()       ? silent
            : modulation_Hz > 0.0 ? "no afferent of this class fires twice"
                                  : "there is no modulation");
        add("{class}_locking_1", r.locking,
            silent.empty() ? without_locking(r, modulation_Hz, duration_s) : silent);
        add("{class}_first_spike_ms", has_first ? r.first_spike_ms : not_a_number,
            has_first ? silent : "the motion has always repeated, so that no spike is the first");
    }
    return columns;
}

} // namespace

neural::Repetitions receptor_repetitions(const Case& c, const Scene& scene) {
    if (c.time.regime != Regime::periodic) return {};
    return neural::repetitions_of(scene.afferents, c.time.duration_s(),
                                  static_cast<std::size_t>(c.afferents->periods));
}

ReceptorMotion receptor_motion(const PlannedCase& planned, const SurfaceRecorder& recorder,
                               const Scene& scene) {
    const Case& c = planned.physics;
    ReceptorMotion motion{.pins = {.at_m = c.afferents->pins_m, .rate_Hz = 1.0 / c.time.interval_s},
                          .near_m = c.measure.focal_radius_m,
                          .modulation_Hz =
                              modulation_frequency_Hz(c.scene.load.modulation).value_or(0.0),
                          .name = planned.id};
    if (const auto* carrier = std::get_if<CarrierInput>(&c.afferents->input)) {
        motion.modulation_Hz = carrier->am_frequency_Hz;
        motion.pins.u_m = {std::vector<double>(static_cast<std::size_t>(c.time.frames))};
    }
    motion.repetitions = receptor_repetitions(c, scene);
    const auto from_rest = [&](const measures::TraceSeries& series) {
        // The first sample is at t = 0: at rest, or in the state at the end of the period.
        std::vector<double> line = {motion.repetitions.is_periodic() ? series.u_m.back() : 0.0};
        line.insert(line.end(), series.u_m.begin(), series.u_m.end() - 1);
        return line;
    };
    for (const measures::TraceSeries& pin : recorder.pins())
        motion.pins.u_m.push_back(from_rest(pin));
    for (const measures::TraceSeries& receptor : recorder.stresses_Pa())
        motion.compression_Pa.push_back(from_rest(receptor));
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        for (const Vec2 place_m : foci(c.scene.load.modulation, c.time.frame_s(n)))
            if (motion.path_m.empty() || !(motion.path_m.back() == place_m))
                motion.path_m.push_back(place_m);
    return motion;
}

void record_receptors(const Case& c, const std::shared_ptr<const Scene>& scene,
                      SurfaceRecorder& recorder) {
    if (stress_depths_m(c).empty()) return;
    std::vector<Vec2> at_m;
    std::vector<std::size_t> depths;
    for (const neural::Afferent& one : scene->afferents) {
        at_m.push_back(on_patch_m(scene->patch, one.at_mm));
        depths.push_back(static_cast<std::size_t>(one.kind)); // classes by their depth
    }
    recorder.record_stress(at_m, std::move(depths));
}

AfferentResult simulate_afferents(const ReceptorMotion& motion, const AfferentOptions& options,
                                  const Scene& scene, const Comm& team) {
    const std::size_t n = scene.afferents.size();
    const auto ranks = static_cast<std::size_t>(team.size()),
               rank = static_cast<std::size_t>(team.rank());
    const std::size_t first = n * rank / ranks, count = n * (rank + 1) / ranks - first;
    const std::uint64_t key = stable_hash(motion.name);
    AfferentResult result;
    SpikeTimes mine_s;
    double duration_s = static_cast<double>(motion.repetitions.counted) * cycle_duration_s(motion);
    if (uses_stress(options.input)) {
        result.notes = texts_of(neural::check_stress(motion.compression_Pa, motion.pins.rate_Hz, n,
                                                     options.silence_s, course_of(motion)));
        mine_s = response_by_group(motion, scene, first, count, options, key);
    } else {
        const neural::PinStimulus stimulus = stimulus_of(motion, options, scene);
        result.notes = notes_on(stimulus, options, scene, course_of(motion));
        if (!motion.repetitions.is_periodic())
            duration_s = static_cast<double>(stimulus.indentation_mm.samples) / stimulus.rate_Hz;
        mine_s =
            response_to_pins(stimulus, scene, first, count, options, key, counted_time(motion));
    }
    const SpikeTimes times_s = gathered(mine_s, team);
    if (!team.is_root()) return result;

    const auto from_path_mm = [&](Vec2 hand_mm) {
        const Vec2 at_m = on_patch_m(scene.patch, hand_mm);
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const Vec2 place_m : motion.path_m)
            nearest_m = std::min(nearest_m, norm(at_m - place_m));
        return 1e3 * nearest_m;
    };
    result.classes =
        neural::class_responses(scene.afferents, times_s, duration_s, motion.modulation_Hz,
                                1e3 * motion.near_m, from_path_mm);
    result.columns = columns_of(motion, result.classes, duration_s);
    result.groups = {afferents_group(motion, scene, times_s), pins_group(motion, options, scene),
                     hand_group(scene)};
    return result;
}

std::vector<Remark> check_afferents(const Case& c) {
    const AfferentOptions& options = *c.afferents;
    const std::shared_ptr<const Scene> receptors = receptors_of(c);
    const Scene& scene = *receptors;
    if (uses_stress(options.input)) { // its pins have no effect
        const auto beyond = std::count_if(
            scene.afferents.begin(), scene.afferents.end(), [&](const neural::Afferent& one) {
                return !c.domain.contains(on_patch_m(scene.patch, one.at_mm));
            });
        if (beyond == 0) return {};
        return {{Severity::warning, "where",
                 fmt::format("{} of {} receptors are outside the domain and do not respond", beyond,
                             scene.afferents.size())}};
    }
    neural::PinStimulus still{
        .at_mm = scene.pins_mm, .radius_mm = 1e3 * options.pin_radius_m, .rate_Hz = 5000.0};
    still.indentation_mm = neural::Lines(scene.pins_mm.size(), 2);
    return neural::check_stimulus(still, options.silence_s, scene.skin_mm);
}

} // namespace shearwake::pipeline
