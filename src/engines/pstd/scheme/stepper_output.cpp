// SPDX-License-Identifier: BSD-3-Clause
// What is read of a Stepper's fields.
#include "engines/pstd/scheme/stepper.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace shearwake::pstd {
namespace {

/// Calls visit(number, offset) for some planes of z of every row.
template <class Visit>
void each_value(const Slabs& slabs, std::ptrdiff_t first_z, std::ptrdiff_t planes,
                const Visit& visit) {
    std::size_t number = 0;
    for (std::ptrdiff_t row = 0; row < slabs.rows(); ++row)
        for (std::ptrdiff_t z = first_z; z < first_z + planes; ++z, ++number)
            visit(number, static_cast<std::size_t>(row * slabs.pitch + z));
}

/// Calls use(value_at), where value_at(offset) is a quantity.
template <class Real, class Use>
void with_values(const Stepper<Real>& stepper, const Quantity& quantity, const Use& use) {
    const auto value = [](Real v) { return static_cast<double>(v); };
    if (quantity) {
        use([u = stepper.total(*quantity), value](std::size_t at) { return value(u[at]); });
        return;
    }
    const auto xx = stepper.total(Field::sxx), yy = stepper.total(Field::syy),
               zz = stepper.total(Field::szz);
    if (stepper.slabs().grid.is_plane)
        use([=](std::size_t at) { return -(value(yy[at]) + value(zz[at])) / 2.0; });
    else
        use([=](std::size_t at) { return -(value(xx[at]) + value(yy[at]) + value(zz[at])) / 3.0; });
}

template <class Real>
class StepperTally : public Tally {
public:
    StepperTally(const Stepper<Real>& stepper, const Tally::Of& tally)
        : stepper_(stepper), of_(tally) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        values_.assign(static_cast<std::size_t>(stepper.slabs().rows() * of_.planes),
                       of_.kind == Kind::max   ? -infinite
                       : of_.kind == Kind::min ? infinite
                                               : 0.0);
    }
    void add() override {
        with_values(stepper_, of_.quantity, [&](const auto& value_at) {
            const auto each = [&](const auto& change) {
                each_value(stepper_.slabs(), of_.first_z, of_.planes,
                           [&](std::size_t number, std::size_t offset) {
                               change(values_[number], value_at(offset));
                           });
            };
            if (of_.kind == Kind::sum)
                each([&](double& sum, double value) { sum += of_.scale * value; });
            else if (of_.kind == Kind::max)
                each([](double& most, double value) { most = std::max(most, value); });
            else
                each([](double& least, double value) { least = std::min(least, value); });
        });
    }
    const std::vector<double>& values() const override { return values_; }
    void restore(const std::vector<double>& values) override { values_ = values; }

private:
    const Stepper<Real>& stepper_;
    Tally::Of of_;
    std::vector<double> values_;
};

template <class Real>
class StepperSensor : public Sensor {
public:
    StepperSensor(const Stepper<Real>& stepper, const SensorNodes& nodes)
        : stepper_(stepper), nodes_(nodes) {
        for (std::size_t i = 0; i < nodes_.count; ++i)
            offsets_.push_back(
                static_cast<std::size_t>(stepper.slabs().offset(nodes_.nodes[nodes_.first + i])));
    }
    std::vector<std::vector<double>> values(std::span<const Quantity> wanted) const override {
        std::vector<std::vector<double>> found(wanted.size());
        for (std::size_t q = 0; q < found.size(); ++q) {
            found[q].resize(offsets_.size());
            with_values(stepper_, wanted[q], [&](const auto& value_at) {
                std::transform(offsets_.begin(), offsets_.end(), found[q].begin(), value_at);
            });
        }
        return found;
    }
    std::vector<double> line_sums(Field velocity, std::span<const double> weights) const override {
        const Slabs& slabs = stepper_.slabs();
        const Real* u = stepper_.total(velocity).data();
        const std::size_t axis = index_of(velocity);
        const std::ptrdiff_t n = slabs.grid.points[axis];
        const std::ptrdiff_t stride =
            std::array{slabs.ny() * slabs.pitch, slabs.pitch, std::ptrdiff_t{1}}[axis];
        const std::ptrdiff_t first = axis == 0 ? slabs.x_start() : 0,
                             count = axis == 0 ? slabs.x_count() : n;
        std::vector<double> sums(axis == 0 ? nodes_.nodes.size() : nodes_.count, 0.0);
        for (std::size_t i = 0; i < sums.size() && count > 0; ++i) {
            Node at = nodes_.nodes[axis == 0 ? i : nodes_.first + i];
            const std::ptrdiff_t place = std::exchange(at[axis], first);
            const Real* line = u + slabs.offset(at);
            for (std::ptrdiff_t j = 0; j < count; ++j)
                sums[i] += weights[static_cast<std::size_t>((place - first - j + n) % n)] *
                           static_cast<double>(line[j * stride]);
        }
        return sums;
    }

private:
    const Stepper<Real>& stepper_;
    SensorNodes nodes_;
    std::vector<std::size_t> offsets_;
};

} // namespace

template <class Real>
std::vector<double> Stepper<Real>::dense(const Quantity& quantity) const {
    std::vector<double> values(static_cast<std::size_t>(slabs_.rows() * slabs_.nz()));
    with_values(*this, quantity, [&](const auto& value_at) {
        each_value(slabs_, 0, slabs_.nz(), [&](std::size_t number, std::size_t offset) {
            values[number] = value_at(offset);
        });
    });
    return values;
}

template <class Real>
std::unique_ptr<Tally> Stepper<Real>::tally(const Tally::Of& tally) const {
    return std::make_unique<StepperTally<Real>>(*this, tally);
}

template <class Real>
std::unique_ptr<Sensor> Stepper<Real>::sensor(const SensorNodes& nodes) const {
    return std::make_unique<StepperSensor<Real>>(*this, nodes);
}

template std::vector<double> Stepper<double>::dense(const Quantity&) const;
template std::vector<double> Stepper<float>::dense(const Quantity&) const;
template std::unique_ptr<Tally> Stepper<double>::tally(const Tally::Of&) const;
template std::unique_ptr<Tally> Stepper<float>::tally(const Tally::Of&) const;
template std::unique_ptr<Sensor> Stepper<double>::sensor(const SensorNodes&) const;
template std::unique_ptr<Sensor> Stepper<float>::sensor(const SensorNodes&) const;

} // namespace shearwake::pstd
