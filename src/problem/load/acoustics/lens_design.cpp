// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/lens_design.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake {

namespace {

using Complex = std::complex<double>;
/// Refinement of the lattice for the peak and the width: 16 points per wavelength.
constexpr std::ptrdiff_t refinement = 4;
/// Samples per side of a lattice cell over which the target is averaged.
constexpr int subsamples = 4;

Complex unit(Complex x) {
    const double modulus = std::abs(x);
    return modulus > 0.0 ? x / modulus : Complex(1.0);
}

/// The lens and the skin on one lattice.
class Bench {
public:
    explicit Bench(const LensFootprint& lens)
        : lens_(lens), lattice_(lattice(lens)),
          waves_(
              {two_pi / wavelength_m(lens), lens.absorption_dB_m / (20.0 * std::numbers::log10e)},
              {lattice_.side, lattice_.spacing_m, lens.distance_m}) {
        pixels_ = pixels_along(lens);
        first_ = (lattice_.side / lattice_.points_per_pixel - pixels_) / 2;
    }

    const LensLattice& grid() const { return lattice_; }
    std::ptrdiff_t pixels() const { return pixels_; }
    std::size_t points() const { return static_cast<std::size_t>(lattice_.side * lattice_.side); }
    PlanePropagation& waves() { return waves_; }

    bool is_open(std::ptrdiff_t i, std::ptrdiff_t j) const {
        const double middle = 0.5 * static_cast<double>(pixels_ - 1);
        return std::hypot(static_cast<double>(i) - middle, static_cast<double>(j) - middle) *
                   lens_.pixel_m <=
               0.5 * lens_.aperture_m;
    }
    /// Calls f(index of the point) for the lattice points of a pixel.
    template <class F>
    void for_points(std::ptrdiff_t i, std::ptrdiff_t j, F f) const {
        const std::ptrdiff_t per = lattice_.points_per_pixel;
        for (std::ptrdiff_t x = 0; x < per; ++x)
            for (std::ptrdiff_t y = 0; y < per; ++y)
                f(static_cast<std::size_t>(((first_ + i) * per + x) * lattice_.side +
                                           (first_ + j) * per + y));
    }
    /// Calls f(pixel number, i, j) for the pixels of the lens.
    template <class F>
    void for_pixels(F f) const {
        for (std::ptrdiff_t i = 0; i < pixels_; ++i)
            for (std::ptrdiff_t j = 0; j < pixels_; ++j)
                if (is_open(i, j)) f(static_cast<std::size_t>(i * pixels_ + j), i, j);
    }

    /// The nearest field behind the lens, whose amplitude is 1: the phases of its pixels.
    std::vector<double> phases(const std::vector<Complex>& field) const {
        std::vector<double> phase_rad(static_cast<std::size_t>(pixels_ * pixels_), not_a_number);
        for_pixels([&](std::size_t pixel, std::ptrdiff_t i, std::ptrdiff_t j) {
            Complex sum = 0.0;
            for_points(i, j, [&](std::size_t point) { sum += field[point]; });
            const double angle = std::arg(sum);
            phase_rad[pixel] = angle < 0.0 ? angle + two_pi : angle;
        });
        return phase_rad;
    }
    std::vector<Complex> behind(const std::vector<double>& phase_rad) const {
        std::vector<Complex> field(points());
        for_pixels([&](std::size_t pixel, std::ptrdiff_t i, std::ptrdiff_t j) {
            const Complex value = std::polar(1.0, phase_rad[pixel]);
            for_points(i, j, [&](std::size_t point) { field[point] = value; });
        });
        return field;
    }

