// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/sensor.hpp"

#include <algorithm>
#include <numeric>

namespace shearwake::pstd {

Sensor::Sensor(const StudyData& study, const Slabs& slabs)
    : study_(study), samples_(study.steps - study.sensor_start + 1), order_(study.sensors.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const auto x_of = [&](std::size_t node) { return study.sensors[node][0]; };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
    for (std::size_t i = 0; i < order_.size(); ++i) {
        if (x_of(order_[i]) < slabs.x_start()) first_ = i + 1;
        if (!slabs.has(x_of(order_[i]))) continue;
        offsets_.push_back(slabs.offset(study.sensors[order_[i]]));
    }
    count_ = offsets_.size();
    values_.assign(study.sensor_fields.size(),
                   std::vector<double>(count_ * static_cast<std::size_t>(samples_), 0.0));
}

template <class Real>
void Sensor::add(const Stepper<Real>& stepper) {
    const std::ptrdiff_t sample = stepper.steps() - study_.sensor_start;
    if (sample < 0 || sample >= samples_) return;
    for (std::size_t f = 0; f < values_.size(); ++f) {
        const auto total = stepper.total(static_cast<Field>(study_.sensor_fields[f]));
        for (std::size_t n = 0; n < count_; ++n)
            of(f, n)[sample] = static_cast<double>(total[static_cast<std::size_t>(offsets_[n])]);
    }
}
template void Sensor::add(const Stepper<double>&);
template void Sensor::add(const Stepper<float>&);

std::vector<engines::SensorSeries> Sensor::series(const Comm& team) const {
    std::vector<engines::SensorSeries> all;
    for (std::size_t f = 0; f < values_.size(); ++f) {
        const std::vector<double> sorted = team.gather(values_[f]);
        if (!team.is_root()) continue;
        engines::SensorSeries series{.field = grid_fields[study_.sensor_fields[f]],
                                     .velocity = study_.sensor_fields[f] < 3,
                                     .samples = samples_,
                                     .values = std::vector<double>(sorted.size())};
        for (std::size_t i = 0; i < order_.size(); ++i)
            std::copy_n(sorted.begin() + static_cast<std::ptrdiff_t>(i) * samples_, samples_,
                        series.values.begin() + static_cast<std::ptrdiff_t>(order_[i]) * samples_);
        all.push_back(std::move(series));
    }
    return all;
}

DistributedRows Sensor::rows() const {
    return {.total = static_cast<std::ptrdiff_t>(order_.size()),
            .start = static_cast<std::ptrdiff_t>(first_),
            .count = static_cast<std::ptrdiff_t>(count_),
            .row_length = samples_};
}

void Sensor::save(StateWriter& state) const {
    for (std::size_t f = 0; f < values_.size() && !order_.empty(); ++f)
        state.put(std::string("sensor_") + grid_fields[study_.sensor_fields[f]], rows(),
                  values_[f].data());
}

void Sensor::restore(const StateReader& state) {
    for (std::size_t f = 0; f < values_.size() && !order_.empty(); ++f)
        state.get(std::string("sensor_") + grid_fields[study_.sensor_fields[f]], rows(),
                  values_[f].data());
}

} // namespace shearwake::pstd
