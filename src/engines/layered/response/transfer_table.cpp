// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/transfer_table.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "fft/line_transform.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::layered {

using Stage = CaseProgress::Stage;

namespace {

using Complex = std::complex<double>;

/// Returns the result of `fit`. Its CaseFailure names the frequency and the layer with the smallest
/// loss factor.
template <class Fit>
RadialInterpolant fit_at(const TransferKey& key, Complex omega_rad_s, const Fit& fit) {
    try {
        return fit();
    } catch (const CaseFailure& failure) {
        const double f_Hz = omega_rad_s.real() / two_pi;
        const Layer& layer = least_lossy_layer(key.medium, f_Hz);
        throw CaseFailure(fmt::format(
            "at {:.4g} Hz, {}; the loss factor of layer \"{}\" is {:.1e}: increase its loss, "
            "domain.spacing_mm or its thickness_mm, or reduce the duration",
            f_Hz, failure.what(), layer.name, loss_factor(layer, f_Hz)));
    }
}

} // namespace

Complex TimeTransform::omega(std::ptrdiff_t m) const {
    const double period_s = static_cast<double>(samples) * step_s;
    return {two_pi * static_cast<double>(m) / period_s, -decay_rad_s};
}

double TransferTable::first_rad_m() const {
    return key_.edges == DomainEdges::open ? remainder_from_rad_m(key_.spacing_m) : 0.0;
}

/// Calls f(m) for the frequencies of this rank. They are assigned to ranks cyclically, because
/// neighbouring frequencies cost about the same. Returns true if a stop was requested. Collective.
template <class F>
bool TransferTable::each_frequency(const Comm& team, CaseProgress* progress, const F& f) const {
    for (std::ptrdiff_t first = 0; first < frequencies(); first += team.size()) {
        if (progress && progress->stop_asked()) return true;
        const std::ptrdiff_t m = first + team.rank();
        if (m >= frequencies()) continue;
        f(m);
        if (progress) progress->record_completed(Stage::response);
    }
    return false;
}

TransferTable::Panels TransferTable::fit(const Comm& team, CaseProgress* progress) const {
    const double k_max = std::numbers::pi / key_.spacing_m * std::numbers::sqrt2 * (1.0 + 1e-9);
    const double first_k_rad_m = first_rad_m();
    Panels mine;
    bool stops = false;
    fail_together(team, [&] {
        stops = each_frequency(team, progress, [&](std::ptrdiff_t m) {
            const StackResponse response(key_.medium, key_.time.omega(m), key_.depths_m,
                                         key_.quantity);
            const auto fitted = fit_at(key_, key_.time.omega(m), [&] {
                return RadialInterpolant::fit(
                    [&](double k, std::span<Complex> out) {
                        response.evaluate(first_k_rad_m + k, out);
                    },
                    key_.depths_m.size(), k_max - first_k_rad_m, key_.tolerance);
            });
            const auto packed = fitted.packed();
            mine.sizes.push_back(static_cast<double>(packed.size()));
            mine.values.insert(mine.values.end(), packed.begin(), packed.end());
        });
    });
    if (stops) throw engines::StopRequested{};
    return mine;
}

