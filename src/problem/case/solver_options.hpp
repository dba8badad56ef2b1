// SPDX-License-Identifier: BSD-3-Clause
// The options of the engines, which are a part of a case. Only an engine, its registration and
// benchmarks read them.
#pragma once

#include "base/field.hpp"

#include <array>
#include <optional>
#include <variant>

namespace shearwake {

/// Engine `layered`: exact for stratified media.
struct LayeredOptions {
    static constexpr const char* name = "layered";
    std::optional<double> time_step_s; // sampling of the load; none: chosen from its bandwidth
    double window_factor = 2.0;        // period of the time transform, divided by the duration
    double wrap_suppression = 1e6;     // attenuation of signals that wrap around in time
    double interpolation_tolerance =
        1e-9; // of the transfer function H in |k|, relative to nearby values
    bool operator==(const LayeredOptions&) const = default;
};

template <class Walk, Is<LayeredOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk(o.time_step_s,
         {.key = "time_step_us",
          .range = Range::at_least(0.01),
          .fallback = "from the bandwidth and the jumps of the load and from the medium",
          .meaning = "time between samples of the load"});
    walk(o.window_factor, {.key = "window_factor",
                           .range = Range::between(1.25, 16.0),
                           .meaning = "period of the time transform, divided by the duration"});
    walk(o.wrap_suppression,
         {.key = "wrap_suppression",
          .range = Range::between(10.0, 1e8),
          .meaning = "factor by which signals that wrap around in time are attenuated"});
    walk(o.interpolation_tolerance,
         {.key = "interpolation_tolerance",
          .range = Range::between(1e-12, 1e-3),
          .meaning = "relative error of the interpolation of the transfer function H in |k|"});
}

/// Treatment of lateral variation by engine `spectral`.
enum class SpectralMethod { automatic, one_solve, iterative };
constexpr auto names_of(std::type_identity<SpectralMethod>) {
    return std::array{"auto", "one-solve", "iterative"};
}

/// Engine `spectral`: Fourier in x and y, spectral elements in z, implicit in time.
struct SpectralOptions {
    static constexpr const char* name = "spectral";
    static constexpr double least_accuracy = 1e-4;
    std::optional<double> time_step_s; // none: chosen from the accuracy
    int degree = 8;
    double longest_element_m = 0.0; // 0: chosen from the load and the layers
    double absorbing_depth_m = 0.0; // below a half-space; 0: chosen from the load and the layer
    SpectralMethod method = SpectralMethod::automatic;
    double residual = 1e-3; // of the iterations: its energy norm relative to that of the motion
    double contrast_cap = 1000.0; // cap on mu of bodies, as a multiple of mu of the layer
    double rigid_above = 400.0; // bodies with more than this multiple of mu of the layer are rigid
    double accuracy = 1e-3;     // relative L2 error of the surface field; determines the time step
    bool operator==(const SpectralOptions&) const = default;
};

template <class Walk, Is<SpectralOptions> Options>
void walk_body_options(Walk& walk, Options& o) {
    walk(o.residual,
         {.key = "residual",
          .range = Range::between(1e-13, 1e-2),
          .meaning = "residual of the iterations: its energy norm relative to that of the motion"});
    walk(o.contrast_cap,
         {.key = "contrast_cap",
          .range = Range::between(1.0, 1e6),
          .meaning =
              "the shear modulus of bodies and maps is capped at this multiple of that of "
              "the surrounding layer. At 1000 and equal density, 0.94 of the amplitude of a "
              "shear wave is reflected (bone, which is denser: 0.955), compared with 1 for a "
              "rigid body. The number of iterations grows with the square root of the cap"});
    walk(
        o.rigid_above,
        {.key = "rigid_above",
         .range = Range::at_least(1.0),
         .in_text = o.rigid_above != SpectralOptions{}.rigid_above,
         .meaning =
             "a body whose shear modulus is more than this multiple of that of every layer around "
             "it is rigid, as with `rigid = true`, if rigid bodies support its shape and place and "
             "if it is at least as dense as these layers. Bodies that do not cross the domain "
             "along x or y must also be between 6 and about 50 grid spacings wide. Other bodies "
             "are elastic and subject to `contrast_cap`. 1e9 treats all bodies as elastic that are "
             "not marked as rigid"});
}

