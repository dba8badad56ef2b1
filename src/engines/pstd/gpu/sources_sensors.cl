// SPDX-License-Identifier: BSD-3-Clause
// What is put into the fields and read of them: sources, tallies, sensors, energy.

// The place of a node of a source: its total, its kept parts or -1, whether the first is the part of
// the field's own axis; scale, work and value of the processor (PlacedSource::Place).
typedef struct {
    long total, part[2];
    char has_own_part;
    long unused[3];
} Place;

// MODE 0 additive, 1 dirichlet, 2 total. PARTS of the field, SHARES of a stress.
__kernel void apply_source(__global Real* total, __global Real* first, __global Real* second,
                           __global const Real* uz, __global Real* leaps,
                           __global const Place* places, __global const Sum* per_work,
                           __global Real* before, __global Sum* work,
                           __global const Real* values, long first_value, long count,
                           char is_velocity, int mode, char in_rates, long parts) {
    const long i = get_global_id(0);
    if (i >= count) return;
    const Place place = places[i];
    const Real value = values[first_value + i], was = total[place.total];
    if (isnan(value)) {
        before[i] = was;
        return;
    }
    const Real share = value / (IS_PLANE ? 2 : 3);
    const Real into_total = is_velocity || IS_PLANE ? value : share * parts;
    Real others = 0; // of the other parts of a prescribed velocity
    for (int p = 0; p < 2; ++p) {
        if (place.part[p] < 0) continue;
        __global Real* part = (p == 0 ? first : second) + place.part[p];
        if (is_velocity && mode == 0)
            *part += place.has_own_part ? value : 0;
        else if (is_velocity)
            others += *part;
        else
            *part = mode == 0 ? *part + share : share;
    }
    const Real now = mode == 0 ? was + into_total : mode == 2 ? value : others + into_total;
    total[place.total] = now;
    if (in_rates) leaps[place.total] += now - was;
    const Sum mean = ((Sum)before[i] + (Sum)now) / 2;
    before[i] = now;
    work[i] += per_work[i] * mean * (Sum)(is_velocity ? now - was : uz[place.total]);
}

// A field, or the pressure of three normal stresses.
static Real quantity(__global const Real* a, __global const Real* b, __global const Real* c,
                     char is_pressure, long at) {
    if (!is_pressure) return a[at];
    return IS_PLANE ? -(b[at] + c[at]) / 2 : -(a[at] + b[at] + c[at]) / 3;
}

// KIND 0 sum, 1 largest, 2 smallest value.
__kernel void tally(__global const Real* a, __global const Real* b, __global const Real* c,
                    char is_pressure, int kind, long first_z, long planes,
                    __global const Real* scale, long count, __global Sum* values) {
    const long i = get_global_id(0);
    if (i >= count) return;
    const Sum now = quantity(a, b, c, is_pressure, i / planes * PITCH + first_z + i % planes),
              was = values[i];
    values[i] = kind == 0 ? was + *scale * now : kind == 1 ? fmax(was, now) : fmin(was, now);
}

__kernel void gather(__global const Real* a, __global const Real* b, __global const Real* c,
                     char is_pressure, __global const long* offsets, long count,
                     __global Real* values, long first) {
    const long i = get_global_id(0);
    if (i < count) values[first + i] = quantity(a, b, c, is_pressure, offsets[i]);
}

// Sums of weights[(i - j) mod n] u[j] over the lines of the nodes, whose points are `stride` apart.
__kernel void line_sums(__global const Real* u, __global const Sum* weights,
                        __global const long* offsets, long count, long n, long stride,
                        __global Sum* sums) {
    const long node = get_global_id(0);
    if (node >= count) return;
    const long at = offsets[node], i = at / stride % (stride == 1 ? PITCH : n);
    __global const Real* line = u + (at - i * stride);
    Sum sum = 0;
    for (long j = 0; j < n; ++j)
        sum += weights[(i - j + n) % n] * line[j * stride];
    sums[node] = sum;
}

// Of v^2/(dt/rho) at the planes from first_z on, one sum for each work item.
__kernel void kinetic(__global const Real* u, __global const Real* dt_over_rho, char is_lateral,
                      long first_z, __global Sum* sums) {
    const long planes = NZ - first_z;
    Sum sum = 0;
    for (long i = get_global_id(0); i < NX * NY * planes; i += get_global_size(0)) {
        const long row = i / planes, z = first_z + i % planes;
        const Real v = u[row * PITCH + z];
        sum += (Sum)v * v / value_of(dt_over_rho, is_lateral, row / NY, row % NY, z);
    }
    sums[get_global_id(0)] += sum;
}
