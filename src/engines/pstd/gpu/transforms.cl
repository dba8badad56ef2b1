// SPDX-License-Identifier: BSD-3-Clause
// Derivatives along an axis in one pass: FFT, product with i k exp(+-i k d/2)/n, inverse FFT. Two
// real lines are the real and the imaginary part of a complex one. A group of GROUP work items
// transforms WIDTH complex lines of N points by Stockham's algorithm between two arrays of SPACE,
// which is __local, or __global where the lines are too long.
//
// ROWS = 0: lines along x or y, of which neighbours along z form pairs. Otherwise lines along z,
// the rows of ROWS: the rows 2 p and 2 p + 1 form a pair.

#define FOR_EACH(t, count) for (int t = (int)get_local_id(0); t < (count); t += GROUP)
// Consecutive work items work on consecutive values: of the lines of a bundle, or of a line.
#if ROWS
#define LINE(t, places) ((t) / (places))
#define PLACE(t, places) ((t) % (places))
#define AT(i, line) ((line) * N + (i))
#else
#define LINE(t, places) ((t) % WIDTH)
#define PLACE(t, places) ((t) / WIDTH)
#define AT(i, line) ((i) * WIDTH + (line))
#endif

static Real2 times(Real2 a, Real2 b) {
    return (Real2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
static Real2 turn(Real2 a) { // -i a
    return (Real2)(a.y, -a.x);
}

static void transform_2(Real2* x) {
    const Real2 a = x[0];
    x[0] = a + x[1];
    x[1] = a - x[1];
}
static void transform_3(Real2* x) {
    const Real2 sum = x[1] + x[2], d = turn(x[1] - x[2]) * (Real)0.86602540378443864676;
    const Real2 mid = x[0] - sum * (Real)0.5;
    x[0] += sum;
    x[1] = mid + d;
    x[2] = mid - d;
}
static void transform_4(Real2* x) {
    const Real2 a = x[0] + x[2], b = x[0] - x[2], c = x[1] + x[3], d = turn(x[1] - x[3]);
    x[0] = a + c;
    x[1] = b + d;
    x[2] = a - c;
    x[3] = b - d;
}
static void transform_5(Real2* x) {
    const Real c1 = (Real)0.30901699437494742410, c2 = (Real)-0.80901699437494742410;
    const Real s1 = (Real)0.95105651629515357212, s2 = (Real)0.58778525229247312917;
    const Real2 a = x[1] + x[4], b = x[2] + x[3], c = turn(x[1] - x[4]), d = turn(x[2] - x[3]);
    const Real2 p = x[0] + a * c1 + b * c2, q = x[0] + a * c2 + b * c1;
    const Real2 r = c * s1 + d * s2, s = c * s2 - d * s1;
    x[0] += a + b;
    x[1] = p + r;
    x[2] = q + s;
    x[3] = q - s;
    x[4] = p - r;
}
static void transform_8(Real2* x) {
    const Real h = (Real)0.70710678118654752440;
    Real2 even[4] = {x[0], x[2], x[4], x[6]}, odd[4] = {x[1], x[3], x[5], x[7]};
    transform_4(even);
    transform_4(odd);
    odd[1] = times(odd[1], (Real2)(h, -h));
    odd[2] = turn(odd[2]);
    odd[3] = times(odd[3], (Real2)(-h, -h));
    for (int k = 0; k < 4; ++k) {
        x[k] = even[k] + odd[k];
        x[k + 4] = even[k] - odd[k];
    }
}

// The stage of radix R after stages whose radices have the product `before`. `factor`: values are
// multiplied by it and conjugated first.
#define DEFINE_STAGE(R)                                                                            \
    static void stage_##R(int before, SPACE const Real2* from, SPACE Real2* to,                    \
                          __global const Real2* roots, int has_factor,                             \
                          __global const Real2* factor) {                                          \
        FOR_EACH(t, WIDTH*(N / R)) {                                                               \
            const int line = LINE(t, N / R), j = PLACE(t, N / R), k = j % before;                  \
            Real2 x[R];                                                                            \
            for (int r = 0; r < R; ++r) {                                                          \
                const int i = j + r * (N / R);                                                     \
                x[r] = from[AT(i, line)];                                                          \
                if (has_factor) x[r] = times(x[r], factor[i]) * (Real2)(1, -1);                    \
                if (r > 0 && before > 1) x[r] = times(x[r], roots[r * k * (N / (before * R))]);    \
            }                                                                                      \
            transform_##R(x);                                                                      \
            for (int r = 0; r < R; ++r)                                                            \
                to[AT((j - k) * R + k + r * before, line)] = x[r];                                 \
        }                                                                                          \
        barrier(FENCE);                                                                            \
    }
DEFINE_STAGE(2)
DEFINE_STAGE(3)
DEFINE_STAGE(4)
DEFINE_STAGE(5)
DEFINE_STAGE(8)

// The same for any radix: a sum for each value.
static void stage_any(int radix, int before, SPACE const Real2* from, SPACE Real2* to,
                      __global const Real2* roots, int has_factor, __global const Real2* factor) {
    const int apart = N / radix, step = N / (before * radix);
    FOR_EACH(t, WIDTH* N) {
        const int line = LINE(t, N), place = PLACE(t, N), j = place % apart, s = place / apart;
        const int k = j % before;
        Real2 sum = 0;
        for (int r = 0; r < radix; ++r) {
            const int i = j + r * apart;
            Real2 x = from[AT(i, line)];
            if (has_factor) x = times(x, factor[i]) * (Real2)(1, -1);
            sum += times(x, roots[r * (k + s * before) * step % N]);
        }
        to[AT((j - k) * radix + k + s * before, line)] = sum;
    }
    barrier(FENCE);
}

#if ROWS
// The pair of rows of a complex line, and whether they exist.
#define FIRST_ROW(line) (2 * ((int)get_group_id(0) * WIDTH + (line)))
#endif

// `columns` complex columns per plane and per point of a line; planes are `plane` apart.
__kernel void derive(__global const Real* from, __global Real* to, __global const Real2* factor,
                     __global const Real2* roots, long columns, long plane, SPACE Real2* space) {
#ifdef GLOBAL_SPACE
    space += (long)get_group_id(0) * 2 * N * WIDTH;
#endif
    SPACE Real2 *a = space, *b = space + N * WIDTH;
#if ROWS
    FOR_EACH(t, N * WIDTH) {
        const int line = LINE(t, N), i = PLACE(t, N);
        const long row = FIRST_ROW(line);
        a[AT(i, line)] = (Real2)(row < ROWS ? from[row * PITCH + i] : 0,
                                 row + 1 < ROWS ? from[(row + 1) * PITCH + i] : 0);
    }
#else
    const long bundles = columns / WIDTH, group = get_group_id(0);
    const long base = group / bundles * plane + group % bundles * WIDTH;
    __global const Real2* pairs = (__global const Real2*)from + base;
    FOR_EACH(t, N * WIDTH)
        a[AT(PLACE(t, N), LINE(t, N))] = pairs[PLACE(t, N) * columns + LINE(t, N)];
#endif
    barrier(FENCE);
    TRANSFORM(0)
    TRANSFORM(1)
#if ROWS
    FOR_EACH(t, N * WIDTH) {
        const int line = LINE(t, N), i = PLACE(t, N);
        const long row = FIRST_ROW(line);
        if (row < ROWS) to[row * PITCH + i] = a[AT(i, line)].x;
        if (row + 1 < ROWS) to[(row + 1) * PITCH + i] = -a[AT(i, line)].y;
    }
#else
    __global Real2* derived = (__global Real2*)to + base;
    FOR_EACH(t, N * WIDTH)
        derived[PLACE(t, N) * columns + LINE(t, N)] =
            a[AT(PLACE(t, N), LINE(t, N))] * (Real2)(1, -1);
#endif
}
