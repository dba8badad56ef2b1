// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/tensor_volumes.hpp"

#include "engines/spectral/lateral/cell_materials.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// Row-major matrix that smooths the nodal values of an element.
std::vector<double> smoothing_of(const GaussLobatto& rule) {
    std::vector<double> matrix;
    for (const double x : rule.nodes) {
        const std::vector<double> row = smoothing_weights(rule, x);
        matrix.insert(matrix.end(), row.begin(), row.end());
    }
    return matrix;
}

} // namespace

TensorVolumes::TensorVolumes(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                             double step_s, const Comm& team)
    : case_(c), mesh_(mesh), slabs_(slabs), step_s_(step_s), team_(team),
      vectors_(c.domain, slabs.share()), wanted_(records_tensors(c.record)) {
    if (!wanted_) return;
    smoothing_ = smoothing_of(mesh.rule);
    const auto plane = static_cast<std::size_t>(slabs.share().reals);
    const auto pencil = 3 * (mesh.levels() - 1) * static_cast<std::size_t>(parts);
    together(team, [&] {
        for (auto* planes : {&now_, &rate_, &strain_, &stress_})
            planes->assign(strain_components * plane, 0.0);
        pressure_.assign(mesh.rule.nodes.size() * plane, 0.0);
        pencil_.assign(pencil, Block{});
        earlier_.assign(static_cast<std::size_t>(vectors_.pencils()) * pencil, Block{});
    });
}

double* TensorVolumes::plane(fft::AlignedVector<double>& planes, std::ptrdiff_t number) const {
    return planes.data() + number * slabs_.share().reals;
}

/// The line of one ky in the spectrum of a plane.
double* TensorVolumes::line(fft::AlignedVector<double>& planes, std::ptrdiff_t number,
                            std::ptrdiff_t row) const {
    return plane(planes, number) + 2 * row * vectors_.nx();
}

void TensorVolumes::remember(const StepState& state) {
    std::copy(state.before.begin(), state.before.end(), earlier_.begin());
}

double TensorVolumes::allocated_B() const {
    double values = 0.0;
    for (const auto* planes : {&now_, &rate_, &strain_, &stress_, &pressure_})
        values += static_cast<double>(planes->size());
    return values * sizeof(double) + static_cast<double>(earlier_.size() * sizeof(Block));
}

/// The displacement of one pencil before, at and after the snapshot.
TensorVolumes::Steps TensorVolumes::steps(const StepState& state, std::ptrdiff_t pencil) const {
    const std::ptrdiff_t at = pencil * 3 * static_cast<std::ptrdiff_t>(mesh_.levels() - 1) * parts;
    return {earlier_.data() + at, state.before.data() + at, state.now.data() + at};
}

/// Adds the scheme's average over three steps, times a weight per lane.
void TensorVolumes::add_mean(const Steps& u, std::ptrdiff_t i, const auto& weight, Block& to) {
    constexpr double s = stabilising_lambda;
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        to[lane] += weight(lane) * ((1.0 - 2.0 * s) * u.now[i][lane] +
                                    s * (u.later[i][lane] + u.earlier[i][lane]));
}

