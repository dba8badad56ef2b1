#include "engines/spectral/lateral_variation.hpp"

#include "engines/spectral/cell_materials.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// Least and greatest of each property over the whole plane.
struct Extremes {
    Material least, greatest;
};

Extremes extremes_of(const std::vector<Material>& all, const Material& layer, const Comm& team) {
    constexpr double none = -1e300;
    std::array<double, 8> v;
    v.fill(none);
    for (const Material& m : all) {
        const double values[4] = {m.density_kg_m3, m.lambda_Pa, m.mu_Pa, m.viscosity_Pa_s};
        for (std::size_t i = 0; i < 4; ++i) {
            v[i] = std::max(v[i], values[i]);
            v[4 + i] = std::max(v[4 + i], -values[i]);
        }
    }
    team.max(std::span<double>(v));
    if (v[0] == none) return {layer, layer};
    return {{-v[4], -v[5], -v[6], -v[7]}, {v[0], v[1], v[2], v[3]}};
}

double reflection(double stiffness_ratio) {
    const double z = std::sqrt(stiffness_ratio);
    return (z - 1.0) / (z + 1.0);
}

/// One strain point while the whole is gathered.
struct Gathered {
    StrainPoint where;
    Extremes extremes;
    std::vector<Material> all;
    bool varies;
};

bool differs(const Material& a, const Material& b) {
    return std::abs(a.mu_Pa - b.mu_Pa) > 1e-12 * b.mu_Pa ||
           std::abs(a.lambda_Pa - b.lambda_Pa) > 1e-12 * b.lambda_Pa ||
           std::abs(a.density_kg_m3 - b.density_kg_m3) > 1e-12 * b.density_kg_m3 ||
           std::abs(a.viscosity_Pa_s - b.viscosity_Pa_s) > 1e-12 * b.viscosity_Pa_s;
}

std::vector<Gathered> gather(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                             const Comm& team, double& stiffest) {
    std::vector<Gathered> result;
    const auto nodes = static_cast<std::size_t>(mesh.degree + 1);
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (!varies_between(c.medium, mesh.ends_m[e], mesh.ends_m[e + 1])) continue;
        const Material layer = material_of(c.medium.layers[mesh.layers[e]]);
        const HeldMaterials held(c, layer);
        std::vector<Gathered> here;
        bool some_vary = false, less_viscous = false;
        for (std::size_t i = 0; i < nodes; ++i) {
            Gathered g{{e, static_cast<std::ptrdiff_t>(i)}, {}, {}, false};
            together(team, [&] { g.all = cell_materials(c, mesh, share, g.where); });
            g.extremes = extremes_of(g.all, layer, team);
            stiffest = std::max(stiffest, g.extremes.greatest.mu_Pa / layer.mu_Pa);
            for (Material& m : g.all)
                m = held(m);
            g.extremes = extremes_of(g.all, layer, team);
            g.varies = differs(g.extremes.least, layer) || differs(g.extremes.greatest, layer);
            some_vary |= g.varies;
            less_viscous |= g.extremes.least.viscosity_Pa_s < layer.viscosity_Pa_s;
            here.push_back(std::move(g));
        }
        // One theta an element: where it falls below the layer's, all the nodes make up for it.
        for (Gathered& g : here)
            if (g.varies || (some_vary && less_viscous)) result.push_back(std::move(g));
    }
    return result;
}

} // namespace

