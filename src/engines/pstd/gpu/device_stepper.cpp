// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/device_stepper.hpp"

#include "base/error.hpp"
#include "kernels_cl.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

namespace shearwake::pstd::gpu {
namespace {

constexpr auto forward = fft::HalfCell::forward;
constexpr auto back = fft::HalfCell::back;

Device::Range items(std::size_t count) {
    return {count, 1, 1};
}

/// The stress s_ij.
constexpr Field stress(std::size_t i, std::size_t j) {
    return static_cast<Field>(i == j ? 3 + i : 5 + i + j);
}
constexpr Field velocity(std::size_t i) {
    return static_cast<Field>(i);
}

template <class Real>
double bytes_of(const Coefficient<Real>& c) {
    return static_cast<double>(c.values().size()) * sizeof(Real);
}

} // namespace

template <class Real>
DeviceField<Real>::DeviceField(const Device& device, Field field, const Slabs& slabs,
                               const FieldLayout<Real>& layout)
    : total(device.zeros<Real>(static_cast<std::size_t>(slabs.reals()))) {
    const Parts parts = parts_of(field);
    for (std::size_t p = 0; p < part.size(); ++p)
        part[p] = device.zeros<Real>(
            p + 1 < parts.count ? static_cast<std::size_t>(layout.runs.size(p)) : 0);
    std::vector<Real> factors;
    for (std::size_t p = 0; p < parts.count; ++p)
        for (const auto& of_axis : layout.factor[p])
            factors.insert(factors.end(), of_axis.begin(), of_axis.end());
    factor = device.uploaded(factors);
    start = device.uploaded(
        std::vector<cl_int>(layout.runs.starts().begin(), layout.runs.starts().end()));
    std::vector<DeviceRun> runs;
    for (const SplitRun& r : layout.runs.runs())
        runs.push_back({static_cast<cl_int>(r.begin), static_cast<cl_int>(r.end), r.face, 0,
                        r.offset, r.second});
    run = device.uploaded(runs);
}

template <class Real>
DeviceStepper<Real>::DeviceStepper(const Setup& setup, const Comm& team, int number)
    : Scheme(slabs_of(setup.grid, 1, 0)), team_(team), absorption_(setup.absorption),
      device_(number, Comm::rank_on_machine()) {
    if (sizeof(Real) == 8 && !device_.has_doubles())
        throw CaseFailure(fmt::format("device {} has no double precision; use precision = "
                                      "\"single\"",
                                      device_.name()));
    const Preparation prepared(setup, slabs_, team);
    top_ = prepared.top;
    std::vector<FieldLayout<Real>> layouts;
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto field = static_cast<Field>(f);
        layouts.emplace_back(field, slabs_, setup.pml, prepared.reference_m_s,
                             split_nodes(field, slabs_, setup.sources));
    }
    std::vector<PlacedSource<Real>> sources;
    for (const Source& source : setup.sources)
        if (!source.nodes.empty())
            sources.emplace_back(source, slabs_, layouts[index_of(source.field)].runs,
                                 prepared.material, setup.material(source.nodes.front()).c_p_m_s);
    const Coefficients<Real> coefficients(setup, prepared, slabs_, team);
    require_memory(setup, coefficients, layouts, sources);
    allocate(setup, coefficients, layouts, std::move(sources));
    signals_.restore();
}