/// Computes lambda div(u + ...) at the nodes of an element, smoothed over depth, as physical
/// planes.
void TensorVolumes::find_pressure(const StepState& state, std::size_t element) {
    const std::ptrdiff_t nodes = mesh_.degree + 1, reals = slabs_.share().reals;
    const auto levels = static_cast<std::ptrdiff_t>(mesh_.levels() - 1);
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(element) * mesh_.degree;
    const double slope = 2.0 / mesh_.length_m(element);
    const LineKernels& lines = simd::kernels<LineKernels>();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Steps u = steps(state, row * vectors_.blocks() + block);
            const WaveBlock waves = vectors_.waves(row, block);
            for (std::ptrdiff_t q = 0; q < nodes; ++q) {
                Block dilation[parts] = {}; // W' - k U
                const auto add = [&](std::ptrdiff_t node, std::ptrdiff_t component, auto weight) {
                    const std::ptrdiff_t at = 2 * (first + node) * parts + component; // U, W
                    for (std::ptrdiff_t p = 0; p < parts; ++p)
                        add_mean(u, at + p, weight, dilation[p]);
                };
                for (std::ptrdiff_t j = 0; j < nodes && first + j < levels; ++j) {
                    const double d =
                        slope * mesh_.rule.derivative[static_cast<std::size_t>(q * nodes + j)];
                    add(j, parts, [d](std::ptrdiff_t) { return d; });
                }
                if (first + q < levels)
                    add(q, 0, [&waves](std::ptrdiff_t lane) { return -waves.k[lane]; });
                lines.put(waves, {}, dilation, line(pressure_, q, row));
            }
        }
    }
    for (std::ptrdiff_t q = 0; q < nodes; ++q) {
        vectors_.clear_nyquist(pressure_.data() + q * reals);
        slabs_.to_physical(pressure_.data() + q * reals);
        const Materials materials = materials_at({element, q});
        for_each_cell([&](std::ptrdiff_t cell, std::ptrdiff_t at) {
            pressure_[static_cast<std::size_t>(q * reals + at)] *= materials[cell].lambda_Pa;
        });
    }
    std::vector<double> values(static_cast<std::size_t>(nodes));
    for_each_cell([&](std::ptrdiff_t, std::ptrdiff_t at) {
        double* pressure = pressure_.data() + at;
        for (std::ptrdiff_t q = 0; q < nodes; ++q)
            values[static_cast<std::size_t>(q)] = pressure[q * reals];
        for (std::ptrdiff_t q = 0; q < nodes; ++q) {
            double smooth = 0.0;
            for (std::ptrdiff_t j = 0; j < nodes; ++j)
                smooth += smoothing_[static_cast<std::size_t>(q * nodes + j)] *
                          values[static_cast<std::size_t>(j)];
            pressure[q * reals] = smooth;
        }
    });
}

/// Computes strain and strain rate at one node as physical planes.
void TensorVolumes::find_strain(const StepState& state, const StrainPoint& point) {
    const std::ptrdiff_t reals = slabs_.share().reals;
    const StrainTransfer strains(mesh_, {point}, strain_components);
    const PencilKernels& kernels = simd::kernels<PencilKernels>();
    const auto levels = static_cast<std::ptrdiff_t>(mesh_.levels() - 1);
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(point.element) * mesh_.degree;
    const std::ptrdiff_t count = std::min<std::ptrdiff_t>(mesh_.degree + 1, levels - first);
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Steps u = steps(state, row * vectors_.blocks() + block);
            Block* change = pencil_.data();
            const auto subtract = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                kernels.difference(end - begin, 0.5 / step_s_, u.later + begin, u.earlier + begin,
                                   change + begin);
            };
            subtract(2 * first * parts, 2 * (first + count) * parts); // U and W, then V
            subtract((2 * levels + first) * parts, (2 * levels + first + count) * parts);
            const WaveBlock waves = vectors_.waves(row, block);
            strains.strain(waves, u.now, line(now_, 0, row), reals);
            strains.strain(waves, change, line(rate_, 0, row), reals);
        }
    }
    for (auto* planes : {&now_, &rate_}) {
        for (int c = 0; c < strain_components; ++c) {
            vectors_.clear_nyquist(plane(*planes, c));
            slabs_.to_physical(plane(*planes, c));
        }
    }
}

TensorVolumes::Materials TensorVolumes::materials_at(const StrainPoint& point) const {
    const std::size_t element = point.element;
    Materials all{{material_of(case_.scene.medium.layers[mesh_.layers[element]])}, {}};
    if (!varies_between(case_.scene.medium, mesh_.ends_m[element], mesh_.ends_m[element + 1]))
        return all;
    const CappedMaterials capped(case_, all.layer);
    together(team_, [&] {
        all.cells = cell_materials(case_, mesh_, slabs_.share(), point);
        for (CellMaterial& m : all.cells)
            m = capped(m);
    });
    return all;
}