template <class Walk, Is<SpectralOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk(o.time_step_s, {.key = "time_step_us",
                         .range = Range::at_least(0.01),
                         .given = Given::automatic,
                         .fallback = "\"auto\": from the accuracy",
                         .meaning = "time step; shortened so that it divides the output interval"});
    walk(o.accuracy,
         {.key = "accuracy",
          .range = Range::between(SpectralOptions::least_accuracy, 0.1),
          .applies = !o.time_step_s,
          .only_with = "time_step_us = \"auto\"",
          .meaning =
              "largest relative L2 error of the surface field. The engine chooses the time step "
              "and the elements so that this error is met; the choice also depends on the load, "
              "the medium and the duration. For layers this is verified at 1e-2 and 1e-3"});
    walk(o.degree, {.key = "degree",
                    .range = Range::between(2, 16),
                    .meaning = "polynomial degree of the elements in z"});
    walk(o.longest_element_m,
         {.key = "longest_element_mm",
          .range = Range::above(0.0),
          .fallback = "none",
          .meaning = "upper limit of the length of the elements, which otherwise follows from the "
                     "footprint, the layers and, where present, bodies and the map"});
    walk(o.absorbing_depth_m,
         {.key = "absorbing_depth_mm",
          .range = Range::above(0.0),
          .in_text = o.absorbing_depth_m > 0.0,
          .fallback = "0.8 times the wider extent, at least 1.5 times the longest wavelength",
          .meaning = "depth of the absorbing layer that ends a half-space"});
    walk(
        o.method,
        {.key = "method",
         .meaning =
             "method where the medium varies laterally. `\"one-solve\"`: one solve per "
             "step, stable, but soft material next to stiff material is slightly too "
             "heavy; `\"iterative\"`: conjugate gradients with the exact operator; "
             "`\"auto\"`: one solve if it adds less than 2 % to the inertia (if `accuracy` "
             "determines the time step: also less than 0.3 times `accuracy`). Lateral variation of "
             "density, viscosity or c_p always requires iterations"});
    walk_body_options(walk, o);
}

/// Material above the surface z = 0 for engine `pstd`: none, the uppermost layer extended to
/// infinity, or a fluid.
enum class PstdTop { nothing, continued, fluid };
constexpr auto names_of(std::type_identity<PstdTop>) {
    return std::array{"void", "continued", "fluid"};
}
/// Effect of the load in `pstd`: it exerts pressure, or prescribes the displacement or the velocity
/// of the skin (PstdOptions).
enum class PstdLoad { traction, displacement, velocity };
constexpr auto names_of(std::type_identity<PstdLoad>) {
    return std::array{"traction", "displacement", "velocity"};
}
/// Where the motion of the skin is prescribed: wherever a focus passes during the run, or only
/// where it is at the moment.
enum class PstdPrescribed { path, focus };
constexpr auto names_of(std::type_identity<PstdPrescribed>) {
    return std::array{"path", "focus"};
}
/// Edges of the domain in x and y: periodic (or absorbing within the sponge), or with an absorbing
/// layer outside.
enum class PstdEdges { periodic, absorbing };
constexpr auto names_of(std::type_identity<PstdEdges>) {
    return std::array{"periodic", "absorbing"};
}
enum class Precision { single_precision, double_precision };
constexpr auto names_of(std::type_identity<Precision>) {
    return std::array{"single", "double"};
}
/// Where `pstd` computes.
enum class PstdDevice { cpu, gpu };
constexpr auto names_of(std::type_identity<PstdDevice>) {
    return std::array{"cpu", "gpu"};
}

/// Engine `pstd`: k-Wave's staggered pseudospectral scheme, explicit in time.
struct PstdOptions {
    static constexpr const char* name = "pstd";
    std::optional<double> time_step_s; // none: chosen from the stability rule
    double c_p_over_c_s = 10.0;        // upper limit of c_p, as a multiple of c_s
    PstdTop top = PstdTop::nothing;
    double fluid_density_kg_m3 = 1000.0, fluid_c_p_m_s = 1500.0; // for PstdTop::fluid
    PstdLoad load = PstdLoad::traction;
    double displacement_m = 0.0;     // for PstdLoad::displacement: u_z at the peak of the load
    double depth_m = 0.0;            // depth without absorbing layer; 0: chosen
    int absorbing_points = 16;       // thickness of the absorbing layer
    double absorbing_strength = 1.0; // Np per point at its outer edge
    PstdEdges edges = PstdEdges::periodic;
    Precision precision = Precision::double_precision;
    double velocity_m_s = 0.0; // for PstdLoad::velocity: of the skin at the peak of the load
    PstdPrescribed prescribed = PstdPrescribed::path; // for a prescribed motion
    PstdDevice device = PstdDevice::cpu;
    int device_number = -1; // of a GPU; -1: the teams on a machine use its devices in turn
    bool operator==(const PstdOptions&) const = default;
};

