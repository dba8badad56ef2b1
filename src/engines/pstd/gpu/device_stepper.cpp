// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/device_stepper.hpp"

#include "base/error.hpp"
#include "kernels_cl.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

namespace shearwake::pstd::gpu {
namespace {

constexpr auto forward = fft::HalfCell::forward;
constexpr auto back = fft::HalfCell::back;
/// The first of DeviceStepper::coefficients_.
constexpr std::size_t dt_over_rho = 0, dt_mu = 3, eta = 6, normal = 9;

/// The stress s_ij.
constexpr Field stress(std::size_t i, std::size_t j) {
    return static_cast<Field>(i == j ? 3 + i : 5 + i + j);
}
constexpr Field velocity(std::size_t i) {
    return static_cast<Field>(i);
}

} // namespace

DeviceField::DeviceField(const Device& device, Field field, const Slabs& slabs,
                         const FieldLayout<double>& layout)
    : total(device.zeros(static_cast<std::size_t>(slabs.reals()), device.facts().real_B)),
      start(device.uploaded(layout.runs.starts())), run(device.uploaded(layout.runs.runs())) {
    const std::size_t real_B = device.facts().real_B, parts = parts_of(field).count;
    for (std::size_t p = 0; p < part.size(); ++p)
        part[p] =
            device.zeros(p + 1 < parts ? static_cast<std::size_t>(layout.runs.size(p)) : 0, real_B);
    std::vector<double> factors;
    for (std::size_t p = 0; p < parts; ++p)
        for (const auto& of_axis : layout.factor[p])
            factors.insert(factors.end(), of_axis.begin(), of_axis.end());
    factor = device.numbers(factors, real_B);
}

DeviceStepper::DeviceStepper(const Setup& setup, const Comm& team, int number, std::size_t real_B)
    : Scheme(slabs_of(setup.grid, 1, 0)), team_(team), absorption_(setup.absorption),
      device_(number, Comm::rank_on_machine(), real_B) {
    const Preparation prepared(setup, slabs_, team);
    top_ = prepared.top;
    const auto upload = [&](const auto& c) {
        const auto& [rho, mu, viscosity, lambda, p_modulus, chi, chi_2eta] = c;
        const std::array all = {&rho[0],    &rho[1],       &rho[2],       &mu[0],        &mu[1],
                                &mu[2],     &viscosity[0], &viscosity[1], &viscosity[2], &lambda,
                                &p_modulus, &chi,          &chi_2eta};
        require_memory(setup, static_cast<double>(std::ranges::count_if(
                                  all, [](const auto* each) { return each->varies_laterally(); })));
        for (const auto* each : all)
            coefficients_.push_back({device_.uploaded(each->values()), each->varies_laterally()});
    };
    if (real_B == sizeof(float))
        upload(Coefficients<float>(setup, prepared, slabs_, team));
    else
        upload(Coefficients<double>(setup, prepared, slabs_, team));
    std::vector<FieldLayout<double>> layouts;
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto field = static_cast<Field>(f);
        layouts.emplace_back(field, slabs_, setup.pml, prepared.reference_m_s,
                             split_nodes(field, slabs_, setup.sources));
        fields_.emplace_back(device_, field, slabs_, layouts.back());
    }
    for (const Source& source : setup.sources)
        if (!source.nodes.empty())
            sources_.emplace_back(
                device_,
                PlacedSource<double>(source, slabs_, layouts[index_of(source.field)].runs,
                                     prepared.material, setup.material(source.nodes[0]).c_p_m_s));
    const auto reals = static_cast<std::size_t>(slabs_.reals());
    for (std::size_t i = 0; i < 3; ++i) {
        acceleration_.push_back(device_.zeros(is_lossy() ? reals : 0, real_B));
        if (slabs_.grid.points[i] > 1) derivatives_.try_emplace(i, device_, slabs_, i);
    }
    for (std::size_t i = 0; i < 6; ++i)
        scratch_.push_back(device_.zeros(i < 3 || is_lossy() ? reals : 0, real_B));
    zeros_ = device_.zeros(derivatives_.size() < 3 ? reals : 0, real_B);
    const std::string options = fmt::format(
        "-DNX={} -DNY={} -DNZ={} -DPITCH={} -DIS_PLANE={} {}", slabs_.nx(), slabs_.ny(),
        slabs_.nz(), slabs_.pitch, setup.grid.is_plane ? 1 : 0, is_lossy() ? "-DLOSSY" : "");
    kernels_ = device_.compile(std::string(updates_cl) + sources_sensors_cl, options,
                               {"velocity", "normal_stress", "shear_stress", "apply_source",
                                "tally", "gather", "line_sums", "kinetic"});
    signals_.restore();
}

