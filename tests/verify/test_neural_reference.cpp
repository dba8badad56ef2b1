// SPDX-License-Identifier: BSD-3-Clause
// Verifies the neurons against spike trains and intermediate values of TouchSim (Python), without
// noise and delay. SHEARWAKE_NEURAL_REFERENCE specifies the folder of its two files, without which
// these tests are skipped; tests/unit/neural contains the small reference data.
#include "neural/respond.hpp"
#include "neural/skin/skin.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <map>
#include <optional>

namespace test_neural_reference {

using namespace shearwake;
using namespace shearwake::neural;
using shearwake::neural::Line;

static std::optional<h5::Id> reference(const std::string& name) {
    const char* folder = std::getenv("SHEARWAKE_NEURAL_REFERENCE");
    if (!folder || !*folder) return std::nullopt;
    return h5::open_file(std::filesystem::path(folder) / name, h5::Access::read);
}

static Lines lines_of(const h5::Id& file, const std::string& path) {
    storage::NumberBlock block = storage::read_numbers(file.raw(), path);
    Lines lines(block.shape.at(0), block.shape.at(1));
    lines.values = std::move(block.values);
    return lines;
}

static std::vector<double> values_of(const h5::Id& file, const std::string& path) {
    return storage::read_numbers(file.raw(), path).values;
}

static PinStimulus stimulus_of(const h5::Id& file, const std::string& path) {
    PinStimulus stimulus;
    const h5::Id group = h5::open_group(file.raw(), path);
    stimulus.radius_mm = h5::number_attribute(group.raw(), "pin_radius_mm");
    stimulus.rate_Hz = h5::number_attribute(group.raw(), "fs_hz");
    stimulus.indentation_mm = lines_of(file, path + "/trace_mm");
    const Lines at = lines_of(file, path + "/pin_xy_mm");
    for (std::size_t p = 0; p < at.count; ++p)
        stimulus.at_mm.push_back({at.line(p)[0], at.line(p)[1]});
    return stimulus;
}

static std::vector<Afferent> afferents_of(const h5::Id& file) {
    const Lines at = lines_of(file, "aff_xy_mm");
    const auto kinds = values_of(file, "aff_class"), rows = values_of(file, "aff_model");
    std::vector<Afferent> afferents;
    for (std::size_t i = 0; i < at.count; ++i)
        afferents.push_back({.at_mm = {at.line(i)[0], at.line(i)[1]},
                             .kind = all_classes.at(static_cast<std::size_t>(kinds[i])),
                             .row = static_cast<std::size_t>(rows[i])});
    return afferents;
}

static std::vector<Spikes> spikes_of(const h5::Id& file, const std::string& path) {
    const auto counts = values_of(file, path + "/spike_count"),
               samples = values_of(file, path + "/spike_sample");
    std::vector<Spikes> spikes;
    std::size_t at = 0;
    for (const double count : counts) {
        Spikes& train = spikes.emplace_back();
        for (double n = 0; n < count; ++n)
            train.push_back(static_cast<std::uint32_t>(samples[at++]));
    }
    return spikes;
}

/// The difference of each line relative to its largest reference value, maximum over the lines.
static double worst_over_row_maximum(const Lines& ours, const Lines& theirs) {
    REQUIRE(ours.count == theirs.count);
    REQUIRE(ours.samples == theirs.samples);
    double worst = 0.0;
    for (std::size_t i = 0; i < ours.count; ++i) {
        double largest = 0.0, difference = 0.0;
        for (std::size_t k = 0; k < ours.samples; ++k) {
            largest = std::max(largest, std::abs(theirs.line(i)[k]));
            const double off = std::abs(ours.line(i)[k] - theirs.line(i)[k]);
            // Also keeps values that are not a number.
            difference = off <= difference ? difference : off;
        }
        if (difference > 0.0) worst = std::max(worst, difference / largest);
    }
    return worst;
}

/// Applies `of_eight` to groups of eight afferents and returns one line per afferent.
template <class OfEight>
Lines lanes_of(std::span<const Afferent> afferents, std::size_t samples, const OfEight& of_eight) {
    Lines lines(afferents.size(), samples);
    for (std::size_t begin = 0; begin < afferents.size(); begin += lane_count) {
        const auto eight =
            afferents.subspan(begin, std::min<std::size_t>(lane_count, afferents.size() - begin));
        const Line line = of_eight(eight);
        for (std::size_t i = 0; i < eight.size(); ++i)
            for (std::size_t k = 0; k < line.size(); ++k)
                lines.line(begin + i)[k] = line[k][static_cast<std::ptrdiff_t>(i)];
    }
    return lines;
}

// Both programs use double precision; the difference is the rounding of sums and transforms.
constexpr double rounding = 1e-10;

const char* const all_stimuli[] = {"sine200_50um", "sine20_300um",           "sine60_100um",
                                   "ramphold_1mm", "sine200_50um_preindent", "sine200_50um_fs20k"};

TEST_CASE("all stages of all 17 neurons equal TouchSim within 1e-10", "[neural]") {
    const auto file = reference("shared_1_single_afferents.h5");
    if (!file) {
        WARN("skipped: SHEARWAKE_NEURAL_REFERENCE is not set");
        return;
    }
    const std::string name = GENERATE(from_range(std::begin(all_stimuli), std::end(all_stimuli)));
    CAPTURE(name);
    const PinStimulus stimulus = stimulus_of(*file, name);
    const std::vector<Afferent> afferents = afferents_of(*file);
    const Lines loads = loads_N(stimulus);
    CHECK(worst_over_row_maximum(loads, lines_of(*file, name + "/load_N")) < rounding);
    CHECK(worst_over_row_maximum(load_rates_N_s(loads, stimulus.rate_Hz),
                                 lines_of(*file, name + "/loadrate_N_per_s")) < rounding);

    const PinSource source(stimulus);
    const std::vector<Afferent> one_a_class = {
        {{}, AfferentClass::SA1, 0}, {{}, AfferentClass::RA, 0}, {{}, AfferentClass::PC, 0}};
    const auto drive = [&](auto eight) {
        return source.drive(eight, straight_paths(stimulus.at_mm));
    };
    const Lines dynamic = lanes_of(one_a_class, source.samples(),
                                   [&](auto eight) { return drive(eight).dynamic_N_s_mm3; });
    CHECK(worst_over_row_maximum(dynamic, lines_of(*file, name + "/dynamic_5k")) < rounding);

    const Lines stress = lanes_of(std::span(one_a_class).first(1), source.samples(),
                                  [&](auto eight) { return drive(eight).static_MPa; });
    const Lines their_stress = lines_of(*file, name + "/static_5k");
    // Neurons of RA and PC have weight 0 for it, so it is not computed for them; it is scaled from
    // that of SA1.
    Lines scaled(3, stress.samples);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < stress.samples; ++k)
            scaled.line(i)[k] = stress.values[k] *
                                stress_per_load(0.0, depth_mm(all_classes[i]), stimulus.radius_mm) /
                                stress_per_load(0.0, 0.3, stimulus.radius_mm);
    CHECK(worst_over_row_maximum(scaled, their_stress) < rounding);

