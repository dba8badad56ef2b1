// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace shearwake {

/// A grey-scale picture of the radiation pressure to be produced. Shared by the cases of a sweep.
struct TargetImage {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<double> greys; // row by row from the top (largest y), 0: black, 1: white
    std::string content_hash;

    /// The grey value at a point of the picture of this width that is centred on the origin; 0
    /// outside.
    double at(Vec2 at_m, double width_m) const;
};

/// Whether the closed polygon with these corners contains a point (even-odd rule).
bool is_inside(const std::vector<Vec2>& corners, Vec2 at);

/// How the drives of the pistons of an array follow from several foci.
enum class Hologram { superposition, gs, wgs };
constexpr auto names_of(std::type_identity<Hologram>) {
    return std::array{"superposition", "gs", "wgs"};
}

/// The pressure of each source at unit drive at each focus: focus by focus, `sources` values each.
struct Transfers {
    std::size_t sources = 0;
    std::vector<std::complex<double>> values;

    std::size_t foci() const { return sources == 0 ? 0 : values.size() / sources; }
    std::span<const std::complex<double>> focus(std::size_t m) const {
        return {values.data() + m * sources, sources};
    }
};

/// The pressure at each focus.
std::vector<std::complex<double>> pressures_at_foci(const Transfers& transfers,
                                                    std::span<const std::complex<double>> drives);

/// The sum over the foci of the conjugate transfer, normalised to modulus 1: the field at each
/// source of point sources in the foci. Sources may radiate with different amplitudes.
std::vector<std::complex<double>> superposed_drives(const Transfers& transfers);

/// Drives of modulus 1 by the algorithm of Gerchberg and Saxton: the phase of each source is that
/// of the field that point sources in the foci would produce, with the phases of the foci of the
/// previous iteration. The sum of the |pressure| of the foci increases in every iteration. With
/// Hologram::wgs, each focus has a weight that is multiplied in each iteration by the mean
/// |pressure| divided by its own, which equalises the foci (R. Di Leonardo, F. Ianni and G. Ruocco,
/// Optics Express 15, 1913, 2007). Deterministic: the initial phase of focus m is m (m +
/// 1) / 2 golden angles, which is irregular also for foci on a lattice. `hologram` is gs or wgs.
std::vector<std::complex<double>> phased_drives(Hologram hologram, const Transfers& transfers,
                                                int iterations);

} // namespace shearwake