template <class Real>
void DeviceStepper<Real>::require_memory(const Setup& setup, const Coefficients<Real>& c,
                                         const std::vector<FieldLayout<Real>>& layouts,
                                         const std::vector<PlacedSource<Real>>& sources) const {
    const double array_B = static_cast<double>(slabs_.reals()) * sizeof(Real);
    const bool has_zeros = std::ranges::count(setup.grid.points, 1) > 0;
    double bytes = ((is_lossy() ? 18.0 : 12.0) + (has_zeros ? 1.0 : 0.0)) * array_B;
    for (const FieldLayout<Real>& layout : layouts)
        bytes += static_cast<double>(layout.runs.size(0) + layout.runs.size(1)) * sizeof(Real) +
                 static_cast<double>(layout.runs.runs().size()) * sizeof(DeviceRun) +
                 static_cast<double>(layout.runs.starts().size()) * sizeof(cl_int);
    for (std::size_t i = 0; i < 3; ++i)
        bytes += bytes_of(c.dt_over_rho[i]) + bytes_of(c.dt_mu[i]) + bytes_of(c.eta[i]) +
                 Derivative<Real>::memory_B(device_, slabs_, i);
    for (const auto* each : {&c.dt_lambda, &c.dt_p_modulus, &c.chi, &c.chi_2eta})
        bytes += bytes_of(*each);
    for (const PlacedSource<Real>& source : sources)
        bytes += static_cast<double>(source.places().size()) *
                 (sizeof(DevicePlace) + 2 * sizeof(double) + 2 * sizeof(Real));
    if (bytes > device_.memory_B() || array_B > device_.most_array_B())
        throw CaseFailure(fmt::format(
            "device {} has {:.3g} GB of memory, of which an array has at most {:.3g} GB; the case "
            "needs {:.3g} GB in arrays of up to {:.3g} GB",
            device_.name(), 1e-9 * device_.memory_B(), 1e-9 * device_.most_array_B(), 1e-9 * bytes,
            1e-9 * array_B));
}

template <class Real>
void DeviceStepper<Real>::allocate(const Setup& setup, const Coefficients<Real>& c,
                                   const std::vector<FieldLayout<Real>>& layouts,
                                   std::vector<PlacedSource<Real>> sources) {
    const auto reals = static_cast<std::size_t>(slabs_.reals());
    for (std::size_t f = 0; f < field_count; ++f)
        fields_.emplace_back(device_, static_cast<Field>(f), slabs_, layouts[f]);
    for (std::size_t i = 0; i < 3; ++i) {
        acceleration_.push_back(device_.zeros<Real>(is_lossy() ? reals : 0));
        dt_over_rho_.emplace_back(device_, c.dt_over_rho[i]);
        dt_mu_.emplace_back(device_, c.dt_mu[i]);
        eta_.emplace_back(device_, c.eta[i]);
        derivatives_.emplace_back(device_, slabs_, i);
    }
    for (const auto* each : {&c.dt_lambda, &c.dt_p_modulus, &c.chi, &c.chi_2eta})
        normal_.emplace_back(device_, *each);
    for (std::size_t i = 0; i < 6; ++i)
        scratch_.push_back(device_.zeros<Real>(i < 3 || is_lossy() ? reals : 0));
    zeros_ = device_.zeros<Real>(std::ranges::count(setup.grid.points, 1) > 0 ? reals : 0);
    for (PlacedSource<Real>& source : sources)
        sources_.emplace_back(device_, std::move(source));
    const std::string options = fmt::format(
        "-DNX={} -DNY={} -DNZ={} -DPITCH={} -DIS_PLANE={} {}", slabs_.nx(), slabs_.ny(),
        slabs_.nz(), slabs_.pitch, setup.grid.is_plane ? 1 : 0, is_lossy() ? "-DLOSSY" : "");
    const Program program =
        device_.compile(std::string(updates_cl) + sources_sensors_cl, options, sizeof(Real));
    for (const char* name : {"velocity", "normal_stress", "shear_stress", "apply_source",
                             "resume_source", "tally", "gather", "line_sums", "kinetic"})
        kernels_.emplace(name, device_.kernel(program, name));
}

template <class Real>
Device::Range DeviceStepper<Real>::nodes() const {
    return {static_cast<std::size_t>(slabs_.nz()), static_cast<std::size_t>(slabs_.ny()),
            static_cast<std::size_t>(slabs_.nx())};
}

