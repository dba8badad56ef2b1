// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/pencils.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
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

constexpr std::ptrdiff_t components = 3;

/// u_x = i (c U - s V), u_y = i (s U + c V) and W.
void put(const WaveBlock& waves, std::ptrdiff_t levels, const Block* now, const Block* before,
         double* line, std::ptrdiff_t stride) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t level = 0; level < levels; ++level) {
            const std::ptrdiff_t uw = 2 * level * parts, v = (2 * levels + level) * parts;
            Value x, y, w;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector radial = get(now[uw + p], s) - get(before[uw + p], s);
                const Vector across = get(now[v + p], s) - get(before[v + p], s);
                w.part[p] = get(now[uw + parts + p], s) - get(before[uw + parts + p], s);
                x.part[p] = to.c[p / 2] * radial - to.s * across;
                y.part[p] = to.s * radial + to.c[p / 2] * across;
            }
            double* of_level = line + components * level * stride;
            put_slice(waves, s, times_i(x), of_level);
            put_slice(waves, s, times_i(y), of_level + stride);
            put_slice(waves, s, w, of_level + 2 * stride);
        }
    }
}

void gather(const WaveBlock& waves, std::ptrdiff_t levels, const double* scale, const double* line,
            std::ptrdiff_t stride, Block* pencil) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t level = 0; level < levels; ++level) {
            const double* of_level = line + components * level * stride;
            const Value x = times_minus_i(load_slice(waves, s, of_level)); // the inverse
            const Value y = times_minus_i(load_slice(waves, s, of_level + stride));
            const Value w = load_slice(waves, s, of_level + 2 * stride);
            const std::ptrdiff_t uw = 2 * level * parts, v = (2 * levels + level) * parts;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector c = to.c[p / 2];
                set(pencil[uw + p], s, scale[level] * (c * x.part[p] + to.s * y.part[p]));
                set(pencil[uw + parts + p], s, scale[level] * w.part[p]);
                set(pencil[v + p], s, scale[level] * (c * y.part[p] - to.s * x.part[p]));
            }
        }
    }
}

constexpr PencilKernels pencil_table = {advance,    advance_by_sum, add_scaled,
                                        difference, product,        put_load};
constexpr SpongeKernels sponge_table = {put, gather};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::PencilKernels&
shearwake::simd::compiled<shearwake::spectral::PencilKernels, shearwake::simd::this_set>() {
    return spectral::pencil_table;
}

template <>
const shearwake::spectral::SpongeKernels&
shearwake::simd::compiled<shearwake::spectral::SpongeKernels, shearwake::simd::this_set>() {
    return spectral::sponge_table;
}
