// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/pencils.hpp"
#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"
#include "problem/load/load_pattern.hpp"

#include <complex>
#include <vector>

namespace shearwake::spectral {

/// Weights of the four parts of a Block, per lane.
struct Counted {
    Block part[parts] = {};
};

/// The wave vectors of a slab's spectrum in blocks of eight: kx = 0 ... nx/2 - 1 together with -kx,
/// for each ky of this rank. The Nyquist modes carry nothing. Not collective.
class WaveVectors {
public:
    WaveVectors(const Domain& domain, const fft::SlabShare& share)
        : nx_(domain.nx), ny_(domain.ny), extent_x_m_(domain.extent_x_m()),
          extent_y_m_(domain.extent_y_m()), share_(share) {}
    /// The wave vectors of a plane of the same extents with nx x ny points, at most as many as
    /// here: a subset of the blocks and rows.
    WaveVectors coarser(std::ptrdiff_t nx, std::ptrdiff_t ny) const;

    std::ptrdiff_t blocks() const { return (nx_ / 2 + lane_count - 1) / lane_count; }
    std::ptrdiff_t rows() const { return share_.ky_count; }
    std::ptrdiff_t pencils() const { return rows() * blocks(); }
    bool is_nyquist(std::ptrdiff_t row) const { return 2 * (share_.ky_start + row) == ny_; }
    bool is_there(std::ptrdiff_t kx) const { return 2 * kx < nx_; }
    double kx_rad_m(std::ptrdiff_t i) const;
    double ky_rad_m(std::ptrdiff_t row) const;
    WaveBlock waves(std::ptrdiff_t row, std::ptrdiff_t block) const;
    /// How often each part of a block occurs in a sum over all wave vectors of the plane: twice for
    /// ky > 0, whose conjugates are not stored, and not at all if -kx equals kx.
    Counted counted(std::ptrdiff_t row, std::ptrdiff_t block) const;
    /// Zeroes the Nyquist modes of a plane of spectra.
    void clear_nyquist(double* plane) const;
    const fft::SlabShare& share() const { return share_; }
    std::ptrdiff_t nx() const { return nx_; }
    std::ptrdiff_t ny() const { return ny_; }

private:
    std::ptrdiff_t nx_, ny_;
    double extent_x_m_, extent_y_m_;
    fft::SlabShare share_;
};

/// The spectrum of the moving footprint, averaged over the steps before and after each time with
/// weights that fall linearly to zero: u+ - 2 u + u- of a free mass is dt^2 times this average of
/// its acceleration. Where the load is smooth, three samples give f + (dt^2/12) f'', which is of
/// fourth order. Near a break (problem/load/load.hpp), for example the end of a path, Gauss nodes
/// between the breaks integrate. At the start the average is one-sided, because u(dt) is half of
/// the first difference. Not collective.
class MovingLoad {
public:
    MovingLoad(const Case& c, const WaveVectors& vectors, double step_s, LoadPattern pattern);
    /// Selects the load of step n.
    void sample(std::ptrdiff_t n);
    /// Writes the four parts of the force on W at the surface to `surface`.
    void put(std::ptrdiff_t row, std::ptrdiff_t block, Block* surface) const;

private:
    /// Spectrum of the pattern at kx and -kx, re and im: four blocks per pencil.
    using Shape = fft::AlignedVector<Block>;
    struct Sampled {
        std::vector<std::complex<double>> x, y;
        double amplitude_Pa = 0.0;
        double updated_s = 0.0; // time of its focus and pattern
        Shape shape;            // empty for a constant pattern
    };
    /// A time [steps] at which the load contributes to a step.
    struct Node {
        double steps, weight;
    };
    void put_shape(Shape& shape) const;
    void place(Sampled& load, double updated_s);
    void find_breaks(std::ptrdiff_t n);
    void choose_nodes(std::ptrdiff_t n);

    const Case& case_;
    const PencilKernels& kernels_;
    WaveVectors vectors_;
    double step_s_;
    LoadPattern pattern_;
    std::vector<Node> nodes_;            // of the selected step
    std::vector<Sampled> loads_, spare_; // at these times
    std::vector<double> breaks_;         // [steps], those near the selected step at least
    std::ptrdiff_t searched_ = 0;        // ranges of steps in which breaks have been searched for
    Shape shape_;                        // of a constant pattern
};

} // namespace shearwake::spectral