/// The derivative of an array, in a scratch array that the next call with this number overwrites.
template <class Real>
const Buffer<Real>& DeviceStepper<Real>::derive(std::size_t axis, fft::HalfCell shift,
                                                const Buffer<Real>& from, std::size_t to) const {
    if (slabs_.grid.points[axis] == 1) return zeros_;
    derivatives_[axis].derive(shift, from, scratch_[to]);
    return scratch_[to];
}

template <class Real>
void DeviceStepper<Real>::update_velocities() const {
    for (std::size_t i = slabs_.grid.moves_in_plane ? 1 : 0; i < 3; ++i) {
        const auto axes = parts_of(velocity(i)).axes;
        const auto g = [&](std::size_t p) -> const Buffer<Real>& {
            return derive(axes[p], axes[p] == i ? forward : back, total(stress(i, axes[p])), p);
        };
        const Buffer<Real>&g0 = g(0), &g1 = g(1), &g2 = g(2);
        device_.run(kernel("velocity"), nodes(), group_of_nodes, fields_[i].arguments(),
                    static_cast<cl_int>(axes[0]), static_cast<cl_int>(axes[1]),
                    dt_over_rho_[i].arguments(), g0, g1, g2, acceleration_[i]);
    }
}

template <class Real>
void DeviceStepper<Real>::update_normal_stresses() const {
    const auto e = [&](std::size_t i) -> const Buffer<Real>& {
        return derive(i, back, total(velocity(i)), i);
    };
    const auto de = [&](std::size_t i) -> const Buffer<Real>& {
        return is_lossy() ? derive(i, back, acceleration_[i], 3 + i) : zeros_;
    };
    const Buffer<Real>&exx = e(0), &eyy = e(1), &ezz = e(2), &dxx = de(0), &dyy = de(1),
          &dzz = de(2);
    device_.run(kernel("normal_stress"), nodes(), group_of_nodes, fields_[3].arguments(),
                fields_[4].arguments(), fields_[5].arguments(), normal_[0].arguments(),
                normal_[1].arguments(), normal_[2].arguments(), normal_[3].arguments(), exx, eyy,
                ezz, dxx, dyy, dzz);
}

template <class Real>
void DeviceStepper<Real>::update_shear_stresses() const {
    constexpr std::size_t axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (std::size_t i = slabs_.grid.moves_in_plane ? 2 : 0; i < 3; ++i) {
        const auto [a, b] = axes[i];
        const Buffer<Real>&e0 = derive(a, forward, total(velocity(b)), 0),
              &e1 = derive(b, forward, total(velocity(a)), 1);
        const auto de = [&](std::size_t axis, std::size_t of,
                            std::size_t to) -> const Buffer<Real>& {
            return is_lossy() ? derive(axis, forward, acceleration_[of], to) : zeros_;
        };
        const Buffer<Real>&d0 = de(a, b, 2), &d1 = de(b, a, 3);
        device_.run(kernel("shear_stress"), nodes(), group_of_nodes, fields_[6 + i].arguments(),
                    static_cast<cl_int>(a), static_cast<cl_int>(b), dt_mu_[i].arguments(),
                    eta_[i].arguments(), e0, e1, d0, d1);
    }
}

template <class Real>
void DeviceStepper<Real>::step() {
    update_velocities();
    apply_sources(SourcesOf::velocities);
    update_normal_stresses();
    update_shear_stresses();
    apply_sources(SourcesOf::stresses);
    ++steps_;
    if (std::exchange(has_stepped_, true)) return;
    device_.finish(); // drivers may compile kernels for their first use
    signals_.restore();
}

