// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/transfer.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "engines/spectral/kernels/vertical.hpp"
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

template <int components>
void strain_of(const TransferArrays& a, const WaveBlock& waves, const Block* pencil, double* line,
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
#pragma GCC unroll 9
            for (int c = 0; c < components; ++c, plane += stride)
                put_slice(waves, s, is_imaginary(c) ? times_i(value[c]) : value[c], plane);
        }
    }
}

void strain(const TransferArrays& a, const WaveBlock& waves, const Block* pencil, double* line,
            std::ptrdiff_t stride) {
    (a.components == all_components ? strain_of<all_components>
                                    : strain_of<strain_components>)(a, waves, pencil, line, stride);
}

/// The stress in the planes of a point, with the factors of the adjoint of the transfer of strain.
template <int components>
[[gnu::always_inline]] inline void load_stress(const WaveBlock& waves, std::ptrdiff_t s,
                                               const double* plane, std::ptrdiff_t stride,
                                               Value (&value)[all_components]) {
#pragma GCC unroll 9
    for (int c = 0; c < components; ++c, plane += stride) {
        const Value taken = load_slice(waves, s, plane);
        value[c] = is_imaginary(c) ? times_minus_i(taken) : taken;
    }
}

/// The forces on U, W, V at a node and on their slopes.
template <int components>
[[gnu::always_inline]] inline Motion
forces_of(const Direction& to, const Value (&value)[all_components], double scale, double slope) {
    Motion f;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        const Vector c = to.c[p / 2], kx = to.kx[p / 2];
        Vector x = -kx * value[xx].part[p] - to.ky * value[xy].part[p];
        Vector y = -to.ky * value[yy].part[p] - kx * value[xy].part[p];
        Vector z = kx * value[xz].part[p] + to.ky * value[yz].part[p];
        if constexpr (components == all_components) {
            x += value[ux].part[p];
            y += value[uy].part[p];
            z += value[uz].part[p];
        }
        f.u.part[p] = -scale * (c * x + to.s * y);
        f.w.part[p] = -scale * z;
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

/// Adds the forces at the points of one element to its nodes: those on the motion at the points
/// themselves, and those on the slopes, to which all nodes contribute.
[[gnu::always_inline]] inline void add_element(const TransferArrays& a, const TransferPoint* point,
                                               std::ptrdiff_t count, const Motion* f,
                                               std::ptrdiff_t s, Block* pencil) {
    const std::ptrdiff_t first = point->first;
    for (std::ptrdiff_t j = 0; j < a.nodes && first + j < a.levels; ++j) {
        Value u{}, w{}, v{};
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            const Vector d = simd::all_lanes(a.derivative[point[i].node * a.nodes + j]);
            add(d, f[i].du, u);
            add(d, f[i].dw, w);
            add(d, f[i].dv, v);
        }
        Block* uw = pencil + 2 * (first + j) * parts;
        add_to(uw, s, u);
        add_to(uw + parts, s, w);
        add_to(pencil + (2 * a.levels + first + j) * parts, s, v);
    }
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        const std::ptrdiff_t level = first + point[i].node;
        if (level >= a.levels) continue; // the base does not move
        add_to(pencil + 2 * level * parts, s, f[i].u);
        add_to(pencil + (2 * level + 1) * parts, s, f[i].w);
        add_to(pencil + (2 * a.levels + level) * parts, s, f[i].v);
    }
}

template <int components>
void add_force_of(const TransferArrays& a, const WaveBlock& waves, const double* line,
                  std::ptrdiff_t stride, double scale, Block* pencil) {
    Motion f[most_nodes];
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        const double* plane = line;
        for (std::ptrdiff_t begin = 0, end; begin < a.points; begin = end) {
            const TransferPoint* point = a.point + begin;
            for (end = begin; end < a.points && a.point[end].first == point->first; ++end) {
                Value value[all_components];
                load_stress<components>(waves, s, plane, stride, value);
                f[end - begin] = forces_of<components>(to, value, scale, point->slope);
                plane += components * stride;
            }
            add_element(a, point, end - begin, f, s, pencil);
        }
    }
}

void add_force(const TransferArrays& a, const WaveBlock& waves, const double* line,
               std::ptrdiff_t stride, double scale, Block* pencil) {
    (a.components == all_components
         ? add_force_of<all_components>
         : add_force_of<strain_components>)(a, waves, line, stride, scale, pencil);
}

constexpr TransferKernels table = {strain, add_force};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::TransferKernels&
shearwake::simd::compiled<shearwake::spectral::TransferKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
