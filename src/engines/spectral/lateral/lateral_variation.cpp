// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/lateral_variation.hpp"

#include "base/units.hpp"
#include "parallel/agree.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::spectral {
namespace {

/// Minimum and maximum of each property over the complete plane.
struct Extremes {
    Material least, greatest;
};

Extremes extremes_of(const std::vector<CellMaterial>& all, const Material& layer,
                     const Comm* team) {
    constexpr double none = -1e300;
    std::array<double, 8> v;
    v.fill(none);
    const auto widen = [&](const std::array<double, 4>& values) {
        for (std::size_t i = 0; i < 4; ++i) {
            v[i] = std::max(v[i], values[i]);
            v[4 + i] = std::max(v[4 + i], -values[i]);
        }
    };
    for (const CellMaterial& m : all) {
        widen({m.density_kg_m3, m.lambda_Pa, m.mu_Pa, m.viscosity_Pa_s});
        if (m.is_laminate())
            widen({m.density_kg_m3, m.lambda_Pa, m.mu_across_Pa, m.viscosity_Pa_s});
    }
    if (team) team->max(std::span<double>(v));
    if (v[0] == none) return {layer, layer};
    return {{-v[4], -v[5], -v[6], -v[7]}, {v[0], v[1], v[2], v[3]}};
}

void together_on(const Comm* team, const std::function<void()>& work) {
    if (team)
        together(*team, work);
    else
        work();
}

/// Data of one strain point during the collection.
struct Gathered {
    StrainPoint where;
    Extremes extremes;
    std::vector<CellMaterial> all;
    bool varies;
};

bool differs(const Material& a, const Material& b) {
    return std::abs(a.mu_Pa - b.mu_Pa) > 1e-12 * b.mu_Pa ||
           std::abs(a.lambda_Pa - b.lambda_Pa) > 1e-12 * std::abs(b.lambda_Pa) ||
           std::abs(a.density_kg_m3 - b.density_kg_m3) > 1e-12 * b.density_kg_m3 ||
           std::abs(a.viscosity_Pa_s - b.viscosity_Pa_s) > 1e-12 * b.viscosity_Pa_s;
}

std::vector<Gathered> gather(const Case& c, const DepthMesh& mesh, const fft::SlabShare& share,
                             const Comm* team) {
    std::vector<Gathered> result;
    const auto nodes = static_cast<std::size_t>(mesh.degree) + 1;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (!varies_between(c.scene.medium, mesh.ends_m[e], mesh.ends_m[e + 1])) continue;
        const Material layer = material_of(c.scene.medium.layers[mesh.layers[e]]);
        const CappedMaterials capped(c, layer);
        std::vector<Gathered> here;
        bool some_vary = false, less_viscous = false;
        for (std::size_t i = 0; i < nodes; ++i) {
            Gathered g{{e, static_cast<std::ptrdiff_t>(i)}, {}, {}, false};
            together_on(team, [&] { g.all = cell_materials(c, mesh, share, g.where); });
            for (CellMaterial& m : g.all)
                m = capped(m);
            g.extremes = extremes_of(g.all, layer, team);
            g.varies = differs(g.extremes.least, layer) || differs(g.extremes.greatest, layer);
            some_vary |= g.varies;
            less_viscous |= g.extremes.least.viscosity_Pa_s < layer.viscosity_Pa_s;
            here.push_back(std::move(g));
        }
        // theta is constant within an element. Where it is below that of the layer, all nodes of
        // the element must compensate for it.
        for (Gathered& g : here)
            if (g.varies || (some_vary && less_viscous)) result.push_back(std::move(g));
    }
    return result;
}

/// Properties of the complete plane that determine the solution method.
struct Variety {
    bool density = false, viscosity = false, lambda = false;
    double inertia = 0.0; // added by one solve per step, relative to the tissue's

    /// Whether the variation requires iterations with the true operator.
    bool must_iterate() const { return density || viscosity || lambda; }
};

std::size_t point_of(const DepthMesh& mesh, const StrainPoint& p) {
    return p.element * static_cast<std::size_t>(mesh.degree + 1) + static_cast<std::size_t>(p.node);
}

