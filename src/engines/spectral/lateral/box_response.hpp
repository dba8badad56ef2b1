// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/symmetric.hpp"
#include "engines/spectral/lateral/lateral_field.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "engines/spectral/lateral/strain_planes.hpp"
#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"

#include <complex>
#include <functional>
#include <optional>

namespace shearwake::spectral {

/// A periodic grid on which the response between cells is the same as on the complete plane: along
/// each axis twice as long as the extent of the cells, or the complete plane.
struct BoxGrid {
    StrainPlanes::Corner corner; // of the cells
    std::ptrdiff_t nx = 0, ny = 0;
};
/// The box of a case whose steps iterate, if there are no rigid bodies, whose response depends on
/// the positions of both cells, and if its matrices are smaller than twice the factors of the
/// implicit operator and save more time during the run than their computation takes. Plan and run
/// call this with the extent by extent_of(), if the cells are within it. Independent of the number
/// of ranks. Not collective.
std::optional<BoxGrid> box_grid(const Case& c, const DepthMesh& mesh, const CellExtent& extent,
                                double step_s);
/// Entries of the factors of the implicit operator at a wave vector. Not collective.
double factor_entries(const DepthMesh& mesh);
/// Number of doubles of the matrices of a box, on all ranks together.
double box_values(const BoxGrid& grid, double planes);

/// G = E B^-1 E^T between the cells of a box. In an infinite or periodic background it depends on
/// the lateral distance of two cells alone, so it is a convolution for each pair of planes of
/// strain. Distances between cells of the box are shorter than half of the period of the grid
/// `BoxGrid`, so that the convolution on this grid is exact. For each of its wave vectors G is a
/// dense real symmetric matrix, once the components with an odd number of lateral indices are
/// divided by i.
class BoxResponse {
public:
    using Values = LateralField::Values;

    /// `slabs` are those of the complete plane. `field` and `slabs` must outlive this
    /// object. Collective.
    BoxResponse(const LateralField& field, const BoxGrid& grid, const fft::SlabTransform& slabs,
                const Comm& team);

    /// Computes the matrices. respond(plane, planes) ends each row of `planes` from `plane` on with
    /// the strain, with the sign of a force, for a unit stress at the first point of the grid in
    /// this plane. Collective.
    using Respond = std::function<void(std::ptrdiff_t plane, StrainPlanes& planes)>;
    void assemble(const Respond& respond);

    double memory_B() const {
        return static_cast<double>(matrices_.size() * sizeof(float)) + planes_.memory_B();
    }

    /// Whether products use the matrices to full precision, or rounded to 24 bits, which takes half
    /// as long.
    enum class Precision { full, rounded };
    /// Applies G to a stress. The result has the sign of a force (minus). Collective.
    void respond(const Values& stress, Values& strain, Precision precision);

private:
    int component(std::ptrdiff_t plane) const {
        return static_cast<int>(plane % field_.variation().components());
    }
    void mirror_row(std::ptrdiff_t plane, std::ptrdiff_t column, std::ptrdiff_t distance_x,
                    const double* near, double* row) const;
    LateralField near_corner(std::ptrdiff_t nx, std::ptrdiff_t ny) const;
    void gather_column(std::ptrdiff_t column, std::ptrdiff_t stride, double* lines);
    void gather_line(std::ptrdiff_t row, std::ptrdiff_t plane, std::ptrdiff_t column,
                     const std::complex<double>* line);
    void multiply(std::ptrdiff_t row, std::ptrdiff_t block, Precision precision);
    /// The first number of the matrices of a pencil.
    float* matrix(std::ptrdiff_t row, std::ptrdiff_t block) {
        return matrices_.data() +
               (row * vectors_.blocks() + block) * matrix_parts * entries_ * lane_count;
    }

    const LateralField& field_;
    const fft::SlabTransform& plane_slabs_;
    Comm team_;
    BoxGrid grid_;
    fft::SlabTransform slabs_;
    WaveVectors vectors_;
    StrainPlanes planes_;
    std::ptrdiff_t count_, entries_; // of planes; of a triangle
    const LineKernels& lines_;
    const SymmetricKernels& kernels_;
    static constexpr std::ptrdiff_t matrix_parts = 2; // of SymmetricArrays
    fft::AlignedVector<float> matrices_;              // [row][block][part][entry][lane]
    fft::AlignedVector<Block> given_, result_;        // [plane][part]
};

} // namespace shearwake::spectral