void DeviceStepper::require_memory(const Setup& setup, double lateral_coefficients) const {
    const DeviceFacts& device = device_.facts();
    double source_nodes = 0.0;
    for (const Source& source : setup.sources)
        source_nodes += static_cast<double>(source.nodes.size());
    const double needed_B = device_memory_B(setup, static_cast<double>(device.real_B),
                                            lateral_coefficients, source_nodes),
                 array_B = static_cast<double>(slabs_.reals()) * static_cast<double>(device.real_B);
    if (needed_B > device.memory_B || array_B > device.most_array_B)
        throw CaseFailure(fmt::format(
            "device {} has {:.3g} GB of memory, of which an array has at most {:.3g} GB; the case "
            "needs {:.3g} GB in arrays of up to {:.3g} GB",
            device.name, 1e-9 * device.memory_B, 1e-9 * device.most_array_B, 1e-9 * needed_B,
            1e-9 * array_B));
}

Device::Range DeviceStepper::nodes() const {
    return {static_cast<std::size_t>(slabs_.nz()), static_cast<std::size_t>(slabs_.ny()),
            static_cast<std::size_t>(slabs_.nx())};
}

/// The derivative of an array, in a scratch array that the next call with this number overwrites;
/// zeros along an axis with one point, and for an array without values.
const Buffer& DeviceStepper::derive(std::size_t axis, fft::HalfCell shift, const Buffer& from,
                                    std::size_t to) const {
    const auto derivative = derivatives_.find(axis);
    if (derivative == derivatives_.end() || from.size == 0) return zeros_;
    derivative->second.derive(shift, from, scratch_[to]);
    return scratch_[to];
}

void DeviceStepper::update_velocities() const {
    for (std::size_t i = slabs_.grid.moves_in_plane ? 1 : 0; i < 3; ++i) {
        const auto axes = parts_of(velocity(i)).axes;
        const auto g = [&](std::size_t p) -> const Buffer& {
            return derive(axes[p], p == 0 ? forward : back, total(stress(i, axes[p])), p);
        };
        run("velocity", nodes(), fields_[i].arguments(), axes[0], axes[1],
            coefficient(dt_over_rho, i), g(0), g(1), g(2), acceleration_[i]);
    }
}

void DeviceStepper::update_stresses() const {
    const auto e = [&](std::size_t i) -> const Buffer& {
        return derive(i, back, total(velocity(i)), i);
    };
    const auto de = [&](std::size_t i) -> const Buffer& {
        return derive(i, back, acceleration_[i], 3 + i);
    };
    run("normal_stress", nodes(), fields_[3].arguments(), fields_[4].arguments(),
        fields_[5].arguments(), coefficient(normal, 0), coefficient(normal, 1),
        coefficient(normal, 2), coefficient(normal, 3), e(0), e(1), e(2), de(0), de(1), de(2));
    for (std::size_t i = slabs_.grid.moves_in_plane ? 2 : 0; i < 3; ++i) {
        const auto axes = parts_of(static_cast<Field>(6 + i)).axes;
        const std::size_t a = axes[0], b = axes[1];
        run("shear_stress", nodes(), fields_[6 + i].arguments(), a, b, coefficient(dt_mu, i),
            coefficient(eta, i), derive(a, forward, total(velocity(b)), 0),
            derive(b, forward, total(velocity(a)), 1), derive(a, forward, acceleration_[b], 3),
            derive(b, forward, acceleration_[a], 4));
    }
}

