// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/transfer.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

[[gnu::always_inline]] inline bool is_imaginary(int component) {
    return component == yz || component == xz || component == ux || component == uy;
}

/// U, W, V at a node and their slopes over depth.
struct Motion {
    Value u{}, w{}, v{}, du{}, dw{}, dv{};
};

[[gnu::always_inline]] inline Motion motion_at(const TransferArrays& a, const TransferPoint& point,
                                               const Block* pencil, std::ptrdiff_t s) {
    Motion m;
    const double* derivative = a.derivative + point.node * a.nodes;
    for (std::ptrdiff_t j = 0; j < a.nodes && point.first + j < a.levels; ++j) {
        const Vector d = simd::all_lanes(point.slope * derivative[j]);
        const Block* uw = pencil + 2 * (point.first + j) * parts;
        const Block* v = pencil + (2 * a.levels + point.first + j) * parts;
        add(d, get_parts(uw, s), m.du);
        add(d, get_parts(uw + parts, s), m.dw);
        add(d, get_parts(v, s), m.dv);
    }
    if (point.first + point.node >= a.levels) return m; // the base does not move
    const Block* uw = pencil + 2 * (point.first + point.node) * parts;
    m.u = get_parts(uw, s);
    m.w = get_parts(uw + parts, s);
    m.v = get_parts(pencil + (2 * a.levels + point.first + point.node) * parts, s);
    return m;
}

void strain(const TransferArrays& a, const WaveBlock& waves, const Block* pencil, double* line,
            std::ptrdiff_t stride) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        double* plane = line;
        for (std::ptrdiff_t i = 0; i < a.points; ++i) {
            const Motion m = motion_at(a, a.point[i], pencil, s);
            Value value[all_components];
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector c = to.c[p / 2], kx = to.kx[p / 2];
                const Vector x = c * m.u.part[p] - to.s * m.v.part[p]; // u_x = i x
                const Vector y = to.s * m.u.part[p] + c * m.v.part[p]; // u_y = i y
                value[xx].part[p] = -kx * x;
                value[yy].part[p] = -to.ky * y;
                value[zz].part[p] = m.dw.part[p];
                // The following components are multiplied by i.
                value[yz].part[p] = to.s * m.du.part[p] + c * m.dv.part[p] + to.ky * m.w.part[p];
                value[xz].part[p] = c * m.du.part[p] - to.s * m.dv.part[p] + kx * m.w.part[p];
                value[xy].part[p] = -kx * y - to.ky * x;
                value[ux].part[p] = x;
                value[uy].part[p] = y;
                value[uz].part[p] = m.w.part[p];
            }
            for (int c = 0; c < a.components; ++c, plane += stride)
                put_slice(waves, s, is_imaginary(c) ? times_i(value[c]) : value[c], plane);
        }
    }
}

/// The forces on U, W, V at a node and on their slopes.
[[gnu::always_inline]] inline Motion forces_of(const Direction& to, const Value* value,
                                               double scale, double slope) {
    Motion f;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        const Vector c = to.c[p / 2], kx = to.kx[p / 2];
        const Vector x = -kx * value[xx].part[p] - to.ky * value[xy].part[p] + value[ux].part[p];
        const Vector y = -to.ky * value[yy].part[p] - kx * value[xy].part[p] + value[uy].part[p];
        f.u.part[p] = -scale * (c * x + to.s * y);
        f.w.part[p] =
            -scale * (kx * value[xz].part[p] + to.ky * value[yz].part[p] + value[uz].part[p]);
        f.v.part[p] = -scale * (c * y - to.s * x);
        f.du.part[p] = -scale * slope * (c * value[xz].part[p] + to.s * value[yz].part[p]);
        f.dw.part[p] = -scale * slope * value[zz].part[p];
        f.dv.part[p] = -scale * slope * (c * value[yz].part[p] - to.s * value[xz].part[p]);
    }
    return f;
}

[[gnu::always_inline]] inline void add_to(Block* blocks, std::ptrdiff_t s, const Value& more) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        set(blocks[p], s, get(blocks[p], s) + more.part[p]);
}
[[gnu::always_inline]] inline void add_times(Block* blocks, std::ptrdiff_t s, Vector factor,
                                             const Value& more) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        set(blocks[p], s, get(blocks[p], s) + factor * more.part[p]);
}

void add_force(const TransferArrays& a, const WaveBlock& waves, const double* line,
               std::ptrdiff_t stride, double scale, Block* pencil) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        const double* plane = line;
        for (std::ptrdiff_t i = 0; i < a.points; ++i) {
            const TransferPoint& point = a.point[i];
            Value value[all_components] = {};
            for (int c = 0; c < a.components; ++c, plane += stride) {
                const Value taken = take_slice(waves, s, plane);
                // Adjoint of the transfer of strain.
                value[c] = is_imaginary(c) ? times_minus_i(taken) : taken;
            }
            const Motion f = forces_of(to, value, scale, point.slope);
            const double* derivative = a.derivative + point.node * a.nodes;
            for (std::ptrdiff_t j = 0; j < a.nodes && point.first + j < a.levels; ++j) {
                const Vector d = simd::all_lanes(derivative[j]);
                Block* uw = pencil + 2 * (point.first + j) * parts;
                add_times(uw, s, d, f.du);
                add_times(uw + parts, s, d, f.dw);
                add_times(pencil + (2 * a.levels + point.first + j) * parts, s, d, f.dv);
            }
            if (point.first + point.node >= a.levels) continue; // the base does not move
            Block* uw = pencil + 2 * (point.first + point.node) * parts;
            add_to(uw, s, f.u);
            add_to(uw + parts, s, f.w);
            add_to(pencil + (2 * a.levels + point.first + point.node) * parts, s, f.v);
        }
    }
}

constexpr TransferKernels table = {strain, add_force};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::TransferKernels&
shearwake::simd::compiled<shearwake::spectral::TransferKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