    /// Amplitude of the target, averaged over each cell.
    std::vector<double> target() const {
        std::vector<double> amplitude(points());
        for (std::ptrdiff_t i = 0; i < lattice_.side; ++i)
            for (std::ptrdiff_t j = 0; j < lattice_.side; ++j) {
                const Vec2 middle = {lattice_.at_m(i), lattice_.at_m(j)};
                if (norm(middle) > fading_end_m(lens_.reach_m)) continue;
                double sum = 0.0;
                for (int a = 0; a < subsamples; ++a)
                    for (int b = 0; b < subsamples; ++b)
                        sum +=
                            target_pressure(lens_, middle + lattice_.spacing_m *
                                                                Vec2{(a + 0.5) / subsamples - 0.5,
                                                                     (b + 0.5) / subsamples - 0.5});
                amplitude[static_cast<std::size_t>(i * lattice_.side + j)] =
                    std::sqrt(sum / (subsamples * subsamples));
            }
        return amplitude;
    }

private:
    LensFootprint lens_;
    LensLattice lattice_;
    PlanePropagation waves_;
    std::ptrdiff_t first_ = 0, pixels_ = 0; // the pixels of the square around the aperture
};

double energy(const std::vector<Complex>& field) {
    double sum = 0.0;
    for (const Complex& p : field)
        sum += std::norm(p);
    return sum;
}

/// The fraction of the power behind the lens that does not arrive with the amplitude of the target.
double mismatch(const std::vector<Complex>& field, const std::vector<double>& target,
                double power) {
    double product = 0.0, square = 0.0;
    for (std::size_t n = 0; n < field.size(); ++n) {
        product += std::abs(field[n]) * target[n];
        square += target[n] * target[n];
    }
    return square > 0.0 ? 1.0 - product * product / (square * power) : 1.0;
}

std::vector<double> rounded(std::vector<double> phase_rad, int levels) {
    if (levels == 0) return phase_rad;
    for (double& phase : phase_rad) // NaN remains NaN
        phase = std::fmod(std::round(phase / two_pi * levels), levels) * two_pi / levels;
    return phase_rad;
}

/// The size of the connected area around the peak with values above half of it, as the diameter of
/// a disc [m].
double spot_m(const std::vector<double>& values, std::ptrdiff_t side, double spacing_m) {
    const auto peak = std::max_element(values.begin(), values.end());
    std::vector<char> is_known(values.size(), 0);
    std::vector<std::ptrdiff_t> open = {peak - values.begin()};
    std::size_t count = 0;
    while (!open.empty()) {
        const std::ptrdiff_t at = open.back();
        open.pop_back();
        if (is_known[static_cast<std::size_t>(at)] ||
            values[static_cast<std::size_t>(at)] < 0.5 * *peak)
            continue;
        is_known[static_cast<std::size_t>(at)] = 1;
        ++count;
        const std::ptrdiff_t i = at / side, j = at % side;
        if (i > 0) open.push_back(at - side);
        if (i + 1 < side) open.push_back(at + side);
        if (j > 0) open.push_back(at - 1);
        if (j + 1 < side) open.push_back(at + 1);
    }
    return 2.0 * spacing_m * std::sqrt(static_cast<double>(count) / std::numbers::pi);
}

/// The largest value, by parabolas through the largest sample and its neighbours; samples on the
/// edge are 0.
double peak_of(const std::vector<double>& values, std::ptrdiff_t side) {
    const auto largest = std::max_element(values.begin(), values.end());
    double peak = *largest;
    for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, side}) {
        const double before = *(largest - step), after = *(largest + step);
        const double bend = 2.0 * *largest - before - after;
        if (bend > 0.0) peak += (after - before) * (after - before) / (8.0 * bend);
    }
    return peak;
}

/// The pattern, its peak and its width from the field on the skin.
void set_pattern(const LensFootprint& lens, const LensLattice& grid,
                 const std::vector<Complex>& field, LensDesign& design) {
    const auto half =
        static_cast<std::ptrdiff_t>(std::ceil(fading_end_m(lens.reach_m) / grid.spacing_m));
    const std::ptrdiff_t first = grid.side / 2 - half;
    Patch& patch = design.pattern;
    patch.side = grid.side - 2 * first;
    patch.spacing_m = grid.spacing_m;
    patch.origin_m = {grid.at_m(first), grid.at_m(first)};
    for (std::ptrdiff_t i = first; i < first + patch.side; ++i)
        for (std::ptrdiff_t j = first; j < first + patch.side; ++j)
            patch.values.push_back(std::norm(field[static_cast<std::size_t>(i * grid.side + j)]) *
                                   fading(lens.reach_m, std::hypot(grid.at_m(i), grid.at_m(j))));
    const std::vector<double> dense = refined(patch.values, patch.side, refinement);
    const double peak = peak_of(dense, refinement * patch.side);
    for (double& value : patch.values)
        value /= peak;
    design.gain = std::sqrt(peak);
    design.width_m =
        spot_m(dense, refinement * patch.side, grid.spacing_m / static_cast<double>(refinement));
}

