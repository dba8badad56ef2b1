// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/kernels/response.hpp"

#include "simd/kernels.hpp"
#include "simd/vector.hpp"

namespace shearwake::layered {
namespace {

using namespace simd;

/// Complex numbers as two vectors of real and imaginary parts, one number per lane.
struct ComplexVector {
    Vector re, im;
};
[[gnu::always_inline]] inline ComplexVector ascending(const double* from) {
    ComplexVector v;
    load_ascending(from, v.re, v.im);
    return v;
}
[[gnu::always_inline]] inline ComplexVector times(ComplexVector a, ComplexVector b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

void multiply(const double* a, const double* b, std::ptrdiff_t count, double* product) {
    std::ptrdiff_t i = 0;
    for (; i + width <= count; i += width) {
        const ComplexVector c = times(ascending(a + 2 * i), ascending(b + 2 * i));
        store_ascending(c.re, c.im, product + 2 * i);
    }
    for (; i < count; ++i) {
        const double re = a[2 * i] * b[2 * i] - a[2 * i + 1] * b[2 * i + 1];
        product[2 * i + 1] = a[2 * i] * b[2 * i + 1] + a[2 * i + 1] * b[2 * i];
        product[2 * i] = re;
    }
}

/// to += value * coefficients, for `count` doubles.
void add_product(Vector value, const double* coefficients, std::ptrdiff_t count, double* to) {
    std::ptrdiff_t l = 0;
    for (; l + width <= count; l += width)
        store(load(to + l) + value * load(coefficients + l), to + l);
    for (std::ptrdiff_t lane = 0; l + lane < count; ++lane)
        to[l + lane] += value[lane] * coefficients[l + lane];
}

void distribute(const double* values, const double* coefficients, const std::ptrdiff_t* first,
                std::ptrdiff_t nodes, std::ptrdiff_t taps, double* samples, std::ptrdiff_t count) {
    for (std::ptrdiff_t n = 0; n < nodes; ++n, coefficients += 2 * taps) {
        const Vector value = load_in_turns(values + 2 * n);
        // A period may have fewer samples than there are taps.
        for (std::ptrdiff_t l = 0, at = first[n]; l < taps; at = 0) {
            const std::ptrdiff_t before_end = std::min(taps - l, count - at);
            add_product(value, coefficients + 2 * l, 2 * before_end, samples + 2 * at);
            l += before_end;
        }
    }
}

void add_tail(const double* h, std::ptrdiff_t values, const double* weights, std::ptrdiff_t count,
              const double* jumps, std::ptrdiff_t orders, double* line) {
    std::ptrdiff_t n = 0;
    for (; n + width <= count; n += width) {
        Vector re, im;
        load_ascending(line + 2 * n, re, im);
        const double* w = weights + n;
        for (std::ptrdiff_t b = 0; b < orders; ++b) {
            Vector response{};
            for (std::ptrdiff_t v = 0; v < values; ++v, w += count)
                response += h[v] * load(w);
            re += jumps[2 * b] * response;
            im += jumps[2 * b + 1] * response;
        }
        store_ascending(re, im, line + 2 * n);
    }
    for (; n < count; ++n) {
        const double* w = weights + n;
        for (std::ptrdiff_t b = 0; b < orders; ++b) {
            double response = 0.0;
            for (std::ptrdiff_t v = 0; v < values; ++v, w += count)
                response += h[v] * *w;
            line[2 * n] += jumps[2 * b] * response;
            line[2 * n + 1] += jumps[2 * b + 1] * response;
        }
    }
}

/// Computes line[m] += h[m] roll[m] load[m] for `count` values of m; on the negative side with the
/// conjugate of h[-m] and with roll[-m].
enum class Side { positive, negative };
template <Side side>
[[gnu::always_inline]] inline void add_products(const double* h, const double* roll,
                                                const double* load, std::ptrdiff_t count,
                                                double* line) {
    std::ptrdiff_t m = 0;
    for (; m + width <= count; m += width) {
        ComplexVector H;
        Vector r;
        if (side == Side::positive) {
            H = ascending(h + 2 * m);
            r = simd::load(roll + m);
        } else {
            load_descending(h - 2 * (m + width - 1), H.re, H.im);
            H.im = -H.im;
            const Vector up = simd::load(roll - (m + width - 1));
            for (std::ptrdiff_t lane = 0; lane < width; ++lane)
                r[lane] = up[width - 1 - lane];
        }
        const ComplexVector sum = ascending(line + 2 * m);
        const ComplexVector more = times({r * H.re, r * H.im}, ascending(load + 2 * m));
        store_ascending(sum.re + more.re, sum.im + more.im, line + 2 * m);
    }
    for (; m < count; ++m) {
        const std::ptrdiff_t at = side == Side::positive ? m : -m;
        const double re = roll[at] * h[2 * at];
        const double im = roll[at] * h[2 * at + 1] * (side == Side::positive ? 1.0 : -1.0);
        line[2 * m] += re * load[2 * m] - im * load[2 * m + 1];
        line[2 * m + 1] += re * load[2 * m + 1] + im * load[2 * m];
    }
}

void respond(const double* h, const double* roll, const double* load, std::ptrdiff_t samples,
             std::ptrdiff_t coarse, double* line) {
    for (std::ptrdiff_t i = 0; i < 2 * coarse; ++i)
        line[i] = 0.0;
    const std::ptrdiff_t highest = samples / 2;
    for (std::ptrdiff_t first = 0; first < samples; first += coarse) {
        const std::ptrdiff_t end = first + coarse;
        const std::ptrdiff_t positive_end = end < highest ? end : highest;
        if (first < positive_end)
            add_products<Side::positive>(h + 2 * first, roll + first, load + 2 * first,
                                         positive_end - first, line);
        const std::ptrdiff_t begin = first > highest + 1 ? first : highest + 1;
        if (begin < end)
            add_products<Side::negative>(h + 2 * (samples - begin), roll + (samples - begin),
                                         load + 2 * begin, end - begin, line + 2 * (begin - first));
    }
}

void turn(const double* lines_begin, std::ptrdiff_t lines, std::ptrdiff_t pitch,
          std::ptrdiff_t count, std::ptrdiff_t stride, double* out) {
    for (std::ptrdiff_t n = 0; n < count; ++n)
        for (std::ptrdiff_t l = 0; l < lines; ++l) {
            const double* value = lines_begin + 2 * (l * pitch + n);
            out[2 * (n * stride + l)] = value[0];
            out[2 * (n * stride + l) + 1] = value[1];
        }
}

void scale_row(const double* values, const double* factors, double growth, std::ptrdiff_t n,
               double* row) {
    const Vector g = all_lanes(growth);
    std::ptrdiff_t i = 0;
    for (; i + width <= n; i += width) {
        const ComplexVector f = ascending(factors + 2 * i);
        const ComplexVector c = times(ascending(values + 2 * i), {g * f.re, g * f.im});
        store_ascending(c.re, c.im, row + 2 * i);
    }
    for (; i < n; ++i) {
        const double re = growth * factors[2 * i], im = growth * factors[2 * i + 1];
        row[2 * i] = re * values[2 * i] - im * values[2 * i + 1];
        row[2 * i + 1] = re * values[2 * i + 1] + im * values[2 * i];
    }
}

void scale_mirrored_row(const double* values, const double* factors, double growth,
                        std::ptrdiff_t n, double* row) {
    const std::ptrdiff_t half = n / 2;
    scale_row(values, factors, growth, half + 1, row);
    const Vector g = all_lanes(growth);
    std::ptrdiff_t i = half + 1;
    for (; i + width <= n; i += width) {
        ComplexVector v;
        load_descending(values + 2 * (n - i - width + 1), v.re, v.im);
        const ComplexVector f = ascending(factors + 2 * i);
        const ComplexVector c = times({v.re, -v.im}, {g * f.re, g * f.im});
        store_ascending(c.re, c.im, row + 2 * i);
    }
    for (; i < n; ++i) {
        const double re = growth * factors[2 * i], im = growth * factors[2 * i + 1];
        const double* v = values + 2 * (n - i);
        row[2 * i] = re * v[0] + im * v[1];
        row[2 * i + 1] = im * v[0] - re * v[1];
    }
}

/// Evaluates even and odd terms in parallel: T_{j+2} = 2 T_2 T_j - T_{j-2}.
void chebyshev(const double* coefficients, std::ptrdiff_t order, const double* x,
               std::ptrdiff_t count, double* out, std::ptrdiff_t stride) {
    for (std::ptrdiff_t i = 0; i < count; i += width) {
        const std::ptrdiff_t here = count - i < width ? count - i : width;
        Vector at{};
        for (std::ptrdiff_t lane = 0; lane < here; ++lane)
            at[lane] = x[i + lane];
        const Vector t2 = 2.0 * (2.0 * at * at - 1.0);
        Vector even = all_lanes(1.0), even_before = 0.5 * t2, odd = at, odd_before = at;
        Vector re{}, im{};
        for (std::ptrdiff_t j = 0; j < order; j += 2) {
            const double* c = coefficients + 2 * j;
            re += c[0] * even + c[2] * odd;
            im += c[1] * even + c[3] * odd;
            const Vector even_next = t2 * even - even_before, odd_next = t2 * odd - odd_before;
            even_before = even;
            odd_before = odd;
            even = even_next;
            odd = odd_next;
        }
        for (std::ptrdiff_t lane = 0; lane < here; ++lane) {
            out[2 * (i + lane) * stride] = re[lane];
            out[2 * (i + lane) * stride + 1] = im[lane];
        }
    }
}

constexpr ResponseKernels table = {multiply, distribute, add_tail,           respond,
                                   turn,     scale_row,  scale_mirrored_row, chebyshev};

} // namespace
} // namespace shearwake::layered

template <>
const shearwake::layered::ResponseKernels&
shearwake::simd::compiled<shearwake::layered::ResponseKernels, shearwake::simd::this_set>() {
    return layered::table;
}
