// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/body.hpp"
#include "problem/medium/medium.hpp"

namespace shearwake {

template <class Walk, Is<Orientation> O>
void walk_fields(Walk& walk, O& o) {
    walk(o.azimuth_deg, {.key = "azimuth_deg",
                         .text = "azimuth_deg",
                         .range = azimuth_range,
                         .given = Given::by_hand,
                         .in_text = o.azimuth_deg != 0.0,
                         .meaning = "turn about the vertical, from x towards y"});
    walk(o.inclination_deg,
         {.key = "inclination_deg",
          .text = "inclination_deg",
          .range = inclination_range,
          .given = Given::by_hand,
          .in_text = o.inclination_deg != 0.0,
          .meaning = "tilt of the body's own x axis out of the horizontal plane, downwards"});
    walk(o.roll_deg,
         {.key = "roll_deg",
          .text = "roll_deg",
          .range = roll_range,
          .given = Given::by_hand,
          .in_text = o.roll_deg != 0.0,
          .meaning = "turn of the body about its own x axis, from its y axis towards "
                     "its z axis. The azimuth and the inclination then turn this axis"});
}

template <class Walk, Is<Ellipsoid> Shape>
void walk_fields(Walk& walk, Shape& shape) {
    walk(shape.semi_axes_m, {.key = "semi_axes_mm",
                             .range = Range::above(0.0),
                             .given = Given::required,
                             .meaning = "semi-axes `[x, y, z]` along the body's own axes"});
    walk_fields(walk, shape.orientation);
}

template <class Walk, Is<Cylinder> Shape>
void walk_fields(Walk& walk, Shape& shape) {
    walk(shape.axis, {.key = "axis",
                      .given = Given::by_hand,
                      .type = "word:x|y|z",
                      .fallback = "required, or `azimuth_deg`",
                      .meaning = "direction of the axis: `\"x\"`, `\"y\"` or `\"z\"` (vertical)"});
    walk(shape.radius_m, {.key = "radius_mm",
                          .range = Range::above(0.0),
                          .given = Given::required,
                          .meaning = "radius"});
    walk(shape.length_m,
         {.key = "length_mm",
          .range = Range::above(0.0),
          .zero_in_text = shape.is_endless(),
          .fallback = "infinite",
          .meaning = "length; without it, the cylinder crosses the whole domain. `check` warns if "
                     "an infinitely long cylinder is not parallel to x or y, since its ends at the "
                     "periodic edges do not match"});
    walk(shape.azimuth_deg,
         {.key = "azimuth_deg",
          .text = "azimuth_deg",
          .range = Range::between(-360.0, 360.0),
          .given = Given::by_hand,
          .zero_in_text = shape.axis == CylinderAxis::vertical,
          .meaning = "direction of the axis along the surface, as an angle from x towards y"});
    walk(shape.inclination_deg,
         {.key = "inclination_deg",
          .text = "inclination_deg",
          .range = inclination_range,
          .given = Given::by_hand,
          .in_text = shape.inclination_deg != 0.0,
          .meaning = "tilt of the axis out of the horizontal plane, downwards. Requires "
                     "`azimuth_deg` and `length_mm`"});
}

template <class Walk, Is<Box> Shape>
void walk_fields(Walk& walk, Shape& shape) {
    walk(shape.size_m, {.key = "size_mm",
                        .range = Range::above(0.0),
                        .given = Given::required,
                        .meaning = "lengths `[x, y, z]` of the edges along the body's own axes"});
    walk_fields(walk, shape.orientation);
}

template <class Walk, Is<Body> B>
void walk_rigidity(Walk& walk, B& body) {
    walk(body.rigid,
         {.key = "rigid",
          .in_text = body.rigid,
          .meaning = "whether the body is rigid; only the density of its material matters then. It "
                     "costs one additional solve per step, whatever its stiffness. Requires the "
                     "engine `\"spectral\"`"});
    walk(body.fixed, {.key = "fixed",
                      .applies = body.rigid,
                      .only_with = "rigid = true",
                      .in_text = body.rigid && body.fixed,
                      .meaning = "whether the rigid body is held in place; otherwise it moves and "
                                 "turns with its mass. A body that reaches the rigid base is "
                                 "always held"});
}

template <class Walk, Is<Body> B>
void walk_fields(Walk& walk, B& body) {
    walk.key({.key = "preset",
              .type = "word",
              .fallback = "none",
              .meaning =
                  "name of a preset that supplies the properties that are not given: "
                  "`\"cortical-bone\"` (rho 1900 kg/m3, c_p 3517 m/s, c_s 1619 m/s, no loss; the "
                  "isotropic mean of the stiffness of the tibia in Hoffmeister 2000)"});
    walk(body.name,
         {.key = "name", .fallback = "body 1 ...", .meaning = "name in messages and notes"});
    walk.choice(body.shape, {.key = "shape", .text = "shape", .meaning = "shape of the body"});
    walk(body.centre_m, {.key = "center_mm",
                         .text = "centre_m",
                         .given = Given::by_hand,
                         .type = "point or triple",
                         .fallback = "required",
                         .meaning = "centre `[x, y, z]`, where z is the depth; or `[x, y]` "
                                    "together with `depth_mm`, which can be swept as a number"});
    walk.key({.key = "depth_mm",
              .type = "number",
              .fallback = "none",
              .meaning = "z of the centre, where `center_mm` is `[x, y]`"});
    walk(body.edge_m,
         {.key = "edge_mm",
          .range = Range::at_least(0.0),
          .meaning =
              "width of a smooth transition to the surroundings, half of it inside and half "
              "outside the body; all derivatives are continuous. It must not exceed the smallest "
              "width of the body. 0: a sharp surface, averaged over each cell of the grid"});
    walk(body.density_kg_m3,
         {.key = "density_kg_m3",
          .range = Range::above(0.0),
          .fallback = "that of the surrounding layer or map",
          .meaning = "density; at least one of this and the three keys below must be given"});
    walk(body.c_p_m_s, {.key = "c_p_m_s",
                        .range = Range::above(0.0),
                        .fallback = "that of the surrounding layer or map",
                        .meaning = "speed of compressional waves"});
    walk(body.c_s_m_s, {.key = "c_s_m_s",
                        .range = Range::at_least(0.0),
                        .fallback = "that of the surrounding layer or map",
                        .meaning = "speed of shear waves; 0 is a fluid, which requires the engine "
                                   "`\"pstd\"` and a value of `viscosity_Pa_s`, which may be 0"});
    walk(body.viscosity_Pa_s, {.key = "viscosity_Pa_s",
                               .range = Range::at_least(0.0),
                               .fallback = "that of the surrounding layer or map",
                               .meaning = "viscosity"});
    walk_rigidity(walk, body);
}

template <class Walk, Is<Lossless> Loss>
void walk_fields(Walk&, Loss&) {}

template <class Walk, Is<KelvinVoigt> Loss>
void walk_fields(Walk& walk, Loss& loss) {
    walk(loss.viscosity_Pa_s, {.key = "viscosity_Pa_s",
                               .range = Range::at_least(0.0),
                               .given = Given::required,
                               .meaning = "viscosity in mu = rho c_s^2 + i omega viscosity"});
}

template <class Walk, Is<FractionalKelvinVoigt> Loss>
void walk_fields(Walk& walk, Loss& loss) {
    walk(loss.tau_s,
         {.key = "tau_us",
          .range = Range::above(0.0),
          .given = Given::required,
          .meaning = "relaxation time tau in the shear modulus mu0 (1 + (i omega tau)^n)"});
    walk(loss.exponent, {.key = "exponent",
                         .range = Range::inside(0.0, 1.0),
                         .given = Given::required,
                         .meaning = "exponent n in the same formula"});
}

template <class Walk, Is<StandardLinearSolid> Loss>
void walk_fields(Walk& walk, Loss& loss) {
    walk(loss.tau_s, {.key = "tau_us",
                      .range = Range::above(0.0),
                      .given = Given::required,
                      .meaning = "relaxation time tau in the shear modulus mu0 (1 + strength i "
                                 "omega tau / (1 + i omega tau))"});
    walk(loss.strength, {.key = "strength",
                         .range = Range::above(0.0),
                         .given = Given::required,
                         .meaning = "strength in the same formula: the high-frequency limit of mu, "
                                    "divided by mu0, minus 1"});
}

template <class Walk, Is<Layer> L>
void walk_fields(Walk& walk, L& layer) {
    walk.key(
        {.key = "preset",
         .type = "word",
         .fallback = "none",
         .meaning = "name of a preset that supplies the keys of the layer that are not given"});
    walk(layer.name,
         {.key = "name", .fallback = "layer 1 ...", .meaning = "name in messages and notes"});
    walk(layer.thickness_m, {.key = "thickness_mm",
                             .range = Range::above(0.0),
                             .given = Given::by_hand,
                             .fallback = "required; none for the last layer of a half-space",
                             .meaning = "thickness"});
    walk(layer.density_kg_m3, {.key = "density_kg_m3",
                               .range = Range::above(0.0),
                               .given = Given::required,
                               .meaning = "density"});
    walk(layer.c_p_m_s, {.key = "c_p_m_s",
                         .range = Range::above(0.0),
                         .given = Given::required,
                         .meaning = "speed of compressional waves"});
    walk(layer.c_s_m_s, {.key = "c_s_m_s",
                         .range = Range::above(0.0),
                         .given = Given::required,
                         .meaning = "speed of shear waves"});
    walk.choice(layer.loss,
                {.key = "loss.law",
                 .text = "loss",
                 .meaning = "loss model of the layer, for example `{ law = \"fractional\", tau_us "
                            "= 260.0, exponent = 0.27 }`, or "
                            "`\"none\"`; a Kelvin-Voigt layer can give `viscosity_Pa_s` instead"});
    walk.key({.key = "viscosity_Pa_s",
              .range = Range::at_least(0.0),
              .type = "number",
              .fallback = "none",
              .meaning = "instead of `loss`: `{ law = \"kelvin-voigt\", viscosity_Pa_s = ... }`"});
}

template <class Walk, Is<Medium> M>
void walk_fields(Walk& walk, M& medium) {
    walk.section("medium");
    walk.key({.key = "preset",
              .type = "word",
              .fallback = "none",
              .meaning = "name of a complete medium, instead of layers: `thesis-tissue`, "
                         "`ecoflex`, `forearm`, `palm`, `fingertip`, `three-layer-skin`"});
    walk(medium.base,
         {.key = "base",
          .given = Given::required,
          .meaning =
              "`\"rigid\"`: the last layer is bonded to a rigid base; `\"half-space\"`: the last "
              "layer extends to infinity; omit its `thickness_mm`. Engine `\"layered\"` computes "
              "this exactly; `\"spectral\"` and `\"pstd\"` end the layer with an absorber"});
    walk(medium.map,
         {.key = "map",
          .given = Given::by_hand,
          .fallback = "none",
          .meaning = "HDF5 file of material properties; its path is relative to the job file"});
    walk.each("medium.layer", medium.layers, {.meaning = "layers, from the surface downward"});
    walk.each("medium.body", medium.bodies,
              {.meaning = "bodies; where they overlap, the later one replaces the earlier one"});
}

} // namespace shearwake
