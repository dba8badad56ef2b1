#pragma once

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/moving_load.hpp"

#include <vector>

namespace shearwake {

/// A node of an element: where strain is taken (elements that meet have each their own).
struct StrainPoint {
    std::size_t element = 0;
    std::ptrdiff_t node = 0;
};

/// Components of a strain or stress plane, engineering shear strains (2 eps). With density varying,
/// the displacement follows.
enum Component {
    xx,
    yy,
    zz,
    yz,
    xz,
    xy,
    strain_components,
    ux = strain_components,
    uy,
    uz,
    all_components
};

/// Between pencils over depth and the planes of strain at chosen points, lines of their spectra,
/// plane [point][component]. With u_x = i (c U - s V), u_y = i (s U + c V),
/// c = kx/k, s = ky/k. Not collective.
class StrainTransfer {
public:
    StrainTransfer(const DepthMesh& mesh, std::vector<StrainPoint> points, int components,
                   const WaveVectors& vectors);

    std::ptrdiff_t planes() const {
        return static_cast<std::ptrdiff_t>(points_.size()) * components_;
    }
    int components() const { return components_; }
    const std::vector<StrainPoint>& points() const { return points_; }

    /// The strain of a pencil, written to the planes' lines of its ky: the first plane's, and the
    /// doubles from one plane to the next.
    void strain(std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* pencil, double* line,
                std::ptrdiff_t stride) const;
    /// Minus the forces that stresses (times their quadrature weights) in those lines exert, times
    /// `scale`, added to a pencil.
    void add_force(std::ptrdiff_t row, std::ptrdiff_t block, const double* line,
                   std::ptrdiff_t stride, double scale, Lanes* pencil) const;

    /// Writes one complex value a wave vector of the block to its line over kx, and reads it.
    static void put(const WaveVectors& vectors, std::ptrdiff_t block, double* line,
                    const Lanes* value);
    static void take(const WaveVectors& vectors, std::ptrdiff_t block, const double* line,
                     Lanes* value);

private:
    struct Direction {
        Lanes k, kx[2], c[2]; // for +kx and -kx
        double ky;
        Lanes s;
    };
    Direction direction(std::ptrdiff_t row, std::ptrdiff_t block) const;

    DepthMesh mesh_;
    std::vector<StrainPoint> points_;
    int components_;
    WaveVectors vectors_;
    std::ptrdiff_t nodes_, levels_;
};

} // namespace shearwake
