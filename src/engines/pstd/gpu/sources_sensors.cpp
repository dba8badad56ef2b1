// SPDX-License-Identifier: BSD-3-Clause
// What is put into the fields of a DeviceStepper, and what is read of them.
#include "engines/pstd/gpu/device_stepper.hpp"

#include <algorithm>
#include <limits>

namespace shearwake::pstd::gpu {
namespace {

/// Values of a source that are sent to the device at once.
constexpr std::ptrdiff_t most_values = std::ptrdiff_t{1} << 18, most_block = 64;

template <class Real>
class DeviceTally : public Tally {
public:
    DeviceTally(const DeviceStepper<Real>& stepper, const Tally::Of& tally)
        : stepper_(stepper), of_(tally) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        restore(std::vector<double>(static_cast<std::size_t>(stepper.slabs().rows() * of_.planes),
                                    of_.kind == Kind::max   ? -infinite
                                    : of_.kind == Kind::min ? infinite
                                                            : 0.0));
    }
    void add() override {
        is_read_ = false;
        const int kind = static_cast<int>(of_.kind), planes = static_cast<int>(of_.planes);
        stepper_.device().run(stepper_.kernel("tally"),
                              {static_cast<std::size_t>(planes),
                               static_cast<std::size_t>(stepper_.slabs().rows()), 1},
                              of_.planes < 32 ? Device::Range{1, 64, 1} : group_of_nodes,
                              stepper_.arrays_of(of_.quantity), kind,
                              static_cast<cl_int>(of_.first_z), planes,
                              static_cast<Real>(of_.scale), sums_);
    }
    const std::vector<double>& values() const override {
        if (!is_read_) values_ = stepper_.device().read_sums(sums_);
        is_read_ = true;
        return values_;
    }
    void restore(const std::vector<double>& values) override {
        sums_ = stepper_.device().uploaded_sums(values);
        is_read_ = false;
    }

private:
    const DeviceStepper<Real>& stepper_;
    Tally::Of of_;
    Buffer<char> sums_;
    mutable std::vector<double> values_; // the sums, if they were read since the last step
    mutable bool is_read_ = false;
};

template <class Real>
class DeviceSensor : public Sensor {
public:
    DeviceSensor(const DeviceStepper<Real>& stepper, const SensorNodes& nodes) : stepper_(stepper) {
        std::vector<cl_long> offsets;
        for (const Node& node : nodes.nodes)
            offsets.push_back(stepper.slabs().offset(node));
        offsets_ = stepper.device().uploaded(offsets);
    }
    std::vector<std::vector<double>> values(std::span<const Quantity> quantities) const override {
        const Device& device = stepper_.device();
        const std::size_t count = offsets_.size();
        std::vector<std::vector<double>> all(quantities.size(), std::vector<double>(count));
        if (count == 0 || all.empty()) return all;
        if (values_.size() != count * all.size()) values_ = device.buffer<Real>(count * all.size());
        for (std::size_t q = 0; q < all.size(); ++q)
            device.run(stepper_.kernel("gather"), {count, 1, 1}, group_of_nodes,
                       stepper_.arrays_of(quantities[q]), offsets_, static_cast<cl_int>(count),
                       values_, static_cast<cl_long>(q * count));
        const std::vector<Real> read = device.read(values_);
        for (std::size_t q = 0; q < all.size(); ++q)
            std::copy_n(read.begin() + static_cast<std::ptrdiff_t>(q * count), count,
                        all[q].begin());
        return all;
    }
    std::vector<double> line_sums(Field velocity, std::span<const double> weights) const override {
        const Device& device = stepper_.device();
        const Slabs& slabs = stepper_.slabs();
        const std::size_t axis = index_of(velocity), count = offsets_.size();
        if (count == 0) return {};
        const std::ptrdiff_t strides[] = {slabs.ny() * slabs.pitch, slabs.pitch, 1};
        const auto w = device.uploaded_sums({weights.begin(), weights.end()});
        const auto sums = device.uploaded_sums(std::vector<double>(count));
        device.run(stepper_.kernel("line_sums"), {count, 1, 1}, group_of_nodes,
                   stepper_.total(velocity), w, offsets_, static_cast<cl_int>(count),
                   static_cast<cl_int>(slabs.grid.points[axis]),
                   static_cast<cl_long>(strides[axis]), sums);
        return device.read_sums(sums);
    }

private:
    const DeviceStepper<Real>& stepper_;
    Buffer<cl_long> offsets_;
    mutable Buffer<Real> values_;
};

} // namespace

template <class Real>
DeviceSource<Real>::DeviceSource(const Device& device, PlacedSource<Real> source)
    : placed(std::move(source)) {
    std::vector<DevicePlace> device_places;
    std::vector<double> factors;
    for (const auto& place : placed.places()) {
        device_places.push_back(
            {place.total, place.part[0], place.part[1], place.has_own_part ? 1 : 0, 0});
        factors.push_back(place.per_work);
    }
    const std::size_t nodes = factors.size();
    places = device.uploaded(device_places);
    per_work = device.uploaded_sums(factors);
    work = device.uploaded_sums(std::vector<double>(nodes));
    before = device.zeros<Real>(nodes);
    most_samples = std::clamp<std::ptrdiff_t>(
        most_values / std::max<std::ptrdiff_t>(std::ssize(factors), 1), 1, most_block);
    values = device.buffer<Real>(nodes * static_cast<std::size_t>(most_samples));
}

template <class Real>
cl_long DeviceSource<Real>::load(const Device& device, std::ptrdiff_t sample) {
    const auto nodes = std::ssize(placed.places());
    if (sample < first_sample || sample >= first_sample + samples) {
        first_sample = sample;
        samples = std::min(most_samples, placed.source().samples - sample);
        std::vector<Real> block;
        block.reserve(static_cast<std::size_t>(samples * nodes));
        for (std::ptrdiff_t s = sample; s < sample + samples; ++s) {
            const std::span<const double> unscaled = placed.values_of(s);
            for (std::size_t i = 0; i < unscaled.size(); ++i)
                block.push_back(static_cast<Real>(unscaled[i] * placed.places()[i].scale));
        }
        device.write(values, block);
    }
    return (sample - first_sample) * nodes;
}

template <class Real>
std::unique_ptr<Tally> DeviceStepper<Real>::tally(const Tally::Of& tally) const {
    return std::make_unique<DeviceTally<Real>>(*this, tally);
}

template <class Real>
std::unique_ptr<Sensor> DeviceStepper<Real>::sensor(const SensorNodes& nodes) const {
    return std::make_unique<DeviceSensor<Real>>(*this, nodes);
}

template struct DeviceSource<double>;
template struct DeviceSource<float>;
// The other members are instantiated in device_stepper.cpp.
template std::unique_ptr<Tally> DeviceStepper<double>::tally(const Tally::Of&) const;
template std::unique_ptr<Tally> DeviceStepper<float>::tally(const Tally::Of&) const;
template std::unique_ptr<Sensor> DeviceStepper<double>::sensor(const SensorNodes&) const;
template std::unique_ptr<Sensor> DeviceStepper<float>::sensor(const SensorNodes&) const;

} // namespace shearwake::pstd::gpu