    const Lines filtered = lanes_of(afferents, source.samples(), [&](auto eight) {
        Line line = drive(eight).dynamic_N_s_mm3;
        low_pass(side_by_side(eight), line);
        return line;
    });
    CHECK(worst_over_row_maximum(filtered, lines_of(*file, name + "/dynamic_filt")) < rounding);
    const auto SA1 = std::span(afferents).first(4);
    const Lines filtered_stress = lanes_of(SA1, source.samples(), [&](auto eight) {
        Line line = drive(eight).static_MPa;
        low_pass(side_by_side(eight), line);
        return line;
    });
    CHECK(worst_over_row_maximum(filtered_stress, lines_of(*file, name + "/static_filt_SA1")) <
          rounding);
    const Lines raw = lanes_of(afferents, source.samples(), [&](auto eight) {
        Drive d = drive(eight);
        const EightNeurons neurons = side_by_side(eight);
        low_pass(neurons, d.static_MPa);
        low_pass(neurons, d.dynamic_N_s_mm3);
        return current(neurons, d.static_MPa, d.dynamic_N_s_mm3);
    });
    CHECK(worst_over_row_maximum(raw, lines_of(*file, name + "/current_raw")) < rounding);
}

TEST_CASE("985 Pacinian afferents of the palm fire at the same samples as in TouchSim",
          "[neural]") {
    const auto file = reference("shared_2_am_carrier_palm.h5");
    if (!file) return;
    const std::string modulation = GENERATE("unmod", "am200");
    const std::string kind = GENERATE("signed", "halfwave", "square", "envelope5k",
                                      "square_pad20ms", "envelope5k_pad20ms");
    const std::string name = modulation + "/" + kind;
    CAPTURE(name);
    const PinStimulus stimulus = stimulus_of(*file, name);
    const std::vector<Afferent> afferents = afferents_of(*file);
    const auto fires_alike = [&](const RespondOptions& options, const std::string& theirs) {
        const auto ours = respond(stimulus, afferents, options);
        const auto expected = spikes_of(*file, name + theirs);
        std::size_t same = 0;
        for (std::size_t i = 0; i < expected.size(); ++i)
            same += ours[i] == expected[i];
        return same;
    };
    CHECK(fires_alike({}, "/flat") == afferents.size());
    // Total numbers of spikes for these traces in the specification of the model.
    const std::map<std::string, std::size_t> expected = {
        {"unmod/signed", 289},     {"am200/signed", 156},       {"unmod/halfwave", 171},
        {"am200/halfwave", 11678}, {"unmod/square", 209},       {"am200/square", 19983},
        {"unmod/envelope5k", 0},   {"am200/envelope5k", 19582}, {"am200/square_pad20ms", 19237}};
    if (expected.contains(name)) {
        std::size_t spikes = 0;
        for (const Spikes& train : respond(stimulus, afferents, {}))
            spikes += train.size();
        CHECK(spikes == expected.at(name));
    }

    const PinSource source(stimulus);
    std::vector<Afferent> near;
    for (const double row : values_of(*file, "near_rows"))
        near.push_back(afferents[static_cast<std::size_t>(row)]);
    const Lines dynamic = lanes_of(near, source.samples(), [&](auto eight) {
        return source.drive(eight, straight_paths(stimulus.at_mm)).dynamic_N_s_mm3;
    });
    CHECK(worst_over_row_maximum(dynamic, lines_of(*file, name + "/flat/near_dynamic_5k")) <
          rounding);

    if (H5Lexists(file->raw(), (name + "/hand").c_str(), H5P_DEFAULT) <= 0) return;
    std::map<std::pair<double, double>, double> ways_mm; // from the single pin
    const auto stored_mm = values_of(*file, "hand_distance_mm");
    for (std::size_t i = 0; i < afferents.size(); ++i)
        ways_mm[{afferents[i].at_mm.x, afferents[i].at_mm.y}] = stored_mm[i];
    const auto along_the_hand = [&](Vec2 to_mm) {
        return std::vector{ways_mm.at({to_mm.x, to_mm.y})};
    };
    CHECK(fires_alike({.paths = along_the_hand}, "/hand") == afferents.size());
}

} // namespace test_neural_reference
