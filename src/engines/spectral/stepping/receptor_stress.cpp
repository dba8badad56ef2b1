// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/receptor_stress.hpp"

#include "engines/spectral/lateral/cell_materials.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// A depth within this distance of an element boundary, relative to the element's length, belongs
/// to both elements.
constexpr double rounding = 1e-9;

using Numbers = std::vector<double>;
/// Values one step before a frame, at the frame, and one step after it.
using Times = std::array<Numbers, 3>;

std::vector<std::size_t> elements_at(const DepthMesh& mesh, double depth_m) {
    std::vector<std::size_t> at;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double margin_m = rounding * mesh.length_m(e);
        if (depth_m >= mesh.ends_m[e] - margin_m && depth_m <= mesh.ends_m[e + 1] + margin_m)
            at.push_back(e);
    }
    return at;
}

bool varies_in(const Case& c, const DepthMesh& mesh, std::size_t element) {
    return varies_between(c.scene.medium, mesh.ends_m[element], mesh.ends_m[element + 1]);
}

/// Node weights of the z derivative of a quantity, given its node weights.
Numbers slope_of(const Numbers& weights, const DepthMesh& mesh, std::size_t element) {
    const std::size_t nodes = weights.size();
    Numbers slope(nodes, 0.0);
    for (std::size_t q = 0; q < nodes; ++q)
        for (std::size_t j = 0; j < nodes; ++j)
            slope[j] +=
                2.0 / mesh.length_m(element) * weights[q] * mesh.rule.derivative[q * nodes + j];
    return slope;
}

/// Weights of W, followed by those of -k U, at the three times.
Times spread(const Numbers& of_w, const Numbers& of_u, const std::array<double, 3>& shares) {
    Times all;
    for (std::size_t t = 0; t < all.size(); ++t)
        for (const Numbers* of : {&of_w, &of_u})
            for (const double weight : *of)
                all[t].push_back(shares[t] * weight);
    return all;
}

/// Weights of W' - k U, averaged over the three times as in the scheme.
Times dilation(const Numbers& weights, const DepthMesh& mesh, std::size_t element) {
    constexpr double s = stabilising_lambda;
    return spread(slope_of(weights, mesh, element), weights, {s, 1.0 - 2.0 * s, s});
}

void add_scaled(double factor, const Times& more, Times& to) {
    for (std::size_t t = 0; t < to.size(); ++t) {
        to[t].resize(more[t].size(), 0.0);
        for (std::size_t i = 0; i < to[t].size(); ++i)
            to[t][i] += factor * more[t][i];
    }
}

/// The motion at a depth, with its slope, as two linear elements of length 2.
DepthMesh motion_mesh() {
    return {.degree = 1,
            .rule = gauss_lobatto(1),
            .ends_m = {0.0, 2.0, 4.0},
            .layers = {0, 0},
            .light = {},
            .bottom = {}};
}
constexpr std::ptrdiff_t motion_levels = 2;
constexpr std::ptrdiff_t motion_blocks = 3 * motion_levels * parts;

} // namespace

ReceptorStress::ReceptorStress(const Case& c, std::vector<double> depths_m, const DepthMesh& mesh,
                               const fft::SlabTransform& slabs, double step_s, const Comm& team)
    : case_(c), mesh_(mesh), slabs_(slabs), step_s_(step_s), vectors_(c.domain, slabs.share()),
      depths_m_(std::move(depths_m)), levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)),
      strains_(motion_mesh(), {{}}, strain_components) {
    if (!wanted()) return;
    together(team, [&] {
        for (std::size_t depth = 0; depth < depths_m_.size(); ++depth) {
            const double depth_m = depths_m_[depth];
            const auto elements = elements_at(mesh_, depth_m);
            for (const std::size_t element : elements)
                add_parts(depth, depth_m, element, 1.0 / static_cast<double>(elements.size()));
        }
        const auto plane = static_cast<std::size_t>(slabs.share().reals);
        plane_.resize(plane);
        compression_.resize(plane);
        before_.resize(parts_.size() * static_cast<std::size_t>(vectors_.pencils() * parts));
    });
    std::vector<Surfaces> all = std::move(surfaces_);
    surfaces_.clear();
    for (Surfaces& surfaces : all)
        if (team.any(!surfaces.cells.empty())) surfaces_.push_back(std::move(surfaces));
    together(team, [&] {
        for (Surfaces& surfaces : surfaces_)
            surfaces.motion_before.resize(
                static_cast<std::size_t>(vectors_.pencils() * motion_blocks));
        if (!surfaces_.empty())
            strain_.resize(strain_components * static_cast<std::size_t>(slabs.share().reals));
    });
}

double ReceptorStress::allocated_B() const {
    const std::size_t reals = plane_.size() + compression_.size() + strain_.size();
    std::size_t blocks = before_.size();
    for (const Surfaces& surfaces : surfaces_)
        blocks += surfaces.motion_before.size();
    return static_cast<double>(reals * sizeof(double) + blocks * sizeof(Block));
}