TransferTable::TransferTable(const TransferKey& key, std::ptrdiff_t ky_start,
                             std::ptrdiff_t ky_count, const Comm& team, OpenGrid* grid,
                             CaseProgress* progress)
    : key_(key), ky_start_(ky_start), ky_count_(ky_count) {
    const std::size_t depths = key.depths_m.size();
    const Panels mine = fit(team, progress);
    std::vector<Complex> tables;
    if (grid) tables = team.all_gather(point_tables(*grid, team, progress));
    const std::vector<double> all_sizes = team.all_gather(mine.sizes);
    const std::vector<Complex> all = team.all_gather(mine.values);

    together(team, [&] {
        by_frequency_.resize(static_cast<std::size_t>(frequencies()));
        std::size_t offset = 0, item = 0;
        for (int rank = 0; rank < team.size(); ++rank) {
            for (std::ptrdiff_t m = rank; m < frequencies(); m += team.size()) {
                const auto size = static_cast<std::size_t>(all_sizes[item++]);
                by_frequency_[static_cast<std::size_t>(m)] =
                    RadialInterpolant::unpacked(std::span(all).subspan(offset, size), depths);
                offset += size;
            }
        }
        const auto row_size = static_cast<std::size_t>(half_nx() * frequencies());
        expanded_ = grid || expanded_bytes(key_, ky_count_) <= largest_expansion_B;
        values_.resize(expanded_ ? row_size * static_cast<std::size_t>(ky_count_) * depths
                                 : row_size);
        if (!expanded_ || grid) return;
        for (std::size_t depth = 0; depth < depths; ++depth)
            for (std::ptrdiff_t ky = 0; ky < ky_count_; ++ky) {
                expand(ky, depth,
                       values_.data() + (depth * static_cast<std::size_t>(ky_count_) +
                                         static_cast<std::size_t>(ky)) *
                                            row_size);
                if (progress) progress->record_completed(Stage::expansion);
            }
    });
    if (grid) expand_open(*grid, tables, team, progress);
}

std::vector<Complex> TransferTable::point_tables(OpenGrid& grid, const Comm& team,
                                                 CaseProgress* progress) const {
    const std::size_t depths = key_.depths_m.size(), nodes = grid.point.nodes_rad_m().size();
    std::vector<Complex> tables;
    bool stops = false;
    const auto block_done = [&] {
        if (progress) progress->record_completed(Stage::radial);
        stops = progress && progress->stop_asked();
        return !stops;
    };
    fail_together(team, [&] {
        if (key_.quantity == StackQuantity::loss) {
            std::vector<RadialInterpolant> losses;
            stops = each_frequency(team, progress, [&](std::ptrdiff_t m) {
                const StackResponse response(key_.medium, key_.time.omega(m), key_.depths_m);
                losses.push_back(fit_at(key_, key_.time.omega(m), [&] {
                    return fit_loss(response, key_.spacing_m, key_.tolerance);
                }));
            });
            if (!stops) tables = grid.loss.tables(losses, block_done);
            return;
        }
        std::vector<Complex> h, node_response(depths);
        stops = each_frequency(team, progress, [&](std::ptrdiff_t m) {
            const StackResponse response(key_.medium, key_.time.omega(m), key_.depths_m,
                                         key_.quantity);
            const std::size_t first = h.size();
            h.resize(first + depths * nodes);
            for (std::size_t i = 0; i < nodes; ++i) {
                response.evaluate(grid.point.nodes_rad_m()[i], node_response);
                for (std::size_t d = 0; d < depths; ++d)
                    h[first + d * nodes + i] = node_response[d];
            }
        });
        if (!stops) tables = grid.point.tables(h, h.size() / nodes, block_done);
    });
    if (stops) throw engines::StopRequested{};
    return tables;
}

void TransferTable::expand_open(const OpenGrid& grid, std::span<const Complex> tables,
                                const Comm& team, CaseProgress* progress) {
    const std::ptrdiff_t half_x = key_.nx / 2, half_y = key_.ny / 2;
    const std::size_t depths = key_.depths_m.size();
    bool stops = false;
    fail_together(team, [&] {
        const std::size_t radii = grid.point.radii();
        const fft::CosineTransform along_y(half_y, half_x + 1),
            along_x(half_x, std::max<std::ptrdiff_t>(1, ky_count_));
        fft::AlignedVector<Complex> plane(static_cast<std::size_t>((half_x + 1) * (half_y + 1)));
        fft::AlignedVector<Complex> rows(static_cast<std::size_t>((half_x + 1) * ky_count_));
        const double cell_m2 = key_.spacing_m * key_.spacing_m;
        const Complex* table = tables.data();
        for (int rank = 0; rank < team.size(); ++rank)
            for (std::ptrdiff_t m = rank; m < frequencies() && !stops; m += team.size()) {
                stops = progress && progress->stop_asked();
                for (std::size_t depth = 0; depth < depths && !stops && ky_count_ > 0;
                     ++depth, table += radii) {
                    grid.sampling.sample({table, radii}, plane.data());
                    along_y.execute(plane.data());
                    for (std::ptrdiff_t ky = 0; ky < ky_count_; ++ky)
                        for (std::ptrdiff_t i = 0; i <= half_x; ++i)
                            rows[static_cast<std::size_t>(ky * (half_x + 1) + i)] =
                                cell_m2 *
                                plane[static_cast<std::size_t>(i * (half_y + 1) + ky_start_ + ky)];
                    along_x.execute(rows.data());
                    Complex* out = values_.data() +
                                   static_cast<std::ptrdiff_t>(depth) * ky_count_ * (half_x + 1) *
                                       frequencies() +
                                   m;
                    for (const Complex& value : rows) {
                        *out = value;
                        out += frequencies();
                    }
                    if (progress) progress->record_completed(Stage::expansion);
                }
            }
        for (std::size_t depth = 0; depth < depths && !stops; ++depth)
            for (std::ptrdiff_t ky = 0; ky < ky_count_; ++ky)
                add_remainder(ky, depth,
                              values_.data() +
                                  (static_cast<std::ptrdiff_t>(depth) * ky_count_ + ky) *
                                      (half_x + 1) * frequencies());
    });
    if (stops) throw engines::StopRequested{};
}

