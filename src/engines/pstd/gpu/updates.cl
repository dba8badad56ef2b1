// SPDX-License-Identifier: BSD-3-Clause
// Updates of the fields, F_a <- Q_a (Q_a F_a + r_a) for each part a where parts are kept (kernels/
// update.hpp), and of their sum elsewhere. A work item has one point of a slab of NX x NY rows of
// NZ values, PITCH apart. Parts can be large and cancel in the sum, so changes of parts are added,
// which are products with Q - 1: in single precision p erred by 2.4e-5 with Q, and errs by 3.7e-6.

// Values [begin, end) of a row that keep parts, from `first` and `second` on in their arrays, and
// the axis in whose layer they are, or -1 (SplitRun).
typedef struct {
    long begin, end, first, second;
    int face, unused;
} Run;

#define FIELD(f)                                                                                   \
    __global Real *f, __global Real *f##_first, __global Real *f##_second,                         \
        __global const Real *f##_factor, __global const long *f##_start,                           \
        __global const Run *f##_run

#define POINT                                                                                      \
    const long z = get_global_id(0), y = get_global_id(1), x = get_global_id(2);                   \
    if (z >= NZ) return;                                                                           \
    const long row = x * NY + y, at = row * PITCH + z;

// A coefficient that varies laterally, or is stored in four rows (Coefficient).
static Real value_of(__global const Real* c, char is_lateral, long x, long y, long z) {
    const long row = is_lateral ? x * NY + y : (x == NX - 1 ? 1 : 0) + (y == NY - 1 ? 2 : 0);
    return c[row * PITCH + z];
}

// The layer's factor Q of a part, minus 1.
static Real loss_of(__global const Real* factor, int part, long x, long y, long z) {
    __global const Real* f = factor + part * (NX + NY + NZ);
    const Real a = f[x] - 1, b = f[NX + y] - 1, c = f[NX + NY + z] - 1, ab = a + b + a * b;
    return ab + c + ab * c;
}

// The run that keeps parts of a value, or the end of the runs of its row.
static long run_of(__global const long* start, __global const Run* runs, long row, long z) {
    long i = start[row];
    while (i < start[row + 1] && (z < runs[i].begin || z >= runs[i].end))
        ++i;
    return i;
}

// Q (Q F + r) - F for h = Q - 1.
static Real change_of(Real value, Real h, Real rate) {
    return h * (2 + h) * value + (rate + h * rate);
}

// A field with 3 parts, or 2 if r2 is 0, of these axes.
static void update(FIELD(f), int parts, long axis_0, long axis_1, long x, long y, long z, long row,
                   long at, Real r0, Real r1, Real r2) {
    const long i = run_of(f_start, f_run, row, z);
    if (i == f_start[row + 1]) {
        f[at] += r0 + r1 + r2;
        return;
    }
    // The first array keeps a part; the others have one factor, or the second array keeps part 2.
    const Run run = f_run[i];
    const int kept = run.face == axis_0 ? 0 : run.face < 0 || run.face == axis_1 ? 1 : 2;
    const Real total = f[at];
    Real others = total, change = 0, rate = kept == 0 ? r1 + r2 : kept == 1 ? r0 + r2 : r0 + r1;
    if (kept < parts) {
        __global Real* part = f_first + run.first + (z - run.begin);
        others -= *part;
        change = change_of(*part, loss_of(f_factor, kept, x, y, z),
                           kept == 0 ? r0 : kept == 1 ? r1 : r2);
        *part += change;
    }
    if (run.face < 0 && parts == 3) {
        __global Real* part = f_second + run.second + (z - run.begin);
        const Real more = change_of(*part, loss_of(f_factor, 2, x, y, z), r2);
        others -= *part;
        rate = r0;
        change += more;
        *part += more;
    }
    f[at] = total + (change + change_of(others, loss_of(f_factor, kept == 0, x, y, z), rate));
}

#define PASS(f) f, f##_first, f##_second, f##_factor, f##_start, f##_run

// rho du_i/dt = sum of the gradients g of the stresses, in the order of the parts.
__kernel void velocity(FIELD(u), long axis_0, long axis_1, __global const Real* dt_over_rho,
                       char is_lateral, __global const Real* g0, __global const Real* g1,
                       __global const Real* g2, __global Real* acceleration) {
    POINT
    const Real c = value_of(dt_over_rho, is_lateral, x, y, z);
    update(PASS(u), 3, axis_0, axis_1, x, y, z, row, at, c * g0[at], c * g1[at], c * g2[at]);
#ifdef LOSSY
    acceleration[at] = c * (g0[at] + g1[at] + g2[at]);
#endif
}

// Normal stresses from e_xx, e_yy, e_zz and, lossy, the derivatives d of the accelerations.
__kernel void normal_stress(FIELD(sxx), FIELD(syy), FIELD(szz), __global const Real* dt_lambda,
                            char lambda_varies, __global const Real* dt_p_modulus,
                            char p_modulus_varies, __global const Real* chi, char chi_varies,
                            __global const Real* chi_2eta, char chi_2eta_varies,
                            __global const Real* exx, __global const Real* eyy,
                            __global const Real* ezz, __global const Real* dxx,
                            __global const Real* dyy, __global const Real* dzz) {
    POINT
    Real3 l = value_of(dt_lambda, lambda_varies, x, y, z) * (Real3)(exx[at], eyy[at], ezz[at]),
          m = value_of(dt_p_modulus, p_modulus_varies, x, y, z) * (Real3)(exx[at], eyy[at], ezz[at]);
#ifdef LOSSY
    l += value_of(chi, chi_varies, x, y, z) * (Real3)(dxx[at], dyy[at], dzz[at]);
    m += value_of(chi_2eta, chi_2eta_varies, x, y, z) * (Real3)(dxx[at], dyy[at], dzz[at]);
#endif
    update(PASS(sxx), 3, 0, 1, x, y, z, row, at, m.x, l.y, l.z);
    update(PASS(syy), 3, 1, 0, x, y, z, row, at, m.y, l.x, l.z);
    update(PASS(szz), 3, 2, 0, x, y, z, row, at, m.z, l.x, l.y);
}

// A shear stress from both derivatives, in the order of the parts.
__kernel void shear_stress(FIELD(s), long axis_0, long axis_1, __global const Real* dt_mu,
                           char mu_varies, __global const Real* eta, char eta_varies,
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
    update(PASS(s), 2, axis_0, axis_1, x, y, z, row, at, r0, r1, 0);
}
