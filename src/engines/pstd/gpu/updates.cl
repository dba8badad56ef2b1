// SPDX-License-Identifier: BSD-3-Clause
// Updates of the fields, F_a <- Q_a (Q_a F_a + r_a) for each part a where parts are kept (kernels/
// update.hpp), and of their sum elsewhere. A work item has one point of a slab of NX x NY rows of
// NZ values, PITCH apart.

// Values [begin, end) of a row that keep parts, from `first` and `second` on in their arrays, and
// the axis in whose layer they are, or -1 (SplitRun).
typedef struct {
    int begin, end, face, unused;
    long first, second;
} Run;

#define FIELD(f)                                                                                   \
    __global Real *f, __global Real *f##_first, __global Real *f##_second,                         \
        __global const Real *f##_factor, __global const int *f##_start, __global const Run *f##_run

#define POINT                                                                                      \
    const int z = (int)get_global_id(0), y = (int)get_global_id(1), x = (int)get_global_id(2);     \
    if (z >= NZ || y >= NY) return;                                                                \
    const long row = (long)x * NY + y, at = row * PITCH + z;

// A coefficient that varies laterally, or is stored in four rows (Coefficient).
static Real value_of(__global const Real* c, int is_lateral, int x, int y, int z) {
    const long row = is_lateral ? (long)x * NY + y : (x == NX - 1 ? 1 : 0) + (y == NY - 1 ? 2 : 0);
    return c[row * PITCH + z];
}

// The layer's factor of a part.
static Real factor_of(__global const Real* factor, int part, int x, int y, int z) {
    __global const Real* f = factor + part * (NX + NY + NZ);
    return f[x] * f[NX + y] * f[NX + NY + z];
}

// The run that keeps parts of a value, or -1.
static int run_of(__global const int* start, __global const Run* runs, long row, int z) {
    for (int i = start[row]; i < start[row + 1]; ++i)
        if (z >= runs[i].begin && z < runs[i].end) return i;
    return -1;
}

// A total that is a kept part and a rest, each with its factor and its rate.
static Real update_two(Real total, __global Real* part, Real q_part, Real rate, Real q_rest,
                       Real rate_of_rest) {
    const Real others = total - *part, now = q_part * (q_part * *part + rate);
    *part = now;
    return q_rest * (q_rest * others + rate_of_rest) + now;
}

// `axes` of the parts.
static void update_three(FIELD(f), const int4 axes, int x, int y, int z, long row, long at,
                         Real r0, Real r1, Real r2) {
    const int i = run_of(f_start, f_run, row, z);
    if (i < 0) {
        f[at] += r0 + r1 + r2;
        return;
    }
    const Run run = f_run[i];
    __global Real* first = f_first + run.first + (z - run.begin);
    const Real q0 = factor_of(f_factor, 0, x, y, z), q1 = factor_of(f_factor, 1, x, y, z),
               q2 = factor_of(f_factor, 2, x, y, z);
    const Real total = f[at];
    if (run.face < 0) {
        __global Real* second = f_second + run.second + (z - run.begin);
        const Real rest = total - *first - *second;
        const Real new_1 = q1 * (q1 * *first + r1), new_2 = q2 * (q2 * *second + r2);
        *first = new_1;
        *second = new_2;
        f[at] = q0 * (q0 * rest + r0) + new_1 + new_2;
    } else if (run.face == axes.x) {
        f[at] = update_two(total, first, q0, r0, q1, r1 + r2);
    } else if (run.face == axes.y) {
        f[at] = update_two(total, first, q1, r1, q0, r0 + r2);
    } else {
        f[at] = update_two(total, first, q2, r2, q0, r0 + r1);
    }
}