void TransferTable::add_remainder(std::ptrdiff_t ky, std::size_t depth, Complex* row) const {
    const std::vector<double> all = wavenumbers_rad_m(ky);
    const double first_k_rad_m = first_rad_m();
    const auto first = std::ranges::lower_bound(all, first_k_rad_m) - all.begin();
    std::vector<double> k, share;
    for (const double value : std::span(all).subspan(static_cast<std::size_t>(first))) {
        k.push_back(value - first_k_rad_m);
        share.push_back(1.0 - low_pass(value, key_.spacing_m).real());
    }
    std::vector<Complex> h(k.size());
    for (std::ptrdiff_t m = 0; m < frequencies(); ++m) {
        by_frequency_[static_cast<std::size_t>(m)].evaluate(depth, k, h.data(), 1);
        for (std::size_t i = 0; i < k.size(); ++i)
            row[(first + static_cast<std::ptrdiff_t>(i)) * frequencies() + m] += share[i] * h[i];
    }
}

std::vector<double> TransferTable::wavenumbers_rad_m(std::ptrdiff_t ky) const {
    const double dkx = two_pi / (static_cast<double>(key_.nx) * key_.spacing_m);
    const double dky = two_pi / (static_cast<double>(key_.ny) * key_.spacing_m);
    std::vector<double> k(static_cast<std::size_t>(half_nx()));
    for (std::size_t i = 0; i < k.size(); ++i)
        k[i] = std::hypot(static_cast<double>(i) * dkx, static_cast<double>(ky_start_ + ky) * dky);
    return k;
}

void TransferTable::expand(std::ptrdiff_t ky, std::size_t depth, Complex* out) const {
    const std::vector<double> k = wavenumbers_rad_m(ky);
    for (std::ptrdiff_t m = 0; m < frequencies(); ++m)
        by_frequency_[static_cast<std::size_t>(m)].evaluate(depth, k, out + m, frequencies());
}

std::span<const Complex> TransferTable::row(std::ptrdiff_t ky, std::size_t depth) {
    const auto row_size = static_cast<std::size_t>(half_nx() * frequencies());
    if (expanded_)
        return std::span(values_).subspan(
            (depth * static_cast<std::size_t>(ky_count_) + static_cast<std::size_t>(ky)) * row_size,
            row_size);
    expand(ky, depth, values_.data());
    return {values_.data(), row_size};
}

std::size_t TransferTable::panels() const {
    std::size_t sum = 0;
    for (const auto& one : by_frequency_)
        sum += one.panels();
    return sum;
}

double TransferTable::expanded_bytes(const TransferKey& key, std::ptrdiff_t ky_count) {
    return static_cast<double>(key.nx / 2 + 1) * static_cast<double>(key.time.samples / 2 + 1) *
           static_cast<double>(ky_count) * static_cast<double>(key.depths_m.size()) *
           sizeof(Complex);
}

double open_reach_m(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m) {
    return spacing_m * std::hypot(nx / 2, ny / 2);
}

} // namespace shearwake::layered
