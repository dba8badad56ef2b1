// SPDX-License-Identifier: BSD-3-Clause
/// Engine `springs`: skin of independent springs.
struct SpringsOptions {
    static constexpr const char* name = "springs";
    double modulus_Pa = 2e5; // of each spring
    double length_m = 5e-3;  // of each spring
    bool operator==(const SpringsOptions&) const = default;
};

template <class Walk, Is<SpringsOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk(o.modulus_Pa,
         {.key = "modulus_kPa", .range = Range::above(0.0), .meaning = "modulus of the springs"});
    walk(o.length_m,
         {.key = "length_mm", .range = Range::above(0.0), .meaning = "length of the springs"});
}
