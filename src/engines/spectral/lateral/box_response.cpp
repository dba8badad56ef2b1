// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/box_response.hpp"

#include "fft/run_transform.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <array>

namespace shearwake::spectral {
namespace {

/// Time of the transforms and transfers of one plane of strain at a point, relative to that of one
/// entry of a factor or a matrix at a wave vector. Measured.
constexpr double plane_cost = 40.0;

/// Number of lateral indices of a component along x and along y.
struct Indices {
    int x, y;
};
constexpr std::array<Indices, all_components> indices = {
    {{2, 0}, {0, 2}, {0, 0}, {0, 1}, {1, 0}, {1, 1}, {1, 0}, {0, 1}, {0, 0}}};

bool is_odd_x(int component) {
    return indices[static_cast<std::size_t>(component)].x % 2 == 1;
}
bool is_odd_y(int component) {
    return indices[static_cast<std::size_t>(component)].y % 2 == 1;
}
bool is_imaginary(int component) {
    return is_odd_x(component) != is_odd_y(component);
}

Symmetry symmetry_of(int component) {
    return {.imaginary = is_imaginary(component), .odd = is_odd_x(component)};
}

/// Period along one axis, and the first point.
struct Axis {
    std::ptrdiff_t corner, period;
};
Axis axis_of(std::ptrdiff_t begin, std::ptrdiff_t end, std::ptrdiff_t points) {
    const std::ptrdiff_t period = good_even_length(2 * (end - begin));
    // A box that is almost as long as the plane saves nothing.
    if (4 * period > 3 * points) return {0, points};
    return {begin, period};
}

/// Planes of strain if all points vary in the elements that bodies or the map reach.
double most_planes(const Medium& medium, const DepthMesh& mesh) {
    double points = 0.0;
    bool density = false; // whether it differs from that of a layer there
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (!varies_between(medium, mesh.ends_m[e], mesh.ends_m[e + 1])) continue;
        points += mesh.degree + 1.0;
        const double layer = medium.layers[mesh.layers[e]].density_kg_m3;
        const auto differs = [layer](double other) { return other != layer; };
        density |= medium.map && std::ranges::any_of(medium.map->density_kg_m3, differs);
        for (const Body& body : medium.bodies) {
            const Bounds box = bounds(body);
            if (box.low_m.z < mesh.ends_m[e + 1] && box.high_m.z > mesh.ends_m[e])
                density |= differs(body.density_kg_m3.value_or(layer));
        }
    }
    return points * static_cast<double>(density ? all_components : strain_components);
}

} // namespace

double box_values(const BoxGrid& grid, double planes) {
    return 0.25 * static_cast<double>(grid.nx * grid.ny) * 0.5 * planes * (planes + 1.0);
}

double factor_entries(const DepthMesh& mesh) {
    const auto moving = static_cast<std::ptrdiff_t>(mesh.levels() - 1);
    return static_cast<double>(SkylineMatrix(moving, mesh.degree, 2).entries() +
                               SkylineMatrix(moving, mesh.degree, 1).entries());
}

std::optional<BoxGrid> box_grid(const Case& c, const DepthMesh& mesh, const CellExtent& extent,
                                double step_s) {
    const Medium& medium = c.scene.medium;
    if (extent.x_end == extent.x_begin || std::ranges::any_of(medium.bodies, &Body::rigid))
        return {};
    const Domain& domain = c.domain;
    const Axis x = axis_of(extent.x_begin, extent.x_end, domain.nx),
               y = axis_of(extent.y_begin, extent.y_end, domain.ny);
    if (x.period == domain.nx && y.period == domain.ny) return {};
    const BoxGrid grid{.corner = {x.corner, y.corner}, .nx = x.period, .ny = y.period};
    const double box = static_cast<double>(grid.nx * grid.ny),
                 plane = static_cast<double>(domain.nx * domain.ny),
                 planes = most_planes(medium, mesh), factors = factor_entries(mesh);
    const double in_box = box_values(grid, planes) * 4.0 + box * plane_cost * planes;
    const double in_plane = plane * (factors + plane_cost * planes);
    const bool fits = 4.0 * box_values(grid, planes) <= 2.0 * plane * factors;
    // Most steps take at least two iterations. A column of the matrices takes as long as two thirds
    // of an iteration on the plane.
    const double steps = c.time.duration_s() / step_s;
    const bool pays = 2.0 * steps * (in_plane - in_box) > 2.0 / 3.0 * planes * in_plane;
    return fits && pays ? std::optional(grid) : std::nullopt;
}

