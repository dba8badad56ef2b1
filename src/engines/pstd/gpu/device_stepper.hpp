// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/gpu/derivative.hpp"
#include "engines/pstd/scheme/coefficients.hpp"
#include "engines/pstd/scheme/placed_source.hpp"
#include "engines/pstd/scheme/scheme.hpp"

#include <array>
#include <map>
#include <tuple>
#include <vector>

namespace shearwake::pstd::gpu {

constexpr Device::Range group_of_nodes = {64, 1, 1};

/// A field with its parts, as FieldState.
struct DeviceField {
    DeviceField(const Device& device, Field field, const Slabs& slabs,
                const FieldLayout<double>& layout);
    Buffer total;
    std::array<Buffer, 2> part;
    Buffer factor, start, run;
    auto arguments() const { return std::tie(total, part[0], part[1], factor, start, run); }
};

/// A coefficient, as Coefficient.
struct DeviceCoefficient {
    Buffer values;
    bool is_lateral;
    auto arguments() const { return std::tie(values, is_lateral); }
};

/// A source: its values come to the device some samples at a time.
struct DeviceSource {
    DeviceSource(const Device& device, PlacedSource<double> source);
    PlacedSource<double> placed;
    Buffer places, per_work, work, before, values;
    std::ptrdiff_t loaded = -1; // which of the blocks of samples that fit into `values`
    /// Where the values of a sample begin.
    std::ptrdiff_t load(const Device& device, std::ptrdiff_t sample);
};

/// The scheme of a Stepper on a GPU: arrays, coefficients and runs of parts are those of the
/// processor, made by the same code. All fields stay on the device; the host receives values of
/// sensors and what is asked for. Each step enqueues its kernels and returns. The device compiles
/// the kernels for the sizes of the grid.
class DeviceStepper : public Scheme {
public:
    /// `team` has one rank; values have `real_B` bytes. Throws CaseFailure if the device lacks
    /// memory or double precision. Collective.
    DeviceStepper(const Setup& setup, const Comm& team, int number, std::size_t real_B);

    void step() override;
    std::vector<double> dense(const Quantity& quantity) const override;
    std::unique_ptr<Tally> tally(const Tally::Of& tally) const override;
    std::unique_ptr<Sensor> sensor(const SensorNodes& nodes) const override;
    double kinetic_J() const override;
    double work_J() const override;
    void save(StateWriter& state) const override;
    void restore(const StateReader& state) override;
    std::string device_name() const override { return device_.facts().name; }
    double copy_share(double steps_per_s) const override;

    const Device& device() const { return device_; }
    /// Of the kernels for nodes; see Device::run.
    template <class... Arguments>
    void run(const char* kernel, Device::Range items, const Arguments&... arguments) const {
        device_.run(kernels_.at(kernel), items, group_of_nodes, arguments...);
    }
    const Buffer& total(Field field) const { return fields_[index_of(field)].total; }
    /// The arrays of a quantity as the kernels take them.
    auto arrays_of(const Quantity& quantity) const {
        return std::tuple<const Buffer&, const Buffer&, const Buffer&, bool>(
            total(quantity.value_or(Field::sxx)), total(quantity.value_or(Field::syy)),
            total(quantity.value_or(Field::szz)), !quantity);
    }

private:
    void require_memory(const Setup& setup, double lateral_coefficients) const;
    const Buffer& derive(std::size_t axis, fft::HalfCell shift, const Buffer& from,
                         std::size_t to) const;
    void update_velocities() const;
    void update_stresses() const;
    enum class SourcesOf { velocities, stresses };
    void apply_sources(SourcesOf fields);
    bool is_lossy() const { return absorption_ == Absorption::kelvin_voigt; }
    /// See coefficients_.
    auto coefficient(std::size_t first, std::size_t i) const {
        return coefficients_[first + i].arguments();
    }
    Device::Range nodes() const;

    SignalHandlers signals_; // before OpenCL is loaded
    bool has_stepped_ = false;
    Comm team_;
    Absorption absorption_;
    std::ptrdiff_t top_ = 0;
    Device device_;
    Kernels kernels_;
    std::vector<DeviceField> fields_;
    std::vector<Buffer> acceleration_, scratch_;
    Buffer zeros_; // derivatives along an axis with one point
    // As in Coefficients: dt/rho, dt mu, eta of three axes each; dt lambda, dt (lambda + 2 mu),
    // chi, chi + 2 eta.
    std::vector<DeviceCoefficient> coefficients_;
    std::map<std::size_t, Derivative> derivatives_; // by axis
    std::vector<DeviceSource> sources_;
};

} // namespace shearwake::pstd::gpu
