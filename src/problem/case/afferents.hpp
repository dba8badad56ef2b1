// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// Classes of mechanoreceptors. A further class has an enumerator, a row of receptor_classes, and
/// its neurons in neural/fibre/fibre.cpp.
enum class AfferentClass { SA1, RA, PC };

struct ReceptorClass {
    AfferentClass kind;
    const char* name;
    const char* label;
    const char* colour;        // in figures
    const char* colour_on_map; // in front of the colour map of the displacement
    double depth_m;            // of the receptors below the surface
    std::size_t neurons;       // fitted to recorded fibres of the class
    bool feels_static;         // responds to a stress that does not change
    double palm_per_cm2, finger_per_cm2, tip_per_cm2; // density of the fibres (neural/hand)
};
/// In the order of the enumerators and of the depths.
inline constexpr std::array receptor_classes = {
    ReceptorClass{AfferentClass::SA1, "SA1", "slowly adapting (Merkel)", "#009E73", "#009E73",
                  0.3e-3, 4, true, 10.0, 30.0, 70.0},
    ReceptorClass{AfferentClass::RA, "RA", "rapidly adapting (Meissner)", "#0072B2", "#E69F00",
                  1.6e-3, 9, false, 25.0, 40.0, 140.0},
    ReceptorClass{AfferentClass::PC, "PC", "Pacinian", "#D55E00", "#CC79A7", 2e-3, 4, false, 10.0,
                  10.0, 25.0}};

constexpr const ReceptorClass& properties(AfferentClass kind) {
    return receptor_classes[static_cast<std::size_t>(kind)];
}

/// A member of every row of the table.
template <class Member>
constexpr auto of_each_class(Member ReceptorClass::*member) {
    std::array<Member, receptor_classes.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = receptor_classes[i].*member;
    return all;
}
inline constexpr auto all_classes = of_each_class(&ReceptorClass::kind);
constexpr auto names_of(std::type_identity<AfferentClass>) {
    return of_each_class(&ReceptorClass::name);
}
/// "SA1" etc., and the class with such a name, if any.
inline std::string name_of(AfferentClass kind) {
    return name_in_text(kind);
}
inline std::optional<AfferentClass> class_named(const std::string& name) {
    for (const AfferentClass kind : all_classes)
        if (name_of(kind) == name) return kind;
    return std::nullopt;
}

/// "SA1: #009E73, RA: #0072B2, ...".
std::string class_colours();

/// A nerve fibre: the position of its receptor, its class, and the index of its fitted neuron.
struct ListedAfferent {
    Vec2 at_m;
    AfferentClass kind = AfferentClass::PC;
    std::size_t row = 0;
    bool operator==(const ListedAfferent&) const = default;
};

/// Fibres of a part of the hand at the published densities.
struct HandAfferents {
    static constexpr const char* name_in_jobs = "fingertip";
    std::string part = "palm"; // "palm", "fingertip", "hand"
    int digit = 2;             // digit of a fingertip; 1: thumb
    bool operator==(const HandAfferents&) const = default;
};

template <class Walk, Is<HandAfferents> Places>
void walk_fields(Walk& walk, Places& places) {
    walk(places.part, {.text = "where"});
    walk(places.digit, {.key = "digit",
                        .range = Range::between(1.0, 5.0),
                        .applies = places.part == "fingertip",
                        .only_with = "where = \"fingertip\"",
                        .meaning = "number of the digit; 1 is the thumb"});
}
/// One of each class at the points of a grid centred on the patch.
struct GridAfferents {
    static constexpr const char* name = "grid";
    Vec2 extent_m;
    double pitch_m = 0.0;
    bool operator==(const GridAfferents&) const = default;
};

template <class Walk, Is<GridAfferents> Places>
void walk_fields(Walk& walk, Places& grid) {
    walk(grid.extent_m, {.key = "extent_mm",
                         .range = Range::between(0.0, 1e4),
                         .given = Given::required,
                         .meaning = "size of a grid centred in the domain"});
    walk(grid.pitch_m, {.key = "pitch_mm",
                        .range = Range::between(1e-3, 1e4),
                        .given = Given::required,
                        .meaning = "spacing of the grid"});
}
/// A list of fibres, in the coordinates of the patch.
struct AfferentList {
    static constexpr const char* name_in_jobs = "csv";
    static constexpr const char* name = "list";
    std::vector<ListedAfferent> all;
    bool operator==(const AfferentList&) const = default;
};
/// The meaning of its file, with the numbers of neurons of the classes.
const char* meaning_of_afferent_file();