/// Sets the background to the minimum at each node; lambda, where it varies too little for
/// iterations, to the maximum.
Variety least_background(const std::vector<Gathered>& gathered, const DepthMesh& mesh,
                         Background& b) {
    Variety variety;
    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        const std::size_t at = point_of(mesh, g.where);
        variety.density |= greatest.density_kg_m3 > least.density_kg_m3 * (1.0 + 1e-9);
        variety.viscosity |= greatest.viscosity_Pa_s > least.viscosity_Pa_s;
        variety.lambda |= implicit_lambda_Pa(greatest.lambda_Pa) >
                          one_lambda * implicit_lambda_Pa(least.lambda_Pa);
        // The bulk modulus of the background's forces remains positive.
        if (b.force_lambda_Pa[at] < 0.0)
            b.force_lambda_Pa[at] *= least.mu_Pa / b.mu_accurate_Pa[at];
        b.density_kg_m3[at] = least.density_kg_m3;
        b.mu_greatest_Pa[at] = greatest.mu_Pa;
        b.mu_accurate_Pa[at] = b.mu_stable_Pa[at] = least.mu_Pa;
        b.viscosity_Pa_s[at] = least.viscosity_Pa_s;
    }
    for (const Gathered& g : gathered) {
        const std::size_t at = point_of(mesh, g.where);
        b.lambda_Pa[at] = implicit_lambda_Pa(variety.lambda ? g.extremes.least.lambda_Pa
                                                            : g.extremes.greatest.lambda_Pa);
        b.force_lambda_Pa[at] = std::min(b.force_lambda_Pa[at], b.lambda_Pa[at]);
    }
    return variety;
}

/// Why a variation needs iterations or does not.
std::string reason_of(const Variety& variety) {
    return variety.density     ? "the density varies"
           : variety.viscosity ? "the viscosity varies"
           : variety.lambda
               ? "the compressional stiffness varies"
               : fmt::format("one solve per step would add {:.2g} times the tissue's inertia",
                             variety.inertia);
}

/// Fills a variation with the cells that differ from the background.
class CellCollector {
public:
    CellCollector(const DepthMesh& mesh, const VerticalOperator& vertical, const Variety& variety,
                  double k_max_rad_m, double step_s, LateralVariation& v)
        : mesh_(mesh), vertical_(vertical), variety_(variety), k_max_rad_m_(k_max_rad_m),
          step_s_(step_s), v_(v) {}

    void add(const Gathered& g, std::ptrdiff_t rows, std::ptrdiff_t ny) {
        LateralVariation::Point point;
        point.first = v_.cells;
        v_.strain_points.push_back(g.where);
        v_.surfaces.emplace_back();
        for (std::ptrdiff_t i = 0; i < rows; ++i) {
            const CellMaterial* row = g.all.data() + i * ny;
            std::ptrdiff_t begin = 0, end = ny;
            while (begin < end && !matters(g, row[begin]))
                ++begin;
            while (end > begin && !matters(g, row[end - 1]))
                --end;
            if (begin == end) continue;
            point.runs.push_back({i, begin, end, v_.cells - point.first});
            v_.cells += static_cast<std::size_t>(end - begin);
            for (std::ptrdiff_t j = begin; j < end; ++j) {
                add_cell(g, row[j]);
                if (row[j].is_laminate())
                    add_surface(g, row[j],
                                static_cast<std::size_t>(point.runs.back().offset) +
                                    static_cast<std::size_t>(j - begin));
            }
        }
        point.cells = v_.cells - point.first;
        v_.points.push_back(std::move(point));
    }

private:
    /// The material of the background's forces.
    Material base(const Gathered& g) const {
        Material base = g.extremes.least;
        base.lambda_Pa = v_.background.force_lambda_Pa[point_of(mesh_, g.where)];
        base.viscosity_Pa_s = v_.background.theta_s[g.where.element] * base.mu_Pa;
        return base;
    }
    bool matters(const Gathered& g, Material m) const {
        if (differs(m, base(g))) return true;
        // A higher mu slightly lowers the lambda of a body, so that the layer's is not the minimum.
        // This is relevant only where lambda is implicit.
        if (!variety_.lambda) m.lambda_Pa = g.extremes.least.lambda_Pa;
        return v_.iterates && differs(m, g.extremes.least);
    }
    double stable_mu_Pa(const Gathered& g, double mu_Pa) const {
        return vertical_.stabilised_mu_Pa(g.where.element, mu_Pa, k_max_rad_m_, step_s_);
    }
    double weight_m(const Gathered& g) const {
        return 0.5 * mesh_.length_m(g.where.element) *
               mesh_.rule.weights[static_cast<std::size_t>(g.where.node)];
    }
    double implicit_mu_Pa(const Gathered& g, double mu_Pa, double viscosity_Pa_s) const {
        return stable_mu_Pa(g, mu_Pa) + 0.5 * viscosity_Pa_s / step_s_;
    }
    void add_surface(const Gathered& g, const CellMaterial& m, std::size_t cell) {
        const double weight = weight_m(g);
        v_.surfaces.back().push_back(
            {.cell = cell,
             .normal = m.normal,
             .mu = weight * (m.mu_Pa - m.mu_across_Pa),
             // One solve per step is stable for a uniform viscosity only.
             .viscosity = v_.iterates ? weight * (m.viscosity_Pa_s - m.viscosity_across_Pa_s) : 0.0,
             .implicit_mu = weight * (implicit_mu_Pa(g, m.mu_Pa, m.viscosity_Pa_s) -
                                      implicit_mu_Pa(g, m.mu_across_Pa, m.viscosity_across_Pa_s))});
    }
    void add_cell(const Gathered& g, const Material& m) {
        const Material &least = g.extremes.least, forces = base(g);
        const double weight = weight_m(g);
        v_.lambda.push_back(weight * (m.lambda_Pa - forces.lambda_Pa));
        v_.mu.push_back(weight * (m.mu_Pa - forces.mu_Pa));
        v_.viscosity.push_back(weight * (m.viscosity_Pa_s - forces.viscosity_Pa_s));
        if (!v_.iterates) return;
        v_.implicit_mu.push_back(weight * (implicit_mu_Pa(g, m.mu_Pa, m.viscosity_Pa_s) -
                                           implicit_mu_Pa(g, least.mu_Pa, least.viscosity_Pa_s)));
        v_.implicit_lambda.push_back(variety_.lambda ? weight * stabilising_lambda *
                                                           (implicit_lambda_Pa(m.lambda_Pa) -
                                                            implicit_lambda_Pa(least.lambda_Pa))
                                                     : 0.0);
        if (variety_.density)
            v_.implicit_mass.push_back(weight * (m.density_kg_m3 - least.density_kg_m3) /
                                       (step_s_ * step_s_));
    }

