// SPDX-License-Identifier: BSD-3-Clause
// The records of a Recorder by their names, their memory, and their output.
#include "engines/pstd/scheme/recorder.hpp"
#include "fft/fftw_real.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fftw3.h>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake::pstd {
namespace {

// clang-format off
constexpr std::array<const char*, Recorder::quantity_count> quantities = {
    "p", "ux", "uy", "uz",
    "ux_non_staggered", "uy_non_staggered", "uz_non_staggered",
    "ux_split_p", "uy_split_p", "uz_split_p", "ux_split_s", "uy_split_s", "uz_split_s",
    "Ix", "Iy", "Iz"};
// clang-format on

/// Moves a periodic series by half a sample to later times. The highest frequency of an even number
/// of samples is omitted, as in k-Wave.
void move_half_a_sample(std::span<double> series) {
    const std::size_t n = series.size();
    std::vector<std::complex<double>> spectrum(n / 2 + 1);
    auto* raw = fft::FftwOf<double>::raw(spectrum.data());
    const int length = static_cast<int>(n);
    const auto run = [](fftw_plan plan) { fftw_execute(fft::checked_plan(plan).get()); };
    run(fftw_plan_dft_r2c_1d(length, series.data(), raw, FFTW_ESTIMATE));
    for (std::size_t m = 0; m < spectrum.size(); ++m)
        spectrum[m] *=
            2 * m == n
                ? 0.0
                : std::polar(1.0 / static_cast<double>(n),
                             std::numbers::pi * static_cast<double>(m) / static_cast<double>(n));
    run(fftw_plan_dft_c2r_1d(length, raw, series.data(), FFTW_ESTIMATE));
}

} // namespace

std::vector<Recorder::Record> Recorder::records_of(const std::set<std::string>& names,
                                                   const Grid& grid) {
    std::vector<Record> records;
    const auto add = [&](std::size_t quantity, std::size_t count, Statistic statistic,
                         const std::string& suffix = "", bool is_output = true) {
        for (std::size_t q = quantity; q < quantity + count; ++q) {
            const std::size_t axis = (q - velocity) % 3; // of a vector
            if (q != pressure && axis == 0 && grid.moves_in_plane) continue;
            const std::size_t named = q == pressure ? q : q - axis + kwave_axis(grid, axis);
            const std::string name = quantities[named] + suffix;
            const auto known = std::find_if(records.begin(), records.end(),
                                            [&](const Record& one) { return one.name == name; });
            if (known == records.end()) records.push_back({name, q, statistic, is_output, {}, {}});
        }
    };
    constexpr std::pair<const char*, Statistic> suffixes[] = {
        {"", Statistic::series},          {"_max", Statistic::max},
        {"_min", Statistic::min},         {"_rms", Statistic::rms},
        {"_max_all", Statistic::max_all}, {"_min_all", Statistic::min_all},
        {"_final", Statistic::final}};
    for (const auto& [suffix, statistic] : suffixes) {
        if (names.contains(fmt::format("p{}", suffix))) add(pressure, 1, statistic, suffix);
        if (names.contains(fmt::format("u{}", suffix))) add(velocity, 3, statistic, suffix);
    }
    if (names.contains("u_non_staggered")) add(moved, 3, Statistic::series);
    if (names.contains("u_split_field")) add(split_p, 6, Statistic::series);
    if (names.contains("I") || names.contains("I_avg")) {
        add(pressure, 1, Statistic::series, "", false);
        add(moved, 3, Statistic::series, "", false);
        add(intensity, 3, Statistic::series, "", names.contains("I"));
        if (names.contains("I_avg")) add(intensity, 3, Statistic::mean, "_avg");
    }
    return records;
}

double Recorder::memory_B(const SensorPoints& points, const Grid& grid,
                          const std::set<std::string>& records, std::ptrdiff_t samples, int ranks) {
    double grid_points = 1.0;
    for (const std::ptrdiff_t n : grid.points)
        grid_points *= static_cast<double>(n);
    const auto count = static_cast<double>(points.size());
    double values = 0.0;
    for (const Record& record : records_of(records, grid)) {
        if (record.is_series())
            values += count * static_cast<double>(samples);
        else if (!record.is_grid())
            values += count;
        else if (record.statistic != Statistic::final)
            values += grid_points;
    }
    double gathered = 0.0; // on rank 0
    if (records.contains("u_split_field"))
        gathered = 6.0 * grid_points;
    else if (std::any_of(records.begin(), records.end(), [](const std::string& record) {
                 return record.ends_with("_all") || record.ends_with("_final");
             }))
        gathered = 2.0 * grid_points;
    return sizeof(double) * (values / ranks + gathered) +
           48.0 * static_cast<double>(points.nodes.size());
}