template <class Walk, Is<AfferentList> Places>
void walk_fields(Walk& walk, Places& list) {
    walk(list.all, {.key = "file",
                    .given = Given::by_hand,
                    .fallback = "required with where = \"csv\"",
                    .meaning = meaning_of_afferent_file()});
}
using AfferentPlaces = std::variant<HandAfferents, GridAfferents, AfferentList>;

/// Pins move as the simulated surface does at their positions.
struct PinInput {
    static constexpr const char* name = "pins";
    static constexpr bool follows_skin = true, uses_stress = false;
    bool operator==(const PinInput&) const = default;
};
/// The input of each receptor is the stress that the engine computes at its position.
struct StressInput {
    static constexpr const char* name = "stress";
    static constexpr bool follows_skin = false, uses_stress = true;
    bool operator==(const StressInput&) const = default;
};
template <class Walk, Is<PinInput> Input>
void walk_fields(Walk&, Input&) {}
template <class Walk, Is<StressInput> Input>
void walk_fields(Walk&, Input&) {}
/// Minimum number of samples per cycle of the carrier: with fewer, harmonics of the rectified or
/// squared carrier alias to low frequencies, and a carrier at a multiple of the sampling rate
/// aliases to 0 Hz.
inline constexpr double fewest_samples_a_cycle = 5.0;
enum class CarrierWave { signed_, rectified, squared };
constexpr auto names_of(std::type_identity<CarrierWave>) {
    return std::array{"signed", "rectified", "squared"};
}
/// The displacement of the pins is prescribed. With amplitude A, c = sin(2 pi f t) and m = 1 -
/// depth/2 (1 + cos 2 pi f_am t), it is A m c, A max(m c, 0) or A (m c)^2.
struct CarrierInput {
    static constexpr const char* name = "carrier";
    static constexpr bool follows_skin = false, uses_stress = false;
    CarrierWave wave = CarrierWave::squared;
    double frequency_Hz = 40e3;
    double amplitude_m = 0.0;
    double sampling_Hz = 200e3;
    double am_frequency_Hz = 0.0;
    double am_depth = 0.0;
    bool operator==(const CarrierInput&) const = default;
};

template <class Walk, Is<CarrierInput> Input>
void walk_fields(Walk& walk, Input& carrier) {
    walk(carrier.wave,
         {.key = "wave",
          .meaning =
              "how the displacement of the pins follows from the carrier c: c, max(c, 0) or c^2"});
    walk(carrier.frequency_Hz, {.key = "frequency_kHz",
                                .text = "carrier_Hz",
                                .range = Range::between(0.1, 1000.0),
                                .meaning = "frequency of the carrier"});
    walk(carrier.amplitude_m, {.key = "amplitude_um",
                               .range = Range::above(0.0),
                               .given = Given::required,
                               .meaning = "amplitude of the displacement"});
    walk(carrier.sampling_Hz, {.key = "sampling_kHz",
                               .range = Range::between(5.0, 1e5),
                               .fallback = "5 samples per cycle, at least 5 kHz",
                               .meaning = "samples per second"});
    walk(carrier.am_frequency_Hz, {.key = "am_frequency_Hz",
                                   .range = Range::between(0.0, 2000.0),
                                   .meaning = "frequency of the amplitude modulation; 0: none"});
    walk(carrier.am_depth, {.key = "am_depth",
                            .range = Range::between(0.0, 1.0),
                            .fallback = "1",
                            .meaning = "depth of the amplitude modulation"});
}
using AfferentInput = std::variant<PinInput, StressInput, CarrierInput>;
/// Whether pins move as the simulated skin does.
inline bool follows_skin(const AfferentInput& input) {
    return std::visit([](const auto& one) { return one.follows_skin; }, input);
}
/// Whether receptors sense the computed stress instead of the motion of pins.
inline bool uses_stress(const AfferentInput& input) {
    return std::visit([](const auto& one) { return one.uses_stress; }, input);
}

/// Propagation of waves: on an infinite sheet, or within the outline of the hand.
enum class SkinSheet { flat, hand };
constexpr auto names_of(std::type_identity<SkinSheet>) {
    return std::array{"flat", "hand"};
}
enum class Switch { off, on };

