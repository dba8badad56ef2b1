// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/stepper.hpp"

#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::pstd {
namespace {

constexpr auto forward = fft::HalfCell::forward;
constexpr auto back = fft::HalfCell::back;

} // namespace

template <class Real>
Stepper<Real>::Stepper(const Setup& setup, const Comm& team)
    : Scheme(slabs_of(setup.grid, team.size(), team.rank())),
      kernels_(&simd::kernels<UpdateKernels<Real>>()), team_(team), absorption_(setup.absorption),
      split_axis_(slabs_, team, absorption_ == Absorption::none ? 3 : 6),
      derivative_y_(slabs_.ny(), setup.grid.spacing_m[1], team),
      derivative_z_(slabs_.nz(), setup.grid.spacing_m[2], team) {
    const Preparation prepared(setup, slabs_, team);
    top_ = prepared.top;
    together(team, [&] {
        for (std::size_t f = 0; f < field_count; ++f) {
            const auto field = static_cast<Field>(f);
            states_.emplace_back(field, slabs_, setup.pml, prepared.reference_m_s,
                                 split_nodes(field, slabs_, setup.sources));
        }
        for (const Source& source : setup.sources) {
            if (source.nodes.empty()) continue;
            sources_.emplace_back(source, slabs_, state(source.field).runs, prepared.material,
                                  setup.material(source.nodes.front()).c_p_m_s);
        }
        const bool lossy = absorption_ == Absorption::kelvin_voigt;
        for (auto& a : acceleration_)
            a.assign(static_cast<std::size_t>(lossy ? slabs_.reals() : 0), Real(0));
        const auto planes = static_cast<std::ptrdiff_t>(lossy ? 12 : 6);
        scratch_.assign(static_cast<std::size_t>(planes * slabs_.ny() * slabs_.pitch), Real(0));
    });
    coefficients_.emplace(setup, prepared, slabs_, team);
}

template <class Real>
void Stepper<Real>::along_y(fft::HalfCell shift, const Real* plane, std::size_t to) {
    derivative_y_.along_columns(shift, plane, slabs_.pitch, scratch(to), slabs_.pitch,
                                slabs_.pitch);
}

template <class Real>
void Stepper<Real>::along_z(fft::HalfCell shift, const Real* plane, std::size_t to) {
    derivative_z_.along_rows(shift, plane, scratch(to), slabs_.pitch, slabs_.ny());
}

template <class Real>
void Stepper<Real>::put_in_sources(SourcesOf fields) {
    const bool velocities = fields == SourcesOf::velocities;
    for (PlacedSource<Real>& source : sources_)
        if (is_velocity(source.field()) == velocities)
            source.apply(steps_, state(source.field()), state(Field::uz).total,
                         velocities ? std::span<Real>(acceleration_[index_of(source.field())])
                                    : std::span<Real>());
}

// rho du_i/dt = sum_j g_ij,  g_ii = D_i+ s_ii,  g_ij = D_j- s_ij.
template <class Real>
void Stepper<Real>::velocity_plane(std::ptrdiff_t x) {
    const std::ptrdiff_t ny = slabs_.ny(), pitch = slabs_.pitch;
    const auto plane = [&](Field f) { return state(f).total.data() + x * ny * pitch; };
    const bool along_x = !slabs_.grid.moves_in_plane;
    if (along_x) along_y(back, plane(Field::sxy), 0);
    along_y(forward, plane(Field::syy), 1);
    along_y(back, plane(Field::syz), 2);
    if (along_x) along_z(back, plane(Field::sxz), 3);
    along_z(back, plane(Field::syz), 4);
    along_z(forward, plane(Field::szz), 5);
    // Field by field: few streams of memory at a time.
    const auto update = [&](Field field, const auto& own, const auto& second, const auto& third) {
        const bool lossy = absorption_ == Absorption::kelvin_voigt;
        const std::size_t i = index_of(field);
        for (std::ptrdiff_t y = 0; y < ny; ++y) {
            const RowAt at{x * ny + y, slabs_.x_start() + x, y};
            const Real* const g[3] = {own(y), second(y), third(y)};
            kernels_->velocity(row_of(state(field), parts_of(field), slabs_, at),
                               coefficients_->dt_over_rho[i].row(x, y), g,
                               lossy ? acceleration_[i].data() + at.row * pitch : nullptr);
        }
    };
    const auto g = [&](std::size_t number) {
        return [=, plane = scratch(number)](std::ptrdiff_t y) { return plane + y * pitch; };
    };
    const auto gx = [&](std::size_t task) {
        return [=, this](std::ptrdiff_t y) { return split_axis_.row(task, x, y); };
    };
    if (along_x) update(Field::ux, gx(0), g(0), g(3)); // parts in the order of parts_of
    update(Field::uy, g(1), gx(1), g(4));
    update(Field::uz, g(5), gx(2), g(2));
}

