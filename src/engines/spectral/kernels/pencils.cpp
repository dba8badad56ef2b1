// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/pencils.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

void advance(std::ptrdiff_t count, double scale, const Block* u, const Block* change,
             Block* before) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            set(before[i], s, 2.0 * get(u[i], s) - get(before[i], s) + scale * get(change[i], s));
}

void advance_by_sum(std::ptrdiff_t count, double scale, const Block* u, const Block* change,
                    const Block* more, Block* before) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            set(before[i], s,
                2.0 * get(u[i], s) - get(before[i], s) +
                    scale * (get(change[i], s) + get(more[i], s)));
}

void add_scaled(std::ptrdiff_t count, double scale, const Block* x, Block* to) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            set(to[i], s, get(to[i], s) + scale * get(x[i], s));
}

void difference(std::ptrdiff_t count, double scale, const Block* a, const Block* b, Block* to) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            set(to[i], s, scale * (get(a[i], s) - get(b[i], s)));
}

Block product(std::ptrdiff_t count, const Block* a, const Block* b, const Block* counted) {
    Block all;
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        Vector sum{};
        for (std::ptrdiff_t i = 0; i < count; ++i)
            sum += get(counted[i % parts], s) * get(a[i], s) * get(b[i], s);
        set(all, s, sum);
    }
    return all;
}

/// v times the complex numbers of a shape, stored as re, im at +kx and re, im at -kx.
[[gnu::always_inline]] inline Value shaped(const Block* shape, std::ptrdiff_t s, const Value& v) {
    const Value g = get_parts(shape, s);
    Value product;
    for (std::ptrdiff_t p = 0; p < parts; p += 2) {
        product.part[p] = g.part[p] * v.part[p] - g.part[p + 1] * v.part[p + 1];
        product.part[p + 1] = g.part[p] * v.part[p + 1] + g.part[p + 1] * v.part[p];
    }
    return product;
}

void put_load(std::ptrdiff_t count, const LoadSample* samples, const Block* shape, Block* surface) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        Value sum{};
        for (std::ptrdiff_t n = 0; n < count; ++n) {
            const LoadSample& sample = samples[n];
            Vector re, im;
            simd::load_ascending(sample.x + 2 * s * width, re, im);
            Value v = {{re * sample.y_re - im * sample.y_im, re * sample.y_im + im * sample.y_re,
                        re * sample.y_re + im * sample.y_im, re * sample.y_im - im * sample.y_re}};
            if (sample.shape) v = shaped(sample.shape, s, v);
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                sum.part[p] += v.part[p];
        }
        set_parts(surface, s, shape ? shaped(shape, s, sum) : sum);
    }
}

constexpr PencilKernels table = {advance,    advance_by_sum, add_scaled,
                                 difference, product,        put_load};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::PencilKernels&
shearwake::simd::compiled<shearwake::spectral::PencilKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