void ReceptorStress::add_parts(std::size_t depth, double depth_m, std::size_t element,
                               double share) {
    const double x = 2.0 * (depth_m - mesh_.ends_m[element]) / mesh_.length_m(element) - 1.0;
    const Numbers smooth = smoothing_weights(mesh_.rule, x), none(smooth.size(), 0.0),
                  value = interpolation_weights(mesh_.rule, x),
                  slope = slope_of(value, mesh_, element);
    const Times strain = spread(slope, none, {0.0, 1.0, 0.0}),
                rate = spread(slope, none, {-0.5 / step_s_, 0.0, 0.5 / step_s_});
    const auto first = static_cast<std::ptrdiff_t>(element) * mesh_.degree;
    const Material layer = material_of(case_.scene.medium.layers[mesh_.layers[element]]);
    if (!varies_in(case_, mesh_, element)) {
        Part all{.depth = depth, .first = first, .weights = {}, .factors = {}};
        add_scaled(-share * layer.lambda_Pa, dilation(smooth, mesh_, element), all.weights);
        add_scaled(-share * 2.0 * layer.mu_Pa, strain, all.weights);
        add_scaled(-share * 2.0 * layer.viscosity_Pa_s, rate, all.weights);
        parts_.push_back(std::move(all));
        return;
    }
    const CappedMaterials capped(case_, layer);
    const auto add = [&](const Times& weights, double factor,
                         const std::vector<CellMaterial>& cells, auto modulus) {
        Part part{.depth = depth, .first = first, .weights = weights, .factors = {}};
        for (const CellMaterial& cell : cells)
            part.factors.push_back(-share * factor * capped(cell).*modulus);
        parts_.push_back(std::move(part));
    };
    const fft::SlabShare& slab = slabs_.share();
    for (std::size_t q = 0; q < smooth.size(); ++q) {
        Numbers node = none;
        node[q] = 1.0;
        add(dilation(node, mesh_, element), smooth[q],
            cell_materials(case_, mesh_, slab, {element, static_cast<std::ptrdiff_t>(q)}),
            &Material::lambda_Pa);
    }
    const auto here = cell_materials(case_, mesh_, slab, element, depth_m);
    add(strain, 2.0, here, &Material::mu_Pa);
    add(rate, 2.0, here, &Material::viscosity_Pa_s);
    Surfaces surfaces{depth, first, value, slope, {}, {}};
    for (std::ptrdiff_t i = 0; i < slab.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < case_.domain.ny; ++j) {
            const CellMaterial m = capped(here[static_cast<std::size_t>(i * case_.domain.ny + j)]);
            if (m.is_laminate())
                surfaces.cells.push_back({i * slab.padded_ny + j, m.normal,
                                          -share * (m.mu_Pa - m.mu_across_Pa),
                                          -share * (m.viscosity_Pa_s - m.viscosity_across_Pa_s)});
        }
    surfaces_.push_back(std::move(surfaces));
}

double ReceptorStress::planes(const Case& c, const DepthMesh& mesh) {
    double count = 0.0;
    for (const double depth_m : stress_depths_m(c))
        for (const std::size_t element : elements_at(mesh, depth_m))
            count += varies_in(c, mesh, element) ? mesh.degree + 9.0 : 1.0;
    return count;
}

void ReceptorStress::add(const Part& part, std::size_t time, const Block& k, const Block* pencil,
                         Block* value) const {
    const std::ptrdiff_t nodes = mesh_.degree + 1;
    const double* of_w = part.weights[time].data();
    const double* of_u = of_w + nodes;
    // The base does not move.
    for (std::ptrdiff_t j = 0; j < nodes && part.first + j < levels_; ++j) {
        const Block* u = pencil + 2 * (part.first + j) * parts;
        const Block* w = u + parts;
        for (std::ptrdiff_t p = 0; p < parts; ++p)
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                value[p][lane] += of_w[j] * w[p][lane] - of_u[j] * k[lane] * u[p][lane];
    }
}

template <class Use>
void ReceptorStress::each_pencil(const Part& part, Use use) {
    const std::ptrdiff_t number = &part - parts_.data();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const std::ptrdiff_t pencil = row * vectors_.blocks() + block;
            use(row, block, pencil * 3 * levels_ * parts,
                before_.data() + (number * vectors_.pencils() + pencil) * parts);
        }
}

void ReceptorStress::remember(const Block* before) {
    for (const Part& part : parts_)
        each_pencil(part, [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at,
                              Block* contribution) {
            std::fill_n(contribution, parts, Block{});
            add(part, 0, vectors_.waves(row, block).k, before + at, contribution);
        });
    for (Surfaces& surfaces : surfaces_) {
        std::fill(surfaces.motion_before.begin(), surfaces.motion_before.end(), Block{});
        for (std::ptrdiff_t pencil = 0; pencil < vectors_.pencils(); ++pencil)
            add_motion(surfaces, 1.0, before + pencil * 3 * levels_ * parts,
                       surfaces.motion_before.data() + pencil * motion_blocks);
    }
}