LateralVariation lateral_variation(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors,
                                   double step_s, const Comm& team) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    LateralVariation v;
    v.background = background_of(mesh, c.medium);
    double stiffest = 0.0;
    const std::vector<Gathered> gathered = gather(c, mesh, vectors.share(), team, stiffest);
    if (gathered.empty()) return v;

    if (stiffest > options.contrast_cap * (1.0 + 1e-12))
        v.notes.push_back(fmt::format(
            "shear stiffness up to {:.3g} times the layer's is held to {:.3g} times: it reflects "
            "{:.3f} of a shear wave's amplitude, the true one {:.3f}",
            stiffest, options.contrast_cap, reflection(options.contrast_cap),
            reflection(stiffest)));

    // What the background must bear, and whether iterations are needed.
    const auto nodes = static_cast<std::size_t>(mesh.degree + 1);
    const double k_load = bandwidth_rad_m(c.load.footprint, 0.5);
    bool viscosity_varies = false, lambda_varies = false;
    double inertia = 0.0;
    const auto index = [&](const StrainPoint& p) {
        return p.element * nodes + static_cast<std::size_t>(p.node);
    };
    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        const std::size_t at = index(g.where);
        v.density_varies |= greatest.density_kg_m3 > least.density_kg_m3 * (1.0 + 1e-9);
        viscosity_varies |= greatest.viscosity_Pa_s > least.viscosity_Pa_s;
        lambda_varies |= greatest.lambda_Pa > one_lambda * least.lambda_Pa;
        v.background.density_kg_m3[at] = least.density_kg_m3;
        v.background.mu_accurate_Pa[at] = v.background.mu_stable_Pa[at] = least.mu_Pa;
        v.background.viscosity_Pa_s[at] = least.viscosity_Pa_s;
    }
    const VerticalOperator vertical(mesh, v.background);
    const double k_max = vectors.largest_k_rad_m();
    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        const double added =
            std::max(0.0,
                     vertical.stabilised_mu_Pa(g.where.element, greatest.mu_Pa, k_max, step_s) -
                         greatest.mu_Pa / 12.0) +
            (greatest.mu_Pa - least.mu_Pa) / 12.0;
        inertia = std::max(inertia, added * std::pow(k_load * step_s, 2) / least.density_kg_m3);
    }
    const bool must = v.density_varies || viscosity_varies || lambda_varies;
    v.iterates =
        must || options.method == SpectralMethod::iterative ||
        (options.method == SpectralMethod::automatic && inertia > tolerated_inertia(options));
    v.notes.push_back(fmt::format(
        "{} of {} strain points vary laterally; {}: {}", gathered.size(), mesh.elements() * nodes,
        v.iterates ? "conjugate gradients on the true operator" : "one background solve a step",
        v.density_varies   ? "the density varies"
        : viscosity_varies ? "the viscosity varies"
        : lambda_varies
            ? "the compressional stiffness varies"
            : fmt::format("one solve a step would add {:.2g} of the tissue's inertia", inertia)));

    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        const std::size_t at = index(g.where);
        v.background.lambda_Pa[at] = lambda_varies ? least.lambda_Pa : greatest.lambda_Pa;
        v.background.force_lambda_Pa[at] =
            std::min(v.background.force_lambda_Pa[at], v.background.lambda_Pa[at]);
        v.background.theta_s[g.where.element] =
            std::min(v.background.theta_s[g.where.element], least.viscosity_Pa_s / least.mu_Pa);
        if (!v.iterates) v.background.mu_stable_Pa[at] = greatest.mu_Pa;
    }
    const auto stable = [&](const Gathered& g, double mu_Pa) {
        return vertical.stabilised_mu_Pa(g.where.element, mu_Pa, k_max, step_s);
    };
    together(team, [&] {
        for (const Gathered& g : gathered) {
            const Material& least = g.extremes.least;
            const std::size_t at = index(g.where);
            Material base = least; // of the forces
            base.lambda_Pa = v.background.force_lambda_Pa[at];
            base.viscosity_Pa_s = v.background.theta_s[g.where.element] * least.mu_Pa;
            const double weight = 0.5 * mesh.length_m(g.where.element) *
                                  mesh.rule.weights[static_cast<std::size_t>(g.where.node)];
            LateralVariation::Point point;
            point.first = v.cells;
            v.strain_points.push_back(g.where);
            const double floor = stable(g, least.mu_Pa);
            for (std::ptrdiff_t i = 0; i < vectors.share().x_count; ++i) {
                const auto* row = g.all.data() + i * c.domain.ny;
                const auto matters = [&](Material m) {
                    if (differs(m, base)) return true;
                    // A body's mu lowers its lambda a little: the layer's is not the least then,
                    // everywhere, which matters only where lambda is implicit.
                    if (!lambda_varies) m.lambda_Pa = least.lambda_Pa;
                    return v.iterates && differs(m, least);
                };
                std::ptrdiff_t begin = 0, end = c.domain.ny;
                while (begin < end && !matters(row[begin]))
                    ++begin;
                while (end > begin && !matters(row[end - 1]))
                    --end;
                if (begin == end) continue;
                point.runs.push_back({i, begin, end, v.cells - point.first});
                v.cells += static_cast<std::size_t>(end - begin);
                for (std::ptrdiff_t j = begin; j < end; ++j) {
                    const Material& m = row[j];
                    v.lambda.push_back(weight * (m.lambda_Pa - base.lambda_Pa));
                    v.mu.push_back(weight * (m.mu_Pa - base.mu_Pa));
                    v.viscosity.push_back(weight * (m.viscosity_Pa_s - base.viscosity_Pa_s));
                    if (!v.iterates) continue;
                    v.implicit_mu.push_back(
                        weight * (stable(g, m.mu_Pa) - floor +
                                  0.5 * (m.viscosity_Pa_s - least.viscosity_Pa_s) / step_s));
                    v.implicit_lambda.push_back(
                        lambda_varies ? weight * 0.26 * (m.lambda_Pa - least.lambda_Pa) : 0.0);
                    if (v.density_varies)
                        v.implicit_mass.push_back(weight * (m.density_kg_m3 - least.density_kg_m3) /
                                                  (step_s * step_s));
                }
            }
            point.cells = v.cells - point.first;
            v.points.push_back(std::move(point));
        }
    });
    return v;
}

} // namespace shearwake
