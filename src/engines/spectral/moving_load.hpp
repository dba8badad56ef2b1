#pragma once

#include "engines/spectral/lanes.hpp"
#include "fft/slab_transform.hpp"
#include "model/case.hpp"
#include "model/load_pattern.hpp"

#include <array>
#include <complex>
#include <vector>

namespace shearwake {

/// Weights of the four parts of a block in a sum.
struct Counted {
    Lanes part[parts] = {};
};

/// The wave vectors of a slab's spectrum in blocks of lanes: kx = 0 ... nx/2 - 1 (the Nyquist modes
/// carry nothing) and with it -kx, for each of this rank's ky.
class WaveVectors {
public:
    WaveVectors(const Domain& domain, const SlabShare& share)
        : nx_(domain.nx), ny_(domain.ny), extent_x_m_(domain.extent_x_m()),
          extent_y_m_(domain.extent_y_m()), share_(share) {}
    /// Those of a plane of the same extents with nx x ny points, no more than this one's: the same
    /// blocks and rows, but fewer.
    WaveVectors coarser(std::ptrdiff_t nx, std::ptrdiff_t ny) const;

    std::ptrdiff_t blocks() const { return (nx_ / 2 + lane_count - 1) / lane_count; }
    std::ptrdiff_t rows() const { return share_.ky_count; }
    std::ptrdiff_t pencils() const { return rows() * blocks(); }
    bool is_nyquist(std::ptrdiff_t row) const { return 2 * (share_.ky_start + row) == ny_; }
    bool is_there(std::ptrdiff_t kx) const { return 2 * kx < nx_; }
    double kx_rad_m(std::ptrdiff_t i) const;
    double ky_rad_m(std::ptrdiff_t row) const;
    Lanes kx(std::ptrdiff_t block) const;
    Lanes k(std::ptrdiff_t row, std::ptrdiff_t block) const;
    /// How often each part of a block counts in a sum over the whole plane of wave vectors: twice
    /// for ky > 0, whose conjugates are not kept; not at all where -kx is kx itself.
    Counted counted(std::ptrdiff_t row, std::ptrdiff_t block) const;
    double largest_k_rad_m() const;
    /// Zeroes the modes that carry nothing in a plane of spectra.
    void clear_nyquist(double* plane) const;
    const SlabShare& share() const { return share_; }
    std::ptrdiff_t nx() const { return nx_; }
    std::ptrdiff_t ny() const { return ny_; }

private:
    std::ptrdiff_t nx_, ny_;
    double extent_x_m_, extent_y_m_;
    SlabShare share_;
};

/// The moving footprint at the wave vectors, with its own fourth-order correction in time,
/// f + (dt^2/12) f''. At the start the samples lie on one side, and (dt/3) f' belongs to it as
/// well, since u(dt) is half of the first difference.
class MovingLoad {
public:
    MovingLoad(const Case& c, const WaveVectors& vectors, double step_s);
    /// From now on the load of step n.
    void sample(std::ptrdiff_t n);
    /// Written to `surface`: the four parts of the force on W at the surface.
    void put(std::ptrdiff_t row, std::ptrdiff_t block, Lanes* surface) const;

private:
    /// The pattern's spectrum at kx and -kx, re and im: four lanes for each pencil.
    using Shape = AlignedVector<double>;
    struct Sampled {
        std::vector<std::complex<double>> x, y;
        double amplitude_Pa = 0.0;
        std::ptrdiff_t step = -1;
        Shape shape; // empty while the pattern is always the same
    };
    void put_shape(Shape& shape) const;
    void reuse(std::ptrdiff_t first_step);
    void place(Sampled& load, std::ptrdiff_t step);

    const Case& case_;
    WaveVectors vectors_;
    double step_s_;
    LoadPattern pattern_;
    std::array<Sampled, 3> loads_;
    Shape shape_; // of a pattern that is always the same
};

} // namespace shearwake
