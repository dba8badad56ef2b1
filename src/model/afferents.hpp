#pragma once

#include "base/vec2.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// Mechanoreceptors: slowly adapting (Merkel), rapidly adapting (Meissner), Pacinian.
enum class AfferentClass { SA1, RA, PC };
inline constexpr std::array all_classes = {AfferentClass::SA1, AfferentClass::RA,
                                           AfferentClass::PC};
/// "SA1" ..., and the class of such a name if it is one.
std::string name_of(AfferentClass kind);
std::optional<AfferentClass> class_named(const std::string& name);
/// Depth of the receptors of a class below the surface: 0.3, 1.6 and 2 mm.
double receptor_depth_m(AfferentClass kind);
/// How many neurons were fitted to fibres of the class.
std::size_t neuron_count(AfferentClass kind);

/// A nerve fibre: where it ends in the skin, what it is, and which of the fitted neurons it has.
struct ListedAfferent {
    Vec2 at_m;
    AfferentClass kind = AfferentClass::PC;
    std::size_t row = 0;
    bool operator==(const ListedAfferent&) const = default;
};

/// Fibres of a part of the hand, as dense as they are there.
struct HandAfferents {
    std::string part = "palm"; // "palm", "fingertip", "hand"
    int digit = 2;             // of a fingertip; 1: thumb
    bool operator==(const HandAfferents&) const = default;
};
/// One of each class at the points of a grid about the middle of the patch.
struct GridAfferents {
    Vec2 extent_m;
    double pitch_m = 0.0;
    bool operator==(const GridAfferents&) const = default;
};
/// Given one by one, in the patch's coordinates.
struct AfferentList {
    std::vector<ListedAfferent> all;
    bool operator==(const AfferentList&) const = default;
};
using AfferentPlaces = std::variant<HandAfferents, GridAfferents, AfferentList>;

/// The simulated motion of the surface at the pins is theirs.
struct PinInput {
    bool operator==(const PinInput&) const = default;
};
/// The stress that the engine computes at each receptor is what it feels.
struct StressInput {
    bool operator==(const StressInput&) const = default;
};
/// Fewest samples of a carrier's cycle: with fewer, harmonics of what is rectified or squared fall
/// onto what is slow, and a carrier at a multiple of the sampling rate onto nothing or onto its
/// bare envelope.
inline constexpr double fewest_samples_a_cycle = 5.0;
enum class CarrierWave { signed_, rectified, squared };
/// Pins move as prescribed, at amplitude A, c = sin(2 pi f t) and m = 1 - depth/2 (1 + cos 2 pi
/// f_am t): A m c, A max(m c, 0) or A (m c)^2.
struct CarrierInput {
    CarrierWave wave = CarrierWave::squared;
    double frequency_Hz = 40e3;
    double amplitude_m = 0.0;
    double sampling_Hz = 200e3;
    double am_frequency_Hz = 0.0;
    double am_depth = 0.0;
    bool operator==(const CarrierInput&) const = default;
};
using AfferentInput = std::variant<PinInput, StressInput, CarrierInput>;

/// How waves travel: on a sheet without end, or within the outline of the hand.
enum class SkinSheet { flat, hand };
enum class Switch { off, on };

/// Which nerve fibres feel the motion of the patch of skin that is simulated.
struct AfferentOptions {
    AfferentPlaces places;
    std::vector<AfferentClass> classes = {all_classes.begin(), all_classes.end()};
    std::uint64_t seed = 1;
    std::optional<Vec2> patch_m; // its middle on the hand; none: that of the part of the hand
    double patch_rad = 0.0;      // how it is turned there
    SkinSheet sheet = SkinSheet::hand;
    AfferentInput input;
    std::vector<Vec2> pins_m = {{}}; // on the patch
    double pin_radius_m = 1e-3;
    double silence_s = 20e-3; // before and after the motion
    Switch noise = Switch::off;
    Switch conduction_delay = Switch::off;
    bool operator==(const AfferentOptions&) const = default;
};

} // namespace shearwake