template <class Real>
void DeviceStepper<Real>::apply_sources(SourcesOf fields) {
    const bool velocities = fields == SourcesOf::velocities;
    for (DeviceSource<Real>& s : sources_) {
        const Source& source = s.placed.source();
        if (is_velocity(source.field) != velocities || steps_ >= source.samples) continue;
        const cl_long first = s.load(device_, steps_);
        const DeviceField<Real>& field = fields_[index_of(source.field)];
        const Buffer<Real>& leaps = acceleration_[velocities ? index_of(source.field) : 0];
        device_.run(kernel("apply_source"), items(s.places.size()), group_of_nodes, field.total,
                    field.part[0], field.part[1], total(Field::uz), leaps, s.places, s.per_work,
                    s.before, s.work, s.values, first, s.count(), static_cast<cl_int>(velocities),
                    static_cast<cl_int>(source.mode),
                    static_cast<cl_int>(velocities && source.in_rates && is_lossy()),
                    static_cast<cl_int>(parts_of(source.field).count));
    }
}

template <class Real>
std::vector<double> DeviceStepper<Real>::dense(const Quantity& quantity) const {
    const auto sum = tally({.quantity = quantity, .planes = slabs_.nz()});
    sum->add();
    return sum->values();
}

template <class Real>
double DeviceStepper<Real>::kinetic_J() const {
    constexpr std::size_t workers = 8192;
    const auto sums = device_.uploaded_sums(std::vector<double>(workers));
    for (std::size_t i = 0; i < 3; ++i) {
        // As on the processor: u_z of the plane above is between empty nodes and the medium.
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(i == 2 ? top_ - 1 : top_, 0);
        device_.run(kernel("kinetic"), items(workers), group_of_nodes, total(static_cast<Field>(i)),
                    dt_over_rho_[i].arguments(), static_cast<cl_int>(first), sums);
    }
    const std::vector<double> parts = device_.read_sums(sums);
    const auto& d_m = slabs_.grid.spacing_m;
    return 0.5 * d_m[0] * d_m[1] * d_m[2] * slabs_.grid.dt_s *
           std::accumulate(parts.begin(), parts.end(), 0.0);
}

template <class Real>
double DeviceStepper<Real>::work_J() const {
    double sum = 0.0;
    for (const DeviceSource<Real>& source : sources_)
        for (const double work : device_.read_sums(source.work))
            sum += work;
    return sum;
}

template <class Real>
void DeviceStepper<Real>::save(StateWriter& state) const {
    state.put("step", static_cast<double>(steps_));
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto total = device_.read(fields_[f].total), first = device_.read(fields_[f].part[0]),
                   second = device_.read(fields_[f].part[1]);
        save_field<Real>(state, static_cast<Field>(f), slabs_, team_, total, {first, second});
    }
}

template <class Real>
void DeviceStepper<Real>::restore(const StateReader& state) {
    steps_ = std::lround(state.get("step"));
    for (DeviceField<Real>& field : fields_) {
        std::vector<Real> total(field.total.size()), first(field.part[0].size()),
            second(field.part[1].size());
        restore_field<Real>(state, static_cast<Field>(&field - fields_.data()), slabs_, team_,
                            total, {first, second});
        device_.write(field.total, total);
        device_.write(field.part[0], first);
        device_.write(field.part[1], second);
    }
    for (const DeviceSource<Real>& source : sources_)
        device_.run(kernel("resume_source"), items(source.places.size()), group_of_nodes,
                    total(source.placed.field()), source.places, source.before, source.count());
}

/// The arrays that a step reads and writes, without the parts in the layer.
template <class Real>
double DeviceStepper<Real>::copy_share(double steps_per_s) const {
    const double derivatives = is_lossy() ? 27.0 : 18.0;
    // Totals and gradients of velocities, normal and shear stresses; lossy also accelerations.
    double arrays = 2.0 * derivatives + 15.0 + 9.0 + 12.0 + (is_lossy() ? 3.0 + 9.0 : 0.0);
    for (const auto* several : {&dt_over_rho_, &dt_mu_, &eta_, &normal_})
        for (const DeviceCoefficient<Real>& c : *several)
            arrays += c.is_lateral;
    return steps_per_s * arrays * static_cast<double>(slabs_.reals()) * sizeof(Real) /
           device_.measured_copies_B_s();
}

template class DeviceStepper<double>;
template class DeviceStepper<float>;

} // namespace shearwake::pstd::gpu