/// Along y and z: of the velocities into the first six planes, lossy of the accelerations into the
/// next six.
template <class Real>
void Stepper<Real>::derive_velocities(std::ptrdiff_t x) {
    const auto derive = [&](const Real* ux, const Real* uy, const Real* uz, std::size_t first) {
        const bool along_x = !slabs_.grid.moves_in_plane;
        if (along_x) along_y(forward, ux, first);
        along_y(back, uy, first + 1);
        along_y(forward, uz, first + 2);
        if (along_x) along_z(forward, ux, first + 3);
        along_z(forward, uy, first + 4);
        along_z(back, uz, first + 5);
    };
    const std::ptrdiff_t at_plane = x * slabs_.ny() * slabs_.pitch;
    derive(state(Field::ux).total.data() + at_plane, state(Field::uy).total.data() + at_plane,
           state(Field::uz).total.data() + at_plane, 0);
    if (absorption_ == Absorption::kelvin_voigt)
        derive(acceleration_[0].data() + at_plane, acceleration_[1].data() + at_plane,
               acceleration_[2].data() + at_plane, 6);
}

// d s_ij/dt = lambda e_kk + 2 mu e_ij, with e_ii = D_i- u_i and e_ij = D_j+ u_i fed part by part;
// Kelvin-Voigt: + chi and eta times the same derivatives of the accelerations.
template <class Real>
void Stepper<Real>::stress_plane(std::ptrdiff_t x) {
    const bool lossy = absorption_ == Absorption::kelvin_voigt;
    const std::ptrdiff_t ny = slabs_.ny(), pitch = slabs_.pitch;
    derive_velocities(x);
    // A derivative and, lossy, that of the acceleration.
    struct Pair {
        const Real *e, *de;
    };
    const auto e = [&](std::size_t number) {
        return [=, this](std::ptrdiff_t y) {
            return Pair{scratch(number) + y * pitch,
                        lossy ? scratch(number + 6) + y * pitch : nullptr};
        };
    };
    const auto ex = [&](std::size_t task) {
        return [=, this](std::ptrdiff_t y) {
            return Pair{split_axis_.row(task, x, y),
                        lossy ? split_axis_.row(task + 3, x, y) : nullptr};
        };
    };
    const auto rate = [](const Real* elastic, const Real* viscous, Pair of) {
        return Rate<Real>{elastic, of.e, viscous, of.de};
    };
    const auto update_normal = lossy ? kernels_->normal_lossy : kernels_->normal;
    const auto normal = [&](Field field, const auto& own, const auto& second, const auto& third) {
        for (std::ptrdiff_t y = 0; y < ny; ++y) {
            const RowAt at{x * ny + y, slabs_.x_start() + x, y};
            const Real *m = coefficients_->dt_p_modulus.row(x, y),
                       *l = coefficients_->dt_lambda.row(x, y);
            const Real *m_v = lossy ? coefficients_->chi_2eta.row(x, y) : nullptr,
                       *l_v = lossy ? coefficients_->chi.row(x, y) : nullptr;
            const Rate<Real> rates[3] = {rate(m, m_v, own(y)), rate(l, l_v, second(y)),
                                         rate(l, l_v, third(y))};
            update_normal(row_of(state(field), parts_of(field), slabs_, at), rates);
        }
    };
    normal(Field::sxx, ex(0), e(1), e(5));
    normal(Field::syy, e(1), ex(0), e(5));
    normal(Field::szz, e(5), ex(0), e(1));
    const auto update_shear = lossy ? kernels_->shear_lossy : kernels_->shear;
    const auto shear = [&](Field field, const auto& first, const auto& second) {
        const std::size_t i = index_of(field) - index_of(Field::sxy);
        for (std::ptrdiff_t y = 0; y < ny; ++y) {
            const RowAt at{x * ny + y, slabs_.x_start() + x, y};
            const Real *mu = coefficients_->dt_mu[i].row(x, y),
                       *eta = lossy ? coefficients_->eta[i].row(x, y) : nullptr;
            const Rate<Real> rates[2] = {rate(mu, eta, first(y)), rate(mu, eta, second(y))};
            update_shear(row_of(state(field), parts_of(field), slabs_, at), rates);
        }
    };
    if (!slabs_.grid.moves_in_plane) {
        shear(Field::sxy, ex(1), e(0));
        shear(Field::sxz, ex(2), e(3));
    }
    shear(Field::syz, e(2), e(4));
}

template <class Real>
void Stepper<Real>::step() {
    using Task = typename SplitAxis<Real>::Task;
    const auto task = [&](Field f, fft::HalfCell shift) {
        return Task{state(f).total.data(), shift};
    };
    const Task stresses[3] = {task(Field::sxx, forward), task(Field::sxy, back),
                              task(Field::sxz, back)};
    split_axis_.differentiate(stresses);
    for (std::ptrdiff_t x = 0; x < slabs_.x_count(); ++x)
        velocity_plane(x);
    put_in_sources(SourcesOf::velocities);

    const Task velocities[6] = {task(Field::ux, back),
                                task(Field::uy, forward),
                                task(Field::uz, forward),
                                {acceleration_[0].data(), back},
                                {acceleration_[1].data(), forward},
                                {acceleration_[2].data(), forward}};
    const bool lossy = absorption_ == Absorption::kelvin_voigt;
    split_axis_.differentiate(std::span(velocities).first(lossy ? 6 : 3));
    for (std::ptrdiff_t x = 0; x < slabs_.x_count(); ++x)
        stress_plane(x);
    put_in_sources(SourcesOf::stresses);
    ++steps_;
}

template class Stepper<double>;
template class Stepper<float>;

} // namespace shearwake::pstd
