// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/transfer_table.hpp"

#include "engines/layered/work_kinds.hpp"

#include "parallel/agree.hpp"

#include <cmath>
#include <numbers>

namespace shearwake::layered {

using namespace kinds;
using Complex = std::complex<double>;

Complex TimeTransform::omega(std::ptrdiff_t m) const {
    const double period_s = static_cast<double>(samples) * step_s;
    return {2.0 * std::numbers::pi * static_cast<double>(m) / period_s, -decay_rad_s};
}

TransferTable::Panels TransferTable::fit(const Comm& team,
                                         engines::Checkpoints* checkpoints) const {
    const double k_max = std::numbers::pi / key_.spacing_m * std::numbers::sqrt2 * (1.0 + 1e-9);
    const engines::Timed timed(of_response);
    Panels mine;
    bool stops = false;
    // Frequencies are assigned to ranks cyclically, because neighbouring frequencies cost about the
    // same.
    fail_together(team, [&] {
        for (std::ptrdiff_t first = 0; first < frequencies() && !stops; first += team.size()) {
            stops = checkpoints && checkpoints->stop_asked();
            const std::ptrdiff_t m = first + team.rank();
            if (stops || m >= frequencies()) continue;
            const StackResponse response(key_.medium, key_.time.omega(m), key_.depths_m,
                                         key_.quantity);
            const auto fitted = RadialInterpolant::fit(
                [&](double k, std::span<Complex> out) { response.evaluate(k, out); },
                key_.depths_m.size(), k_max, key_.tolerance);
            const auto packed = fitted.packed();
            mine.sizes.push_back(static_cast<double>(packed.size()));
            mine.values.insert(mine.values.end(), packed.begin(), packed.end());
        }
    });
    if (stops) throw engines::StopRequested{};
    return mine;
}

TransferTable::TransferTable(const TransferKey& key, std::ptrdiff_t ky_start,
                             std::ptrdiff_t ky_count, const Comm& team,
                             engines::Checkpoints* checkpoints)
    : key_(key), ky_start_(ky_start), ky_count_(ky_count) {
    const std::size_t depths = key.depths_m.size();
    const Panels mine = fit(team, checkpoints);
    const engines::Timed timed(of_response);
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
        expanded_ = expanded_bytes(key_, ky_count_) <= largest_expansion_B;
        values_.resize(expanded_ ? row_size * static_cast<std::size_t>(ky_count_) * depths
                                 : row_size);
        if (!expanded_) return;
        for (std::size_t depth = 0; depth < depths; ++depth)
            for (std::ptrdiff_t ky = 0; ky < ky_count_; ++ky)
                expand(ky, depth,
                       values_.data() + (depth * static_cast<std::size_t>(ky_count_) +
                                         static_cast<std::size_t>(ky)) *
                                            row_size);
    });
}

void TransferTable::expand(std::ptrdiff_t ky, std::size_t depth, Complex* out) const {
    const engines::Timed timed(of_expansion);
    const double dkx = 2.0 * std::numbers::pi / (static_cast<double>(key_.nx) * key_.spacing_m);
    const double dky = 2.0 * std::numbers::pi / (static_cast<double>(key_.ny) * key_.spacing_m);
    std::vector<double> k(static_cast<std::size_t>(half_nx()));
    for (std::size_t i = 0; i < k.size(); ++i)
        k[i] = std::hypot(static_cast<double>(i) * dkx, static_cast<double>(ky_start_ + ky) * dky);
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

} // namespace shearwake::layered