BoxResponse::BoxResponse(const LateralField& field, const BoxGrid& grid,
                         const fft::SlabTransform& slabs, const Comm& team)
    : field_(field), plane_slabs_(slabs), team_(team), grid_(grid),
      slabs_(grid.nx, grid.ny, team, slabs.planning()),
      vectors_({grid.nx, grid.ny, 1.0, 0.0}, slabs_.share()),
      planes_(field.cells(), slabs_, team, grid.corner), count_(planes_.count()),
      entries_(count_ * (count_ + 1) / 2), lines_(simd::kernels<LineKernels>()),
      kernels_(simd::kernels<SymmetricKernels>()) {
    together(team, [&] {
        planes_.assemble();
        matrices_.assign(
            static_cast<std::size_t>(vectors_.pencils() * matrix_parts * entries_ * lane_count),
            0.0F);
        given_.assign(static_cast<std::size_t>(count_ * parts), Block{});
        result_ = given_;
    });
}

/// A field like `of` whose cells are this rank's part of the points [0, nx) x [0, ny) at all points
/// over depth.
LateralField BoxResponse::near_corner(std::ptrdiff_t nx, std::ptrdiff_t ny) const {
    const fft::SlabShare& share = plane_slabs_.share();
    const std::ptrdiff_t rows = std::clamp<std::ptrdiff_t>(nx - share.x_start, 0, share.x_count);
    LateralVariation all;
    all.strain_points = field_.variation().strain_points;
    all.density_varies = field_.variation().density_varies;
    const auto cells = static_cast<std::size_t>(rows * ny);
    for (std::size_t p = 0; p < field_.points(); ++p) {
        LateralVariation::Point point{.runs = {}, .first = all.cells, .cells = cells};
        for (std::ptrdiff_t i = 0; i < rows; ++i)
            point.runs.push_back({i, 0, ny, static_cast<std::size_t>(i * ny)});
        all.points.push_back(std::move(point));
        all.cells += cells;
    }
    return {std::move(all), ny, share};
}

void BoxResponse::assemble(const Respond& respond) {
    const std::ptrdiff_t half = grid_.ny / 2;
    const LateralField quadrant = near_corner(grid_.nx / 2, half);
    StrainPlanes planes(quadrant.cells(), plane_slabs_, team_, {});
    const auto rows = static_cast<std::ptrdiff_t>(quadrant.variation().points[0].runs.size());
    std::vector<fft::RowRun> complete;
    for (std::ptrdiff_t i = 0; i < rows; ++i)
        complete.push_back({i, 0, grid_.ny, static_cast<std::size_t>(i * grid_.ny)});
    const fft::RunTransform to_box(
        slabs_, team_, std::move(complete),
        fft::RunTransform::Layout{{slabs_.share().ky_start, slabs_.share().ky_count},
                                  quadrant.cells().x_start,
                                  grid_.nx,
                                  slabs_.line_pitch(),
                                  slabs_.lines_reals()});
    const std::ptrdiff_t near_cells = rows * half, all_cells = rows * grid_.ny;
    Values near, all;
    fft::AlignedVector<double> lines;
    together(team_, [&] {
        planes.assemble();
        near.resize(static_cast<std::size_t>(count_ * near_cells));
        all.resize(static_cast<std::size_t>(count_ * all_cells));
        lines.resize(static_cast<std::size_t>(count_ * to_box.lines_reals()));
    });
    for (std::ptrdiff_t column = 0; column < count_; ++column) {
        respond(column, planes);
        planes.get_from(static_cast<std::size_t>(column / field_.variation().components()), near);
        for (std::ptrdiff_t plane = column; plane < count_; ++plane)
            for (std::ptrdiff_t i = 0; i < rows; ++i)
                mirror_row(plane, column, quadrant.cells().x_start + i,
                           near.data() + plane * near_cells + i * half,
                           all.data() + plane * all_cells + i * grid_.ny);
        to_box.to_lines(all.data() + column * all_cells, static_cast<std::size_t>(all_cells),
                        count_ - column, lines.data() + column * to_box.lines_reals());
        gather_column(column, to_box.lines_reals(), lines.data());
    }
}