void DeviceStepper::step() {
    update_velocities();
    apply_sources(SourcesOf::velocities);
    update_stresses();
    apply_sources(SourcesOf::stresses);
    ++steps_;
    if (std::exchange(has_stepped_, true)) return;
    device_.finish(); // drivers may compile kernels for their first use
    signals_.restore();
}

void DeviceStepper::apply_sources(SourcesOf fields) {
    const bool velocities = fields == SourcesOf::velocities;
    for (DeviceSource& s : sources_) {
        const Source& source = s.placed.source();
        if (is_velocity(source.field) != velocities || steps_ >= source.samples) continue;
        const std::ptrdiff_t first = s.load(device_, steps_);
        const DeviceField& field = fields_[index_of(source.field)];
        run("apply_source", {s.places.size, 1, 1}, field.total, field.part[0], field.part[1],
            total(Field::uz), acceleration_[velocities ? index_of(source.field) : 0], s.places,
            s.per_work, s.before, s.work, s.values, first, s.places.size, velocities,
            static_cast<int>(source.mode), velocities && source.in_rates && is_lossy(),
            parts_of(source.field).count);
    }
}

std::vector<double> DeviceStepper::dense(const Quantity& quantity) const {
    const auto sum = tally({.quantity = quantity, .planes = slabs_.nz()});
    sum->add();
    return sum->values();
}

double DeviceStepper::kinetic_J() const {
    const Buffer sums = device_.zeros(8192, device_.facts().sum_B);
    for (std::size_t i = 0; i < 3; ++i)
        // As on the processor: u_z of the plane above is between empty nodes and the medium.
        run("kinetic", {sums.size, 1, 1}, total(velocity(i)), coefficient(dt_over_rho, i),
            std::max<std::ptrdiff_t>(i == 2 ? top_ - 1 : top_, 0), sums);
    const std::vector<double> parts = device_.read(sums);
    const auto& d_m = slabs_.grid.spacing_m;
    return 0.5 * d_m[0] * d_m[1] * d_m[2] * slabs_.grid.dt_s *
           std::accumulate(parts.begin(), parts.end(), 0.0);
}

double DeviceStepper::work_J() const {
    double sum = 0.0;
    for (const DeviceSource& source : sources_)
        for (const double work : device_.read(source.work))
            sum += work;
    return sum;
}

void DeviceStepper::save(StateWriter& state) const {
    state.put("step", static_cast<double>(steps_));
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto total = device_.read(fields_[f].total), first = device_.read(fields_[f].part[0]),
                   second = device_.read(fields_[f].part[1]);
        save_field<double>(state, static_cast<Field>(f), slabs_, team_, total, {first, second});
    }
}

void DeviceStepper::restore(const StateReader& state) {
    steps_ = std::lround(state.get("step"));
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto& [total_there, part, factor, start, runs] = fields_[f];
        std::vector<double> total(total_there.size), first(part[0].size), second(part[1].size);
        restore_field<double>(state, static_cast<Field>(f), slabs_, team_, total, {first, second});
        device_.write(total_there, total);
        device_.write(part[0], first);
        device_.write(part[1], second);
        for (const DeviceSource& source : sources_) {
            if (index_of(source.placed.field()) != f) continue;
            std::vector<double> before; // from which the next work is counted
            for (const auto& place : source.placed.places())
                before.push_back(total[static_cast<std::size_t>(place.total)]);
            device_.write(source.before, before);
        }
    }
}

/// The arrays that a step reads and writes, without the parts in the layer.
double DeviceStepper::copy_share(double steps_per_s) const {
    const double derivatives = is_lossy() ? 27.0 : 18.0;
    // Totals and gradients of velocities, normal and shear stresses; lossy also accelerations.
    double arrays = 2.0 * derivatives + 15.0 + 9.0 + 12.0 + (is_lossy() ? 3.0 + 9.0 : 0.0);
    for (const DeviceCoefficient& c : coefficients_)
        arrays += c.is_lateral ? 1.0 : 0.0;
    return steps_per_s * arrays * static_cast<double>(scratch_[0].bytes()) /
           device_.measured_copies_B_s();
}

} // namespace shearwake::pstd::gpu