    const DepthMesh& mesh_;
    const VerticalOperator& vertical_;
    Variety variety_;
    double k_max_rad_m_, step_s_;
    LateralVariation& v_;
};

/// Maximum over the points of the inertia that one solve per step would add, relative to the
/// tissue's.
double added_inertia(const std::vector<Gathered>& gathered, const VerticalOperator& vertical,
                     double k_load_rad_m, double k_max_rad_m, double step_s) {
    double inertia = 0.0;
    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        const double stable_mu_Pa =
            vertical.stabilised_mu_Pa(g.where.element, greatest.mu_Pa, k_max_rad_m, step_s);
        const double added_Pa = std::max(0.0, stable_mu_Pa - greatest.mu_Pa / 12.0) +
                                (greatest.mu_Pa - least.mu_Pa) / 12.0;
        inertia =
            std::max(inertia, added_Pa * std::pow(k_load_rad_m * step_s, 2) / least.density_kg_m3);
    }
    return inertia;
}

} // namespace

double largest_k_rad_m(const Domain& domain) {
    return std::hypot(two_pi / domain.extent_x_m() * static_cast<double>(domain.nx / 2),
                      two_pi / domain.extent_y_m() * static_cast<double>(domain.ny / 2));
}

LateralVariation lateral_variation(const Case& c, const DepthMesh& mesh,
                                   const fft::SlabShare& share, double k_max_rad_m, double step_s,
                                   const Comm* team) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    LateralVariation v;
    v.background = background_of(mesh, c.scene.medium);
    const std::vector<Gathered> gathered = gather(c, mesh, share, team);
    if (gathered.empty()) return v;

    // Requirements on the background, and whether iterations are needed.
    Variety variety = least_background(gathered, mesh, v.background);
    const VerticalOperator vertical(mesh, v.background);
    variety.inertia = added_inertia(
        gathered, vertical, bandwidth_rad_m(c.scene.load.footprint, 0.5), k_max_rad_m, step_s);
    v.density_varies = variety.density;
    v.iterates = variety.must_iterate() || options.method == SpectralMethod::iterative ||
                 (options.method == SpectralMethod::automatic &&
                  variety.inertia > tolerated_inertia(options));
    v.why = reason_of(variety);

    for (const Gathered& g : gathered) {
        const Material &least = g.extremes.least, &greatest = g.extremes.greatest;
        Background& b = v.background;
        const std::size_t at = point_of(mesh, g.where);
        b.theta_s[g.where.element] =
            std::min(b.theta_s[g.where.element], least.viscosity_Pa_s / least.mu_Pa);
        if (!v.iterates) b.mu_stable_Pa[at] = greatest.mu_Pa;
    }
    together_on(team, [&] {
        CellCollector collector(mesh, vertical, variety, k_max_rad_m, step_s, v);
        for (const Gathered& g : gathered)
            collector.add(g, share.x_count, c.domain.ny);
    });
    return v;
}

} // namespace shearwake::spectral