/// Completes a row over distances along y. The kernel is even or odd. At half of the period, beyond
/// the distances between cells, any value will do; the one chosen makes the Nyquist mode vanish,
/// which the transforms do not represent. On the complete plane this is its true value.
void BoxResponse::mirror_row(std::ptrdiff_t plane, std::ptrdiff_t column, std::ptrdiff_t distance_x,
                             const double* near, double* row) const {
    const double sign = is_odd_y(component(plane)) != is_odd_y(component(column)) ? -1.0 : 1.0;
    const double weight = distance_x == 0 ? 0.5 : 1.0; // both signs of the distance follow from one
    const std::ptrdiff_t half = grid_.ny / 2;
    double alternating = near[0];
    row[0] = weight * near[0];
    for (std::ptrdiff_t j = 1; j < half; ++j) {
        row[j] = weight * near[j];
        row[grid_.ny - j] = sign * row[j];
        alternating += (j % 2 == 0 ? 2.0 : -2.0) * near[j];
    }
    row[half] = sign < 0.0 ? 0.0 : (half % 2 == 0 ? -weight : weight) * alternating;
}

void BoxResponse::gather_column(std::ptrdiff_t column, std::ptrdiff_t stride, double* lines) {
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) continue;
        for (std::ptrdiff_t plane = column; plane < count_; ++plane) {
            double* line = lines + plane * stride + 2 * row * slabs_.line_pitch();
            slabs_.line_to_spectral(line);
            gather_line(row, plane, column, reinterpret_cast<const std::complex<double>*>(line));
        }
    }
}

/// Adds the distances of the other sign along x and stores the entries of one ky.
void BoxResponse::gather_line(std::ptrdiff_t row, std::ptrdiff_t plane, std::ptrdiff_t column,
                              const std::complex<double>* line) {
    const int a = component(plane), b = component(column);
    const double sign = is_odd_x(a) != is_odd_x(b) ? -1.0 : 1.0;
    const double scale = 1.0 / static_cast<double>(grid_.nx * grid_.ny);
    const std::ptrdiff_t half = grid_.nx / 2;
    // As in mirror_row(): the value at half of the period makes the Nyquist mode vanish.
    const std::complex<double> end = sign < 0.0 ? 0.0 : (half % 2 == 0 ? -2.0 : 2.0) * line[half];
    for (std::ptrdiff_t i = 0; i < half; ++i) {
        const std::complex<double> value =
            scale *
            (line[i] + sign * line[(grid_.nx - i) % grid_.nx] + (i % 2 == 0 ? 1.0 : -1.0) * end);
        const double entry = is_imaginary(a) == is_imaginary(b) ? value.real()
                             : is_imaginary(a)                  ? value.imag()
                                                                : -value.imag();
        float* high = matrix(row, i / lane_count) +
                      (plane * (plane + 1) / 2 + column) * lane_count + i % lane_count;
        *high = static_cast<float>(entry);
        high[entries_ * lane_count] = static_cast<float>(entry - static_cast<double>(*high));
    }
}

void BoxResponse::respond(const Values& stress, Values& strain, Precision precision) {
    planes_.set(stress);
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) {
            planes_.end_row(row, StrainPlanes::Modes::emptied);
            continue;
        }
        planes_.begin_row(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block)
            multiply(row, block, precision);
        planes_.end_row(row, StrainPlanes::Modes::retained);
    }
    planes_.get(strain);
}

/// With real and even quantities the matrix is real and the same for both signs of kx.
void BoxResponse::multiply(std::ptrdiff_t row, std::ptrdiff_t block, Precision precision) {
    const WaveBlock waves = planes_.in_line(vectors_.waves(row, block));
    double* line = planes_.line(row);
    for (std::ptrdiff_t plane = 0; plane < count_; ++plane)
        lines_.gather(waves, symmetry_of(component(plane)), line + plane * planes_.stride(),
                      given_.data() + plane * parts);
    const float* high = matrix(row, block);
    (precision == Precision::full ? kernels_.multiply : kernels_.multiply_rounded)(
        count_, {high, high + entries_ * lane_count}, given_.data(), result_.data());
    for (std::ptrdiff_t plane = 0; plane < count_; ++plane)
        lines_.put(waves, symmetry_of(component(plane)), result_.data() + plane * parts,
                   line + plane * planes_.stride());
}

} // namespace shearwake::spectral
