// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/strain_transfer.hpp"
#include "fft/run_transform.hpp"
#include "parallel/comm.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace shearwake::spectral {

/// Range of the grid points of a plane, [begin, end), that contains all cells of some planes.
struct CellExtent {
    std::ptrdiff_t x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;

    bool is_complete(std::ptrdiff_t nx, std::ptrdiff_t ny) const {
        return x_begin == 0 && x_end == nx && y_begin == 0 && y_end == ny;
    }
    /// The range that contains both.
    CellExtent with(const CellExtent& other) const {
        if (x_begin == x_end) return other;
        if (other.x_begin == other.x_end) return *this;
        return {std::min(x_begin, other.x_begin), std::max(x_end, other.x_end),
                std::min(y_begin, other.y_begin), std::max(y_end, other.y_end)};
    }
};
/// That of the cells that overlap the bounds of the bodies and the map; a cell that touches them
/// may differ from the background by rounding. Where these are softer, lighter or less viscous than
/// a layer, they are the background, from which the cells around them differ, so that the complete
/// plane varies. Not collective.
CellExtent extent_of(const Medium& medium, const Domain& domain);

/// The cells of planes at points over depth on this rank's rows, which belong to someone else.
/// Their values are stored as [point][component][cell].
struct PlaneCells {
    struct Point {
        std::vector<fft::RowRun> runs;
        std::size_t first = 0, cells = 0; // number of cells of earlier points, and of this one
    };
    std::span<const Point> points;
    std::size_t components = 0;
    std::ptrdiff_t x_start = 0; // global index of the first row of x of this rank

    /// Range of the indices of a point's values. Not collective.
    std::pair<std::size_t, std::size_t> range(std::size_t point) const {
        return {points[point].first * components,
                (points[point].first + points[point].cells) * components};
    }
    /// Extent of the cells of all ranks. Collective; without a team, that of this rank.
    CellExtent extent(const Comm* team) const;
};

/// The depth range that a node represents: the cell that corresponds to its quadrature weight.
struct DepthCell {
    double centre_m, size_m;
};
/// Not collective.
DepthCell depth_cell(const DepthMesh& mesh, std::size_t element, std::size_t node);

/// Whether all bodies have smooth edges. Sharp bodies are averaged over cells; smooth ones are
/// sampled at points, which converges spectrally.
bool is_smooth(const Medium& medium);

/// Reflected share of the amplitude of a shear wave at normal incidence on a plane interface, from
/// the impedances sqrt(mu rho). Both ratios are those behind the interface over those in front of
/// it.
double shear_reflection(double stiffness_ratio, double density_ratio);

/// The material with which the engine represents an inclusion: its shear stiffness is capped at
/// `contrast_cap` times that of the layer.
class CappedMaterials {
public:
    CappedMaterials(const Case& c, const Material& layer);
    CellMaterial operator()(CellMaterial m) const;

private:
    double most_mu_Pa_;
};

/// The stress of a laminate in addition to that of a uniform material, for the engineering strain
/// times the amount by which its shear modulus across the layers is lower: with w = strain n and
/// its part t along the layers, -2 (n t^T + t n^T). Components as in Component.
std::array<double, 6> stress_across(Vec3 normal, const std::array<double, 6>& scaled_strain);

/// Materials at one strain point for the rows of this rank, [row][ny]. Not collective.
std::vector<CellMaterial> cell_materials(const Case& c, const DepthMesh& mesh,
                                         const fft::SlabShare& share, const StrainPoint& point);
/// Materials at a depth within an element: sampled at this depth for smooth bodies, otherwise those
/// of the node's cell. Not collective.
std::vector<CellMaterial> cell_materials(const Case& c, const DepthMesh& mesh,
                                         const fft::SlabShare& share, std::size_t element,
                                         double depth_m);

} // namespace shearwake::spectral
