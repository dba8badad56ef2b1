// SPDX-License-Identifier: BSD-3-Clause
// What is put into the fields of a DeviceStepper, and what is read of them.
#include "engines/pstd/gpu/device_stepper.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace shearwake::pstd::gpu {
namespace {

class DeviceTally : public Tally {
public:
    DeviceTally(const DeviceStepper& stepper, const Tally::Of& tally)
        : stepper_(stepper), of_(tally),
          scale_(stepper.device().numbers({of_.scale}, stepper.device().facts().real_B)) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        restore(std::vector<double>(static_cast<std::size_t>(stepper.slabs().rows() * of_.planes),
                                    of_.kind == Kind::max   ? -infinite
                                    : of_.kind == Kind::min ? infinite
                                                            : 0.0));
    }
    void add() override {
        values_.clear();
        stepper_.run("tally", {sums_.size, 1, 1}, stepper_.arrays_of(of_.quantity),
                     static_cast<int>(of_.kind), of_.first_z, of_.planes, scale_, sums_.size,
                     sums_);
    }
    const std::vector<double>& values() const override {
        if (values_.empty()) values_ = stepper_.device().read(sums_);
        return values_;
    }
    void restore(const std::vector<double>& values) override {
        values_ = values;
        sums_ = stepper_.device().numbers(values, stepper_.device().facts().sum_B);
    }

private:
    const DeviceStepper& stepper_;
    Tally::Of of_;
    Buffer scale_, sums_;
    mutable std::vector<double> values_; // the sums, if they were read since the last step
};

class DeviceSensor : public Sensor {
public:
    DeviceSensor(const DeviceStepper& stepper, const SensorNodes& nodes) : stepper_(stepper) {
        std::vector<std::ptrdiff_t> offsets;
        for (const Node& node : nodes.nodes)
            offsets.push_back(stepper.slabs().offset(node));
        offsets_ = stepper.device().uploaded(offsets);
    }
    std::vector<std::vector<double>> values(std::span<const Quantity> quantities) const override {
        const Device& device = stepper_.device();
        const std::size_t count = offsets_.size, all = count * quantities.size();
        if (values_.size != all) values_ = device.zeros(all, device.facts().real_B);
        for (std::size_t q = 0; q < quantities.size(); ++q)
            stepper_.run("gather", {count, 1, 1}, stepper_.arrays_of(quantities[q]), offsets_,
                         count, values_, q * count);
        const std::vector<double> read = device.read(values_);
        std::vector<std::vector<double>> found;
        for (auto begin = read.begin(); found.size() < quantities.size();
             begin += static_cast<std::ptrdiff_t>(count))
            found.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
        return found;
    }
    std::vector<double> line_sums(Field velocity, std::span<const double> weights) const override {
        const Device& device = stepper_.device();
        const Slabs& slabs = stepper_.slabs();
        const std::size_t sum_B = device.facts().sum_B, axis = index_of(velocity);
        const std::ptrdiff_t strides[] = {slabs.ny() * slabs.pitch, slabs.pitch, 1};
        const Buffer there = device.numbers({weights.begin(), weights.end()}, sum_B),
                     sums = device.zeros(offsets_.size, sum_B);
        stepper_.run("line_sums", {sums.size, 1, 1}, stepper_.total(velocity), there, offsets_,
                     sums.size, slabs.grid.points[axis], strides[axis], sums);
        return device.read(sums);
    }

private:
    const DeviceStepper& stepper_;
    Buffer offsets_;
    mutable Buffer values_;
};

} // namespace

DeviceSource::DeviceSource(const Device& device, PlacedSource<double> source)
    : placed(std::move(source)), places(device.uploaded(placed.places())) {
    std::vector<double> factors;
    for (const auto& place : placed.places())
        factors.push_back(place.per_work);
    const auto& [name, memory_B, most_array_B, local_B, real_B, sum_B] = device.facts();
    per_work = device.numbers(factors, sum_B);
    work = device.zeros(places.size, sum_B);
    before = device.zeros(places.size, real_B);
    values = device.zeros(places.size * samples_at_once(places.size), real_B);
}

std::ptrdiff_t DeviceSource::load(const Device& device, std::ptrdiff_t sample) {
    const auto nodes = std::ssize(placed.places()),
               samples = static_cast<std::ptrdiff_t>(values.size) / nodes;
    if (std::exchange(loaded, sample / samples) != sample / samples) {
        std::vector<double> block;
        for (std::ptrdiff_t s = loaded * samples;
             s < std::min((loaded + 1) * samples, placed.source().samples); ++s) {
            const std::span<const double> unscaled = placed.values_of(s);
            for (std::size_t i = 0; i < unscaled.size(); ++i)
                block.push_back(unscaled[i] * placed.places()[i].scale);
        }
        device.write(values, block);
    }
    return sample % samples * nodes;
}

std::unique_ptr<Tally> DeviceStepper::tally(const Tally::Of& tally) const {
    return std::make_unique<DeviceTally>(*this, tally);
}

std::unique_ptr<Sensor> DeviceStepper::sensor(const SensorNodes& nodes) const {
    return std::make_unique<DeviceSensor>(*this, nodes);
}

} // namespace shearwake::pstd::gpu
