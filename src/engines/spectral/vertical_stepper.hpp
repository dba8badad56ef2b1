#pragma once

#include "engines/spectral/vertical_operator.hpp"
#include "fft/slab_transform.hpp"
#include "model/case.hpp"

#include <array>
#include <complex>
#include <vector>

namespace shearwake {

/// The displacement at this rank's wave vectors over depth, and the step that advances it:
///     [M/dt^2 + a_lambda K_lambda + a_mu K_mu + C/(2 dt)] (u+ - 2u + u-)
///         = f - K u - C (u - u-)/dt,
/// f the load with its own fourth-order correction, f + (dt^2/12) f''. From rest, u(dt) is half of
/// the first difference. Second order in dt for compressional and viscous forces, fourth for shear.
/// Not collective: every wave vector lives on one rank.
class VerticalStepper {
public:
    /// Throws CaseFailure for a medium that the operator does not know.
    VerticalStepper(const Case& c, const DepthMesh& mesh, const SlabShare& share, double step_s);

    /// From t = n dt to (n + 1) dt.
    void advance();

    /// u_z at a depth as rows of the transposed spectrum, ready for SlabTransform::to_physical.
    void plane_of_w(double depth_m, double* plane) const;

private:
    /// The load at one time: its phases over kx >= 0 and over this rank's ky, and its amplitude.
    struct SampledLoad {
        std::vector<std::complex<double>> x, y;
        double amplitude_Pa = 0.0;
    };

    void sample_loads();
    void put_load(std::ptrdiff_t ky, std::ptrdiff_t block, Lanes* force) const;
    bool is_nyquist(std::ptrdiff_t ky) const {
        return 2 * (share_.ky_start + ky) == case_.domain.ny;
    }
    double kx_rad_m(std::ptrdiff_t i) const;
    double ky_rad_m(std::ptrdiff_t local) const;
    Lanes wavenumbers(std::ptrdiff_t ky, std::ptrdiff_t block) const;
    std::ptrdiff_t pencil(std::ptrdiff_t ky, std::ptrdiff_t block) const {
        return ky * blocks_ + block;
    }

    const Case& case_;
    DepthMesh mesh_;
    SlabShare share_;
    double step_s_;
    std::ptrdiff_t step_ = 0;
    VerticalOperator operator_;
    std::ptrdiff_t blocks_, unknowns_;
    std::array<SampledLoad, 3> loads_;
    // Lanes by eights: a vector of a vector type would lose the type's alignment.
    AlignedVector<double> factors_, now_, before_, force_;
};

} // namespace shearwake