double uniformity(const LensFootprint& lens, const Patch& pattern) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const Vec2& focus : lens.foci_m) {
        const double value = value_at(pattern, focus);
        least = std::min(least, value);
        most = std::max(most, value);
    }
    return most > 0.0 ? 1.0 - (most - least) / (most + least) : 1.0;
}

} // namespace

std::vector<Complex> field_on_skin(const LensFootprint& lens,
                                   const std::vector<double>& phase_rad) {
    Bench bench(lens);
    std::vector<Complex> field = bench.behind(phase_rad);
    bench.waves().forward(field);
    return field;
}

LensDesign design_lens(const LensFootprint& lens) {
    Bench bench(lens);
    const std::vector<double> target = bench.target();
    std::vector<Complex> at_lens(target.begin(), target.end()), on_skin;
    bench.waves().adjoint(at_lens);
    LensDesign design{.pixels = bench.pixels()};
    design.phase_rad = bench.phases(at_lens);
    at_lens = bench.behind(design.phase_rad);
    const double power = energy(at_lens);
    for (int iteration = 0; iteration <= lens.iterations; ++iteration) {
        on_skin = at_lens;
        bench.waves().forward(on_skin);
        if (iteration > 0) design.errors.push_back(mismatch(on_skin, target, power));
        if (iteration == lens.iterations) break;
        for (std::size_t n = 0; n < target.size(); ++n)
            on_skin[n] = target[n] * unit(on_skin[n]);
        bench.waves().adjoint(on_skin);
        design.phase_rad = bench.phases(on_skin);
        at_lens = bench.behind(design.phase_rad);
    }
    design.phase_rad = rounded(std::move(design.phase_rad), lens.phase_levels);
    on_skin = bench.behind(design.phase_rad);
    bench.waves().forward(on_skin);
    design.errors.push_back(mismatch(on_skin, target, power));
    double arriving = 0.0;
    for (std::size_t n = 0; n < target.size(); ++n)
        if (target[n] * target[n] >= 0.5) arriving += std::norm(on_skin[n]);
    design.efficiency = arriving / power;
    set_pattern(lens, bench.grid(), on_skin, design);
    design.uniformity = uniformity(lens, design.pattern);
    return design;
}

std::shared_ptr<const LensDesign> design_of(const LensFootprint& lens) {
    return lens.design ? lens.design : std::make_shared<const LensDesign>(design_lens(lens));
}

namespace {

/// Largest number of points times iterations for all lenses of a job: about 1.6 s.
constexpr double most_work = 1.5e7;

double work_of(const LensFootprint& lens) {
    return std::pow(static_cast<double>(lattice(lens).side), 2) * lens.iterations;
}

} // namespace

std::shared_ptr<const LensDesign> LensDesigns::of(const LensFootprint& lens) {
    for (const LensFootprint& known : known_)
        if (known == lens) return known.design;
    double work = work_of(lens);
    for (const LensFootprint& known : known_)
        work += work_of(known);
    if (work > most_work)
        throw UsageError(fmt::format("results in {:.2g} points times iterations for all lenses of "
                                     "the job ({} x {} points and {} iterations for this one), but "
                                     "at most {:.2g} are supported; reduce it, increase pixel_mm, "
                                     "or use fewer lenses",
                                     work, lattice(lens).side, lattice(lens).side, lens.iterations,
                                     most_work));
    known_.push_back(lens);
    known_.back().design = design_of(lens);
    return known_.back().design;
}

namespace {

/// A corner of the grid of pixels.
struct Corner {
    std::ptrdiff_t i = 0, j = 0;
};

class Columns {
public:
    explicit Columns(const HeightMap& map) : map_(map) {}