/// Adds `scale` times the motion of a pencil at the depth as nodal values of motion_mesh(): the
/// value, and the value plus twice the slope.
void ReceptorStress::add_motion(const Surfaces& surfaces, double scale, const Block* pencil,
                                Block* motion) const {
    const std::ptrdiff_t first = surfaces.first;
    // The base does not move.
    for (std::ptrdiff_t j = 0; j <= mesh_.degree && first + j < levels_; ++j) {
        const auto node = static_cast<std::size_t>(j);
        const double weights[motion_levels] = {
            scale * surfaces.value[node],
            scale * (surfaces.value[node] + 2.0 * surfaces.slope[node])};
        for (std::ptrdiff_t level = 0; level < motion_levels; ++level)
            for (std::ptrdiff_t i = 0; i < 3 * parts; ++i) { // U, W, V
                const bool v = i >= 2 * parts;
                const Block& from = pencil[v ? (2 * levels_ + first + j - 2) * parts + i
                                             : 2 * (first + j) * parts + i];
                Block& to =
                    motion[v ? (2 * motion_levels + level - 2) * parts + i : 2 * level * parts + i];
                for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                    to[lane] += weights[level] * from[lane];
            }
    }
}

/// Adds the stress across the surfaces to compression_: first that of the strain, then that of its
/// rate.
void ReceptorStress::add_across(Surfaces& surfaces, const Steps& steps) {
    const std::ptrdiff_t reals = slabs_.share().reals;
    const auto transform = [&](auto motion_of) {
        Block motion[motion_blocks];
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
                std::fill_n(motion, motion_blocks, Block{});
                motion_of(row * vectors_.blocks() + block, motion);
                strains_.strain(vectors_.waves(row, block), motion,
                                strain_.data() + 2 * row * vectors_.nx(), reals);
            }
        for (int c = 0; c < strain_components; ++c) {
            vectors_.clear_nyquist(strain_.data() + c * reals);
            slabs_.to_physical(strain_.data() + c * reals);
        }
    };
    const auto add_stress = [&](double Surfaces::Cell::*modulus) {
        for (const Surfaces::Cell& cell : surfaces.cells) {
            std::array<double, strain_components> scaled{};
            for (int c = 0; c < strain_components; ++c)
                scaled[static_cast<std::size_t>(c)] =
                    cell.*modulus * strain_[static_cast<std::size_t>(c * reals + cell.at)];
            compression_[static_cast<std::size_t>(cell.at)] +=
                stress_across(cell.normal, scaled)[zz];
        }
    };
    const std::ptrdiff_t size = 3 * levels_ * parts;
    transform([&](std::ptrdiff_t pencil, Block* motion) {
        add_motion(surfaces, 1.0, steps.before + pencil * size, motion);
    });
    add_stress(&Surfaces::Cell::mu);
    transform([&](std::ptrdiff_t pencil, Block* motion) {
        const double scale = 0.5 / step_s_;
        const Block* earlier = surfaces.motion_before.data() + pencil * motion_blocks;
        for (std::ptrdiff_t i = 0; i < motion_blocks; ++i)
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                motion[i][lane] = -scale * earlier[i][lane];
        add_motion(surfaces, scale, steps.now + pencil * size, motion);
    });
    add_stress(&Surfaces::Cell::viscosity);
}

void ReceptorStress::emit(const Steps& steps, std::ptrdiff_t frame, engines::Observer& observer) {
    const fft::SlabShare& slab = slabs_.share();
    const std::ptrdiff_t ny = case_.domain.ny;
    const LineKernels& lines = simd::kernels<LineKernels>();
    for (std::size_t depth = 0; depth < depths_m_.size(); ++depth) {
        std::fill(compression_.begin(), compression_.end(), 0.0);
        for (const Part& part : parts_) {
            if (part.depth != depth) continue;
            each_pencil(part, [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at,
                                  Block* value) {
                const WaveBlock waves = vectors_.waves(row, block);
                add(part, 1, waves.k, steps.before + at, value);
                add(part, 2, waves.k, steps.now + at, value);
                lines.put(waves, {}, value, plane_.data() + 2 * row * vectors_.nx());
            });
            vectors_.clear_nyquist(plane_.data());
            slabs_.to_physical(plane_.data());
            for (std::ptrdiff_t i = 0; i < slab.x_count; ++i) {
                const double* from = plane_.data() + i * slab.padded_ny;
                double* to = compression_.data() + i * slab.padded_ny;
                for (std::ptrdiff_t j = 0; j < ny; ++j)
                    to[j] += part.factors.empty()
                                 ? from[j]
                                 : part.factors[static_cast<std::size_t>(i * ny + j)] * from[j];
            }
        }
        for (Surfaces& surfaces : surfaces_)
            if (surfaces.depth == depth) add_across(surfaces, steps);
        observer.stress({.number = frame,
                         .depth = depth,
                         .compression_Pa = View2<const double>(compression_.data(), slab.x_count,
                                                               ny, slab.padded_ny)});
    }
}

} // namespace shearwake::spectral