/// The first part: the scheme.
template <class Walk, Is<PstdOptions> Options>
void walk_scheme(Walk& walk, Options& o) {
    walk(o.time_step_s, {.key = "time_step_us",
                         .range = Range::at_least(0.01),
                         .given = Given::automatic,
                         .fallback = "\"auto\": from the stability rule",
                         .meaning = "time step; shortened so that it divides the output interval; "
                                    "an unstable step is rejected"});
    walk(o.c_p_over_c_s,
         {.key = "c_p_over_c_s",
          .range = Range::between(2.0, 1000.0),
          .meaning =
              "upper limit of c_p, as a multiple of c_s of its layer; the time step is inversely "
              "proportional to c_p. At 10 the surface field is in error by 3 %, at 20 by 1.4 %"});
    walk(o.top, {.key = "top",
                 .meaning = "material above the skin; `\"continued\"`: the uppermost layer extends "
                            "upward to infinity"});
    walk(o.fluid_density_kg_m3,
         {.key = "fluid_density_kg_m3",
          .range = Range::above(0.0),
          .applies = o.top == PstdTop::fluid,
          .only_with = "top = \"fluid\"",
          .meaning = "density of the fluid. A lighter fluid requires a shorter time step"});
    walk(o.fluid_c_p_m_s,
         {.key = "fluid_c_p_m_s",
          .range = Range::above(0.0),
          .applies = o.top == PstdTop::fluid,
          .only_with = "top = \"fluid\"",
          .meaning = "c_p of the fluid, at most `c_p_over_c_s` times c_s of the uppermost layer"});
}

/// The second part: what drives the skin.
template <class Walk, Is<PstdOptions> Options>
void walk_drive(Walk& walk, Options& o) {
    walk(o.load,
         {.key = "load",
          .meaning = "`\"traction\"`: the load exerts pressure; `\"displacement\"`: it prescribes "
                     "the displacement of the skin, with u_z = `displacement_um` at its peak, "
                     "independently of `peak_Pa`; `\"velocity\"`: it prescribes the velocity of "
                     "the skin, with `velocity_mm_s` at its peak. Use `ramp_ms` for a smooth start "
                     "of a prescribed motion"});
    walk(o.displacement_m, {.key = "displacement_um",
                            .range = Range::above(0.0),
                            .given = Given::required,
                            .applies = o.load == PstdLoad::displacement,
                            .only_with = "load = \"displacement\"",
                            .meaning = "displacement of the skin at the peak of the load"});
    walk(o.velocity_m_s, {.key = "velocity_mm_s",
                          .range = Range::above(0.0),
                          .given = Given::required,
                          .applies = o.load == PstdLoad::velocity,
                          .only_with = "load = \"velocity\"",
                          .meaning = "velocity of the skin at the peak of the load"});
    walk(o.prescribed,
         {.key = "prescribed",
          .applies = o.load != PstdLoad::traction,
          .only_with = "load = \"displacement\" or \"velocity\"",
          .in_text = o.prescribed != PstdPrescribed::path,
          .meaning =
              "where the motion is prescribed. `\"path\"`: at all points that a focus "
              "reaches during the run, even while it is elsewhere; `\"focus\"`: only at the "
              "points that a focus covers at the moment, at the rate at which the prescribed "
              "displacement changes; the skin elsewhere is free"});
}

/// The third part: the device.
template <class Walk, Is<PstdOptions> Options>
void walk_device(Walk& walk, Options& o) {
    walk(o.device,
         {.key = "device",
          .in_text = o.device != PstdDevice::cpu,
          .meaning = "`\"gpu\"` computes each case on a GPU with OpenCL, in a team of one rank"});
    walk(o.device_number,
         {.key = "device_number",
          .range = Range::between(-1, 1000),
          .applies = o.device == PstdDevice::gpu,
          .only_with = "device = \"gpu\"",
          .in_text = o.device_number != -1,
          .meaning = "number of the GPU, from 0; with -1 the teams on a machine use its devices "
                     "in turn"});
}

template <class Walk, Is<PstdOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk_scheme(walk, o);
    walk_drive(walk, o);
    walk(o.depth_m, {.key = "depth_mm",
                     .range = Range::above(0.0),
                     .in_text = o.depth_m > 0.0,
                     .fallback = "4 FWHM, and at least 2 FWHM below the lowest body",
                     .meaning = "depth of the domain without absorbing layer; with a rigid base, "
                                "the base determines it"});
    walk(o.absorbing_points, {.key = "absorbing_points",
                              .range = Range::between(8, 100),
                              .meaning = "thickness of the absorbing layer (PMLSize of k-Wave). It "
                                         "lies outside the domain, above and below"});
    walk(o.absorbing_strength,
         {.key = "absorbing_strength",
          .range = Range::between(0.0, 20.0),
          .meaning = "absorption in Np per point at the outer edge of the absorbing layer for the "
                     "fastest wave (PMLAlpha of k-Wave)"});
    walk(o.edges,
         {.key = "edges",
          .text = "absorbing_edges",
          .flag_in_text = true,
          .meaning = "edges in x and y. `\"periodic\"`: periodic, or absorbing within "
                     "`domain.sponge_mm` if that is given; `\"absorbing\"`: the absorbing layer "
                     "also lies outside the domain in x and y"});
    walk(o.precision,
         {.key = "precision",
          .meaning =
              "`\"single\"` requires half the memory and about 0.6 of the time of `\"double\"`"});
    walk_device(walk, o);
}

/// The options of the engine that computes a case. A new engine adds its options here and its
/// constructor to engines/registry/make_engine.cpp.
using SolverOptions = std::variant<LayeredOptions, SpectralOptions, PstdOptions>;

} // namespace shearwake