    double height(std::ptrdiff_t i, std::ptrdiff_t j) const {
        if (i < 0 || j < 0 || i >= map_.side || j >= map_.side) return 0.0;
        return std::max(0.0, map_.heights_m[static_cast<std::size_t>(i * map_.side + j)]);
    }
    Vec3 point(Corner at, double z_m) const {
        const double half = 0.5 * static_cast<double>(map_.side);
        return {(static_cast<double>(at.i) - half) * map_.pixel_m,
                (static_cast<double>(at.j) - half) * map_.pixel_m, z_m};
    }
    /// The heights between `low` and `high` at which walls around this corner begin or end, so that
    /// all of them share the same edges.
    std::vector<double> heights_at(Corner at, double low, double high) const {
        std::vector<double> heights = {low, high};
        for (const std::ptrdiff_t i : {at.i - 1, at.i})
            for (const std::ptrdiff_t j : {at.j - 1, at.j})
                if (height(i, j) > low && height(i, j) < high) heights.push_back(height(i, j));
        std::sort(heights.begin(), heights.end());
        heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
        return heights;
    }
    /// The wall above the edge from `a` to `b`, seen from outside with `a` on the left.
    void add_wall(Corner a, Corner b, double low, double high, std::vector<Triangle>& to) const {
        const std::vector<double> left = heights_at(a, low, high), right = heights_at(b, low, high);
        std::size_t l = 0, r = 0;
        while (l + 1 < left.size() || r + 1 < right.size()) {
            const bool is_left_next =
                r + 1 == right.size() || (l + 1 < left.size() && left[l + 1] <= right[r + 1]);
            const Vec3 at_left = point(a, left[l]), at_right = point(b, right[r]);
            if (is_left_next)
                to.push_back({at_left, at_right, point(a, left[++l])});
            else
                to.push_back({at_left, at_right, point(b, right[++r])});
        }
    }

private:
    const HeightMap& map_;
};

Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

void append(std::string& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8)
        bytes += static_cast<char>((bits >> shift) & 0xffU);
}

} // namespace

std::vector<Triangle> surface_of(const HeightMap& map) {
    const Columns columns(map);
    std::vector<Triangle> triangles;
    for (std::ptrdiff_t i = 0; i < map.side; ++i)
        for (std::ptrdiff_t j = 0; j < map.side; ++j) {
            const double top = columns.height(i, j);
            if (top == 0.0) continue;
            const Corner sw{i, j}, se{i + 1, j}, ne{i + 1, j + 1}, nw{i, j + 1};
            const auto at = [&](Corner corner, double z_m) { return columns.point(corner, z_m); };
            triangles.push_back({at(sw, top), at(se, top), at(ne, top)});
            triangles.push_back({at(sw, top), at(ne, top), at(nw, top)});
            triangles.push_back({at(sw, 0.0), at(ne, 0.0), at(se, 0.0)});
            triangles.push_back({at(sw, 0.0), at(nw, 0.0), at(ne, 0.0)});
            const auto wall = [&](Corner a, Corner b, double beyond) {
                if (beyond < top) columns.add_wall(a, b, beyond, top, triangles);
            };
            wall(sw, se, columns.height(i, j - 1));
            wall(se, ne, columns.height(i + 1, j));
            wall(ne, nw, columns.height(i, j + 1));
            wall(nw, sw, columns.height(i - 1, j));
        }
    return triangles;
}

std::string binary_stl(const std::vector<Triangle>& triangles) {
    std::string bytes = "shearwake lens, millimetres";
    bytes.resize(80, ' ');
    const auto count = static_cast<std::uint32_t>(triangles.size());
    for (int shift = 0; shift < 32; shift += 8)
        bytes += static_cast<char>((count >> shift) & 0xffU);
    for (const Triangle& t : triangles) {
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double length = norm(normal);
        for (const Vec3& v : {(1.0 / length) * normal, 1e3 * t[0], 1e3 * t[1], 1e3 * t[2]})
            for (const double component : {v.x, v.y, v.z})
                append(bytes, static_cast<float>(component));
        bytes.append(2, '\0');
    }
    return bytes;
}

} // namespace shearwake
