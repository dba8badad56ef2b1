// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <array>
#include <optional>
#include <type_traits>

namespace shearwake {

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
    double rigid_above = 1000.0; // bodies with more than this multiple of mu of the layer are rigid
    double accuracy = 1e-3;      // relative L2 error of the surface field; determines the time step
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
             "along x or y must also be smaller than about 50 grid spacings. Other bodies are "
             "elastic and subject to `contrast_cap`. 1e9 treats all bodies as elastic that are "
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

} // namespace shearwake