/// The intensity is the product of the pressure and the velocity at the nodes, which is moved to
/// the times of the pressure.
void Recorder::finish() {
    add_found();
    const auto samples = static_cast<std::size_t>(samples_);
    const auto series = [&](std::size_t quantity) {
        return std::find_if(records_.begin(), records_.end(), [&](const Record& one) {
            return one.quantity == quantity && one.is_series();
        });
    };
    for (Record& record : records_) {
        if (record.quantity < intensity || !record.is_series()) continue;
        const std::vector<double>& p = series(pressure)->values;
        record.values = series(record.quantity - intensity + moved)->values;
        for (std::size_t i = 0; i < count_points_; ++i) {
            const std::span<double> row(record.values.data() + i * samples, samples);
            move_half_a_sample(row);
            for (std::size_t s = 0; s < samples; ++s)
                row[s] *= p[i * samples + s];
        }
    }
    for (Record& record : records_)
        if (record.statistic == Statistic::mean)
            for (std::size_t i = 0; i < count_points_; ++i) {
                const auto from = series(record.quantity)->values.begin() +
                                  static_cast<std::ptrdiff_t>(i * samples);
                record.values[i] =
                    std::accumulate(from, from + samples_, 0.0) / static_cast<double>(samples_);
            }
}

/// Gathered on rank 0, which puts the points in the order of the sensor.
std::vector<double> Recorder::samples_of(const Record& record, std::size_t first, std::size_t count,
                                         const Comm& team) const {
    const auto samples = record.is_series() ? static_cast<std::size_t>(samples_) : std::size_t{1};
    std::vector<double> mine;
    mine.reserve(count_points_ * count);
    for (std::size_t i = 0; i < count_points_; ++i)
        for (std::size_t s = 0; s < count; ++s) {
            const double value = record.values[i * samples + first + s];
            mine.push_back(record.statistic == Statistic::rms
                               ? std::sqrt(value / static_cast<double>(samples_))
                               : value);
        }
    const std::vector<double> sorted = team.gather(mine);
    if (!team.is_root()) return {};
    const std::size_t points = point_order_.size();
    std::vector<double> block(points * count);
    for (std::size_t i = 0; i < points; ++i)
        for (std::size_t s = 0; s < count; ++s)
            block[s * points + point_order_[i]] = sorted[i * count + s];
    return block;
}

DistributedRows Recorder::rows(const Record& record) const {
    if (!record.is_grid())
        return {.total = static_cast<std::ptrdiff_t>(point_order_.size()),
                .start = static_cast<std::ptrdiff_t>(first_point_),
                .count = static_cast<std::ptrdiff_t>(count_points_),
                .row_length = record.is_series() ? samples_ : 1};
    return {.total = slabs_.nx(),
            .start = slabs_.x_start(),
            .count = slabs_.x_count(),
            .row_length = slabs_.ny() * slabs_.nz()};
}

void Recorder::save(StateWriter& state) {
    add_found();
    for (const Record& record : records_)
        if (record.statistic != Statistic::final && record.quantity < intensity &&
            rows(record).total > 0)
            state.put("record_" + record.name, rows(record),
                      (record.tally ? record.tally->values() : record.values).data());
}

void Recorder::restore(const StateReader& state) {
    for (Record& record : records_) {
        if (record.statistic == Statistic::final || record.quantity >= intensity ||
            rows(record).total == 0)
            continue;
        const DistributedRows of_record = rows(record);
        std::vector<double> values(
            static_cast<std::size_t>(of_record.count * of_record.row_length));
        state.get("record_" + record.name, of_record, values.data());
        if (record.tally)
            record.tally->restore(values);
        else
            record.values = std::move(values);
    }
}

} // namespace shearwake::pstd
