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

/// One of each class at the points of a grid centred on the patch.
struct GridAfferents {
    static constexpr const char* name = "grid";
    Vec2 extent_m;
    double pitch_m = 0.0;
    bool operator==(const GridAfferents&) const = default;
};

/// A list of fibres, in the coordinates of the patch.
struct AfferentList {
    static constexpr const char* name_in_jobs = "csv";
    static constexpr const char* name = "list";
    std::vector<ListedAfferent> all;
    bool operator==(const AfferentList&) const = default;
};
/// The meaning of its file, with the numbers of neurons of the classes.
const char* meaning_of_afferent_file();

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

} // namespace shearwake