static void update_pair(FIELD(f), const int4 axes, int x, int y, int z, long row, long at, Real r0,
                        Real r1) {
    const int i = run_of(f_start, f_run, row, z);
    if (i < 0) {
        f[at] += r0 + r1;
        return;
    }
    const Run run = f_run[i];
    __global Real* first = f_first + run.first + (z - run.begin);
    const Real q0 = factor_of(f_factor, 0, x, y, z), q1 = factor_of(f_factor, 1, x, y, z);
    if (run.face < 0 || run.face == axes.y)
        f[at] = update_two(f[at], first, q1, r1, q0, r0);
    else if (run.face == axes.x)
        f[at] = update_two(f[at], first, q0, r0, q1, r1);
    else // neither part has another factor
        f[at] = q0 * (q0 * f[at] + r0 + r1);
}

#define PASS(f) f, f##_first, f##_second, f##_factor, f##_start, f##_run

// rho du_i/dt = sum of the gradients g of the stresses, in the order of the parts.
__kernel void velocity(FIELD(u), int axis_0, int axis_1, int axis_2, __global const Real* dt_over_rho,
                       int is_lateral, __global const Real* g0, __global const Real* g1,
                       __global const Real* g2, __global Real* acceleration) {
    POINT
    const Real c = value_of(dt_over_rho, is_lateral, x, y, z);
    update_three(PASS(u), (int4)(axis_0, axis_1, axis_2, 0), x, y, z, row, at, c * g0[at],
                 c * g1[at], c * g2[at]);
#ifdef LOSSY
    acceleration[at] = c * (g0[at] + g1[at] + g2[at]);
#endif
}

// Normal stresses from e_xx, e_yy, e_zz and, lossy, the derivatives d of the accelerations.
__kernel void normal_stress(FIELD(sxx), FIELD(syy), FIELD(szz), __global const Real* dt_lambda,
                            int lambda_varies, __global const Real* dt_p_modulus,
                            int p_modulus_varies, __global const Real* chi, int chi_varies,
                            __global const Real* chi_2eta, int chi_2eta_varies,
                            __global const Real* exx, __global const Real* eyy,
                            __global const Real* ezz, __global const Real* dxx,
                            __global const Real* dyy, __global const Real* dzz) {
    POINT
    const Real l = value_of(dt_lambda, lambda_varies, x, y, z),
               m = value_of(dt_p_modulus, p_modulus_varies, x, y, z);
    Real lx = l * exx[at], ly = l * eyy[at], lz = l * ezz[at];
    Real mx = m * exx[at], my = m * eyy[at], mz = m * ezz[at];
#ifdef LOSSY
    const Real l_v = value_of(chi, chi_varies, x, y, z),
               m_v = value_of(chi_2eta, chi_2eta_varies, x, y, z);
    lx += l_v * dxx[at];
    ly += l_v * dyy[at];
    lz += l_v * dzz[at];
    mx += m_v * dxx[at];
    my += m_v * dyy[at];
    mz += m_v * dzz[at];
#endif
    update_three(PASS(sxx), (int4)(0, 1, 2, 0), x, y, z, row, at, mx, ly, lz);
    update_three(PASS(syy), (int4)(1, 0, 2, 0), x, y, z, row, at, my, lx, lz);
    update_three(PASS(szz), (int4)(2, 0, 1, 0), x, y, z, row, at, mz, lx, ly);
}

// A shear stress from both derivatives, in the order of the parts.
__kernel void shear_stress(FIELD(s), int axis_0, int axis_1, __global const Real* dt_mu,
                           int mu_varies, __global const Real* eta, int eta_varies,
                           __global const Real* e0, __global const Real* e1,
                           __global const Real* d0, __global const Real* d1) {
    POINT
    const Real mu = value_of(dt_mu, mu_varies, x, y, z);
    Real r0 = mu * e0[at], r1 = mu * e1[at];
#ifdef LOSSY
    const Real v = value_of(eta, eta_varies, x, y, z);
    r0 += v * d0[at];
    r1 += v * d1[at];
#endif
    update_pair(PASS(s), (int4)(axis_0, axis_1, 0, 0), x, y, z, row, at, r0, r1);
}