/// Calls f(index of the cell, its position in a plane).
void TensorVolumes::for_each_cell(const auto& f) const {
    for (std::ptrdiff_t i = 0; i < slabs_.share().x_count; ++i)
        for (std::ptrdiff_t j = 0; j < case_.domain.ny; ++j)
            f(i * case_.domain.ny + j, i * slabs_.share().padded_ny + j);
}

void TensorVolumes::add(const StrainPoint& point, double share) {
    const Materials materials = materials_at(point);
    const double* pressure = pressure_.data() + point.node * slabs_.share().reals;
    for_each_cell([&](std::ptrdiff_t cell, std::ptrdiff_t at) {
        const CellMaterial& m = materials[cell];
        std::array<double, strain_components> scaled{};
        for (int c = 0; c < strain_components; ++c) {
            const double tensor = c < yz ? 1.0 : 0.5; // converts the engineering shear strain
            const double strain = tensor * plane(now_, c)[at];
            const double rate = tensor * plane(rate_, c)[at];
            scaled[static_cast<std::size_t>(c)] =
                (m.mu_Pa - m.mu_across_Pa) * plane(now_, c)[at] +
                (m.viscosity_Pa_s - m.viscosity_across_Pa_s) * plane(rate_, c)[at];
            plane(strain_, c)[at] += share * strain;
            plane(stress_, c)[at] += share * ((c < yz ? pressure[at] : 0.0) +
                                              2.0 * (m.mu_Pa * strain + m.viscosity_Pa_s * rate));
        }
        if (!m.is_laminate()) return;
        const std::array<double, 6> more = stress_across(m.normal, scaled);
        for (int c = 0; c < strain_components; ++c)
            plane(stress_, c)[at] += share * more[static_cast<std::size_t>(c)];
    });
}

void TensorVolumes::emit(const StepState& state, const InsideBodies& inside, std::size_t snapshot,
                         engines::Observer& observer) {
    for (std::size_t element = 0; element < mesh_.elements(); ++element) {
        find_pressure(state, element);
        for (std::ptrdiff_t node = 0; node <= mesh_.degree; ++node) {
            const std::size_t level =
                element * static_cast<std::size_t>(mesh_.degree) + static_cast<std::size_t>(node);
            if (level >= mesh_.clear_levels()) return; // inside the absorber
            const bool second = node == 0 && element > 0;
            const bool first = node == mesh_.degree && element + 1 < mesh_.elements();
            if (!second)
                for (auto* planes : {&strain_, &stress_})
                    std::fill(planes->begin(), planes->end(), 0.0);
            find_strain(state, {element, node});
            add({element, node}, first || second ? 0.5 : 1.0);
            if (first) continue; // the adjacent element follows
            emit_level(inside, snapshot, level, observer);
        }
    }
}

void TensorVolumes::emit_level(const InsideBodies& inside, std::size_t snapshot, std::size_t level,
                               engines::Observer& observer) {
    const std::vector<VolumeField>& fields = case_.record.volume_fields;
    for (std::size_t field = 0; field < fields.size(); ++field) {
        if (fields[field] == VolumeField::u) continue;
        auto& planes = fields[field] == VolumeField::strain ? strain_ : stress_;
        for (int c = 0; c < strain_components; ++c) {
            inside.clear(mesh_.z_m(level), plane(planes, c));
            observer.volume(
                {.snapshot = snapshot,
                 .field = field,
                 .component = static_cast<std::size_t>(c),
                 .level = level,
                 .values = View2<const double>(plane(planes, c), slabs_.share().x_count,
                                               case_.domain.ny, slabs_.share().padded_ny)});
        }
    }
}

} // namespace shearwake::spectral
