// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/gpu/derivative.hpp"
#include "engines/pstd/scheme/coefficients.hpp"
#include "engines/pstd/scheme/placed_source.hpp"
#include "engines/pstd/scheme/scheme.hpp"

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace shearwake::pstd::gpu {

constexpr Device::Range group_of_nodes = {64, 1, 1};

/// Structures of the kernels.
struct DeviceRun {
    cl_int begin, end, face, unused;
    cl_long first, second;
};
struct DevicePlace {
    cl_long total, first, second;
    cl_int has_own_part, unused;
};

/// A field with its parts, as FieldState.
template <class Real>
struct DeviceField {
    DeviceField(const Device& device, Field field, const Slabs& slabs,
                const FieldLayout<Real>& layout);
    Buffer<Real> total;
    std::array<Buffer<Real>, 2> part;
    Buffer<Real> factor;
    Buffer<cl_int> start;
    Buffer<DeviceRun> run;
    auto arguments() const { return std::tie(total, part[0], part[1], factor, start, run); }
};

/// A coefficient, as Coefficient.
template <class Real>
struct DeviceCoefficient {
    DeviceCoefficient(const Device& device, const Coefficient<Real>& c)
        : values(device.uploaded(c.values())), is_lateral(c.varies_laterally() ? 1 : 0) {}
    Buffer<Real> values;
    cl_int is_lateral;
    auto arguments() const { return std::tie(values, is_lateral); }
};

/// A source: its values come to the device some samples at a time.
template <class Real>
struct DeviceSource {
    DeviceSource(const Device& device, PlacedSource<Real> source);
    PlacedSource<Real> placed;
    Buffer<DevicePlace> places;
    Buffer<char> per_work, work;
    Buffer<Real> before, values;
    std::ptrdiff_t first_sample = 0, samples = 0; // of `values`
    std::ptrdiff_t most_samples;
    cl_int count() const { return static_cast<cl_int>(placed.places().size()); }
    /// Where the values of a sample begin.
    cl_long load(const Device& device, std::ptrdiff_t sample);
};

/// The scheme of a Stepper on a GPU: arrays, coefficients and runs of parts are those of the
/// processor, made by the same code. All fields stay on the device; the host receives values of
/// sensors and what is asked for. Each step enqueues its kernels and returns. The device compiles
/// the kernels for the sizes of the grid.
template <class Real>
class DeviceStepper : public Scheme {
public:
    /// `team` has one rank. Throws CaseFailure if the device lacks memory or double precision.
    /// Collective.
    DeviceStepper(const Setup& setup, const Comm& team, int number);

    void step() override;
    std::vector<double> dense(const Quantity& quantity) const override;
    std::unique_ptr<Tally> tally(const Tally::Of& tally) const override;
    std::unique_ptr<Sensor> sensor(const SensorNodes& nodes) const override;
    double kinetic_J() const override;
    double work_J() const override;
    void save(StateWriter& state) const override;
    void restore(const StateReader& state) override;
    std::string device_name() const override { return device_.name(); }
    double copy_share(double steps_per_s) const override;

    const Device& device() const { return device_; }
    const Kernel& kernel(const std::string& name) const { return kernels_.at(name); }
    /// The arrays of a quantity as the kernels take them.
    auto arrays_of(const Quantity& quantity) const {
        const bool is_pressure = !quantity;
        return std::tuple<const Buffer<Real>&, const Buffer<Real>&, const Buffer<Real>&, cl_int>(
            total(quantity.value_or(Field::sxx)), total(quantity.value_or(Field::syy)),
            total(quantity.value_or(Field::szz)), is_pressure ? 1 : 0);
    }
    const Buffer<Real>& total(Field field) const { return fields_[index_of(field)].total; }

private:
    void require_memory(const Setup& setup, const Coefficients<Real>& coefficients,
                        const std::vector<FieldLayout<Real>>& layouts,
                        const std::vector<PlacedSource<Real>>& sources) const;
    void allocate(const Setup& setup, const Coefficients<Real>& coefficients,
                  const std::vector<FieldLayout<Real>>& layouts,
                  std::vector<PlacedSource<Real>> sources);
    const Buffer<Real>& derive(std::size_t axis, fft::HalfCell shift, const Buffer<Real>& from,
                               std::size_t to) const;
    void update_velocities() const;
    void update_normal_stresses() const;
    void update_shear_stresses() const;
    enum class SourcesOf { velocities, stresses };
    void apply_sources(SourcesOf fields);
    bool is_lossy() const { return absorption_ == Absorption::kelvin_voigt; }
    Device::Range nodes() const;

    SignalHandlers signals_; // before OpenCL is loaded
    bool has_stepped_ = false;
    Comm team_;
    Absorption absorption_;
    std::ptrdiff_t top_ = 0;
    Device device_;
    std::map<std::string, Kernel> kernels_; // by name
    std::vector<DeviceField<Real>> fields_;
    std::vector<Buffer<Real>> acceleration_, scratch_;
    Buffer<Real> zeros_; // derivatives along an axis with one point
    // As in Coefficients: dt/rho, dt mu, eta of three axes each; dt lambda, dt (lambda + 2 mu),
    // chi, chi + 2 eta.
    std::vector<DeviceCoefficient<Real>> dt_over_rho_, dt_mu_, eta_, normal_;
    std::vector<Derivative<Real>> derivatives_;
    std::vector<DeviceSource<Real>> sources_;
};

} // namespace shearwake::pstd::gpu