/// The nerve fibres that respond to the motion of the simulated patch of skin.
struct AfferentOptions {
    AfferentPlaces places;
    std::vector<AfferentClass> classes = {all_classes.begin(), all_classes.end()};
    std::uint64_t seed = 1;
    std::optional<Vec2>
        patch_m; // position of its centre on the hand; none: centre of the part of the hand
    double patch_rad = 0.0; // its rotation on the hand
    SkinSheet sheet = SkinSheet::hand;
    AfferentInput input;
    std::vector<Vec2> pins_m = {{}}; // on the patch
    double pin_radius_m = 1e-3;
    double silence_s = 20e-3; // before and after the motion
    int periods = 10;         // of the load, in which spikes count in the periodic regime
    Switch noise = Switch::off;
    Switch conduction_delay = Switch::off;
    bool operator==(const AfferentOptions&) const = default;
};

/// The fields of the response, which follow those of the places and of the input.
template <class Walk, Is<AfferentOptions> Options>
void walk_response(Walk& walk, Options& o) {
    walk(o.silence_s, {.key = "silence_ms",
                       .range = Range::between(0.0, 1e4),
                       .meaning = "duration of rest before the motion, and of a smooth return to "
                                  "rest after it; spikes outside the motion are discarded"});
    walk(o.periods,
         {.key = "periods",
          .range = Range::between(1.0, 1e4),
          .in_text = o.periods != AfferentOptions{}.periods,
          .meaning = "with `time.regime = \"periodic\"`: number of periods of the load in "
                     "which spikes count, after [a run-in](../explanation/receptors.md"
                     "#endless-loops)"});
    walk(o.noise, {.key = "noise", .meaning = "noise of the neuron model"});
    walk(o.conduction_delay,
         {.key = "conduction_delay", .meaning = "conduction delays along the nerve"});
}

template <class Walk, Is<AfferentOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.choice(o.places, {.key = "where",
                           .text = "where",
                           .type = "word:palm|fingertip|hand|grid|csv",
                           .fallback = "`\"palm\"`",
                           .meaning = "`\"palm\"`, `\"fingertip\"`, `\"hand\"`: afferents at the "
                                      "published densities; `\"grid\"`: one afferent of each class "
                                      "at each grid point; `\"csv\"`: afferents from a file"});
    walk(o.classes, {.key = "classes",
                     .given = Given::by_hand,
                     .meaning = "classes of afferents; for `\"csv\"`, the file specifies them",
                     .least_count = 1});
    walk(o.seed, {.key = "seed",
                  .range = Range::between(0.0, 1e15),
                  .meaning = "seed of the random positions and neurons"});
    walk(o.patch_m, {.key = "patch_mm",
                     .fallback = "middle of the palm or fingertip",
                     .meaning = "position of the centre of the domain on the hand"});
    walk(o.patch_rad, {.key = "patch_deg",
                       .range = Range::between(-360.0, 360.0),
                       .meaning = "angle by which the domain is rotated on the hand"});
    walk(o.sheet, {.key = "skin",
                   .given = Given::by_hand,
                   .fallback = "`\"hand\"`; `\"flat\"` for `\"grid\"` and `\"csv\"`",
                   .meaning = "propagation of waves: within the outline of the `\"hand\"`, or on "
                              "an infinite `\"flat\"` sheet"});
    walk.choice(o.input,
                {.key = "input",
                 .text = "input",
                 .own_tables = true,
                 .meaning =
                     "`\"pins\"`: the simulated u_z at the pins; `\"stress\"`: the stress that "
                     "the engine computes at each receptor; `\"carrier\"`: pins move as "
                     "prescribed"});
    walk(o.pins_m,
         {.key = "pins_mm",
          .text = "pins_{}_m",
          .given = Given::by_hand,
          .fallback = "at the foci or along the path, one FWHM apart; `[[0, 0]]` for a carrier",
          .meaning = "positions `[[x, y], ...]` of the pins, at most 1000 (see "
                     "[receptors](../explanation/receptors.md)); or `pin_line` or `pin_grid`",
          .least_count = 1,
          .most_count = 1000});
    walk.key({.key = "pin_line",
              .type = "table",
              .fallback = "none",
              .meaning = "instead of `pins_mm`: pins along a line, `{ from_mm, to_mm, count }`"});
    walk.key(
        {.key = "pin_grid",
         .type = "table",
         .fallback = "none",
         .meaning = "instead of `pins_mm`: pins on a grid, `{ extent_mm, pitch_mm, center_mm }`"});
    walk(o.pin_radius_m, {.key = "pin_radius_mm",
                          .range = Range::above(0.0),
                          .meaning = "radius of the pins; if pins overlap, half of their smallest "
                                     "distance is used, with a warning"});
    walk_response(walk, o);
}

} // namespace shearwake
