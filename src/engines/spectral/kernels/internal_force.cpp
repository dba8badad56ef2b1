// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/slices.hpp"
#include "engines/spectral/kernels/vertical.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// A slice of the fields of an element at its nodes, or of their slopes.
template <int fields>
struct AtNodes {
    Value value[most_nodes][fields];
};

/// The derivative between the nodes of an element, or its transpose. The nodes are symmetric, so
/// D[n - 1 - q][n - 1 - j] = -D[q][j]: sums of mirrored values have antisymmetric derivatives and
/// differences have symmetric ones, which halves the number of products.
struct Derivative {
    double of_sum[most_nodes / 2][most_nodes / 2 + 1]; // [q][j]; the last column is the middle node
    // [q][j]; the last row is the middle node.
    double of_difference[most_nodes / 2 + 1][most_nodes / 2];
};

Derivative split(const double* d, std::ptrdiff_t nodes, std::ptrdiff_t across,
                 std::ptrdiff_t along) {
    Derivative split{};
    const std::ptrdiff_t half = nodes / 2, odd = nodes % 2;
    for (std::ptrdiff_t q = 0; q < half + odd; ++q)
        for (std::ptrdiff_t j = 0; j < half + odd; ++j) {
            const double direct = d[q * across + j * along];
            const double mirrored = d[q * across + (nodes - 1 - j) * along];
            if (q < half) split.of_sum[q][j] = j < half ? 0.5 * (direct + mirrored) : direct;
            if (j < half) split.of_difference[q][j] = 0.5 * (direct - mirrored);
        }
    return split;
}

/// Prefetches memory that is needed soon, a few cache lines at a time, during computations.
class Fetch {
public:
    Fetch(const Block* from, std::ptrdiff_t count, std::ptrdiff_t calls)
        : next_(from), end_(from + count), per_call_((count + calls - 1) / calls) {}
    [[gnu::always_inline]] void some() {
        for (std::ptrdiff_t i = 0; i < per_call_ && next_ < end_; ++i)
            __builtin_prefetch(next_++);
    }

private:
    const Block *next_, *end_;
    std::ptrdiff_t per_call_;
};

template <int fields>
[[gnu::always_inline]] inline void times_derivative(const Derivative& d, std::ptrdiff_t nodes,
                                                    const AtNodes<fields>& in, AtNodes<fields>& out,
                                                    Fetch& fetch) {
    const std::ptrdiff_t half = nodes / 2, odd = nodes % 2, last = nodes - 1;
    for (int f = 0; f < fields; ++f) {
        Value sum[most_nodes / 2 + 1], difference[most_nodes / 2];
        for (std::ptrdiff_t j = 0; j < half; ++j)
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector a = in.value[j][f].part[p], b = in.value[last - j][f].part[p];
                sum[j].part[p] = a + b;
                difference[j].part[p] = a - b;
            }
        if (odd) sum[half] = in.value[half][f];
        for (std::ptrdiff_t q = 0; q < half; ++q) {
            fetch.some();
            Value symmetric{}, antisymmetric{};
            for (std::ptrdiff_t j = 0; j < half; ++j) {
                add(simd::all_lanes(d.of_sum[q][j]), sum[j], antisymmetric);
                add(simd::all_lanes(d.of_difference[q][j]), difference[j], symmetric);
            }
            if (odd) add(simd::all_lanes(d.of_sum[q][half]), sum[half], antisymmetric);
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                out.value[q][f].part[p] = symmetric.part[p] + antisymmetric.part[p];
                out.value[last - q][f].part[p] = symmetric.part[p] - antisymmetric.part[p];
            }
        }
        if (!odd) continue;
        Value middle{};
        for (std::ptrdiff_t j = 0; j < half; ++j)
            add(simd::all_lanes(d.of_difference[half][j]), difference[j], middle);
        out.value[half][f] = middle;
    }
}

/// Index of the first unknown of a node in a pencil; a node of the rigid base has none.
struct NodeAt {
    std::ptrdiff_t u, w, v;
    bool rests;
};
[[gnu::always_inline]] inline NodeAt node_at(const VerticalArrays& a, std::ptrdiff_t level) {
    const std::ptrdiff_t u = 2 * level * parts;
    return {u, u + parts, (2 * a.levels + level) * parts, level >= a.levels};
}

struct Derivatives {
    Derivative forward, transposed;
};

/// Working arrays of one element.
struct Element {
    AtNodes<4> x, slope;     // U, W, V including the viscous part; then W alone
    AtNodes<3> pull, pushed; // forces on U, W, V
};

[[gnu::always_inline]] inline void gather(const VerticalArrays& a, std::ptrdiff_t nodes,
                                          std::ptrdiff_t first, double theta, const Block* u,
                                          const Block* before, std::ptrdiff_t s, Element& work) {
    for (std::ptrdiff_t i = 0; i < nodes; ++i) {
        const NodeAt at = node_at(a, first + i);
        Value* x = work.x.value[i];
        if (at.rests) {
            for (int f = 0; f < 4; ++f)
                x[f] = Value{};
            continue;
        }
        const std::ptrdiff_t of[3] = {at.u, at.w, at.v};
        for (int f = 0; f < 3; ++f)
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector now = get(u[of[f] + p], s);
                x[f].part[p] = now + theta * (now - get(before[of[f] + p], s));
            }
        x[3] = get_parts(u + at.w, s);
    }
}

[[gnu::always_inline]] inline void pull_and_push(const VerticalArrays& a, std::ptrdiff_t nodes,
                                                 std::ptrdiff_t e, std::ptrdiff_t first, Vector k,
                                                 const Block* u, std::ptrdiff_t s, Element& work,
                                                 Block* force) {
    const VerticalElement& el = a.element[e];
    for (std::ptrdiff_t q = 0; q < nodes; ++q) {
        const double w = a.weights[q] * el.half;
        const double wl = w * a.force_lambda_Pa[e * a.nodes + q];
        const double wm = w * a.mu_accurate_Pa[e * a.nodes + q];
        const Value *x = work.x.value[q], *slope = work.slope.value[q];
        Value* pull = work.pull.value[q];
        const NodeAt at = node_at(a, first + q);
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Vector plain_u = at.rests ? Vector{} : get(u[at.u + p], s);
            const Vector dilation = wl * (el.slope * slope[3].part[p] - k * plain_u);
            const Vector shear = wm * (el.slope * slope[0].part[p] + k * x[1].part[p]);
            pull[0].part[p] = shear * el.slope;
            pull[1].part[p] = (dilation + 2.0 * wm * el.slope * slope[1].part[p]) * el.slope;
            pull[2].part[p] = (wm * el.slope * el.slope) * slope[2].part[p];
            if (at.rests) continue;
            Block &on_u = force[at.u + p], &on_w = force[at.w + p], &on_v = force[at.v + p];
            set(on_u, s, get(on_u, s) - k * (2.0 * wm * k * x[0].part[p] - dilation));
            set(on_w, s, get(on_w, s) - k * shear);
            set(on_v, s, get(on_v, s) - wm * k * k * x[2].part[p]);
        }
    }
}

[[gnu::always_inline]] inline void subtract_pushed(const VerticalArrays& a, std::ptrdiff_t nodes,
                                                   std::ptrdiff_t first, const AtNodes<3>& pushed,
                                                   std::ptrdiff_t s, Block* force) {
    for (std::ptrdiff_t i = 0; i < nodes && first + i < a.levels; ++i) {
        const NodeAt at = node_at(a, first + i);
        const std::ptrdiff_t of[3] = {at.u, at.w, at.v};
        for (int f = 0; f < 3; ++f)
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                Block& on = force[of[f] + p];
                set(on, s, get(on, s) - pushed.value[i][f].part[p]);
            }
    }
}

/// Adds the force of the swirl viscosity in an absorbing element.
[[gnu::noinline]] void add_swirl_force(const VerticalArrays& a, const Derivatives& d, Fetch& fetch,
                                       std::ptrdiff_t e, std::ptrdiff_t first, Vector k,
                                       double rate, const Block* u, const Block* before,
                                       std::ptrdiff_t s, Block* force) {
    const VerticalElement& el = a.element[e];
    AtNodes<3> speed, slope, pull, pushed; // U, W, V
    for (std::ptrdiff_t i = 0; i < a.nodes; ++i) {
        const NodeAt at = node_at(a, first + i);
        const std::ptrdiff_t of[3] = {at.u, at.w, at.v};
        for (int f = 0; f < 3; ++f)
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                speed.value[i][f].part[p] =
                    at.rests ? Vector{} : rate * (get(u[of[f] + p], s) - get(before[of[f] + p], s));
    }
    times_derivative(d.forward, a.nodes, speed, slope, fetch);
    for (std::ptrdiff_t q = 0; q < a.nodes; ++q) {
        const double w = a.weights[q] * el.half * a.swirl_viscosity_Pa_s[e * a.nodes + q];
        const NodeAt at = node_at(a, first + q);
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Vector swirl =
                w * (el.slope * slope.value[q][0].part[p] - k * speed.value[q][1].part[p]);
            pull.value[q][0].part[p] = el.slope * swirl;
            pull.value[q][1].part[p] = Vector{};
            pull.value[q][2].part[p] = w * el.slope * el.slope * slope.value[q][2].part[p];
            if (at.rests) continue;
            Block &on_w = force[at.w + p], &on_v = force[at.v + p];
            set(on_w, s, get(on_w, s) + k * swirl);
            set(on_v, s, get(on_v, s) - w * k * k * speed.value[q][2].part[p]);
        }
    }
    times_derivative(d.transposed, a.nodes, pull, pushed, fetch);
    subtract_pushed(a, a.nodes, first, pushed, s, force);
}

/// Adds the force of the termination of an absorber.
void add_termination_force(const VerticalArrays& a, Vector k, double rate, const Block* u,
                           const Block* before, std::ptrdiff_t s, Block* force) {
    const Termination& end = *a.termination;
    const double impedance = rate * std::sqrt(end.density_kg_m3 * end.modulus_Pa); // rho c_p
    const Vector stiffness = end.modulus_Pa * k, scale = root(k);
    const std::ptrdiff_t w = (2 * a.levels - 3) * parts, y = w + parts;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        const auto moved = [&](std::ptrdiff_t at) { return get(u[at], s) - get(before[at], s); };
        Vector strain_rate = moved(w + p);
        for (std::ptrdiff_t i = 0; i < oscillators; ++i)
            strain_rate += scale * oscillator[i].share * moved(y + i * parts + p);
        const Vector pull = impedance * strain_rate;
        Vector on_w = pull;
        for (std::ptrdiff_t i = 0; i < oscillators; ++i) {
            const Oscillator& o = oscillator[i];
            const std::ptrdiff_t at = y + i * parts + p;
            const Vector spring =
                stiffness * o.spring * (o.lever * get(u[w + p], s) - scale * get(u[at], s));
            on_w += o.lever * spring;
            set(force[at], s, get(force[at], s) - scale * (o.share * pull - spring));
        }
        set(force[w + p], s, get(force[w + p], s) - on_w);
    }
}

/// A number of nodes that is known at compile time lets the compiler unroll the sums; 0 stands for
/// any number.
template <std::ptrdiff_t known_nodes>
void add_forces(const VerticalArrays& a, const Block& k8, double rate, const Block* u,
                const Block* before, Block* force, NeededSoon soon) {
    const std::ptrdiff_t nodes = known_nodes > 0 ? known_nodes : a.nodes;
    const Derivatives d = {split(a.derivative, nodes, nodes, 1),
                           split(a.derivative, nodes, 1, nodes)};
    Fetch fetch(soon.from, soon.count, a.elements * slices * 7 * (nodes / 2));
    Element work;
    for (std::ptrdiff_t e = 0; e < a.elements; ++e) {
        const std::ptrdiff_t first = e * (nodes - 1);
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector k = get(k8, s);
            gather(a, nodes, first, a.element[e].theta_s * rate, u, before, s, work);
            times_derivative(d.forward, nodes, work.x, work.slope, fetch);
            pull_and_push(a, nodes, e, first, k, u, s, work, force);
            times_derivative(d.transposed, nodes, work.pull, work.pushed, fetch);
            subtract_pushed(a, nodes, first, work.pushed, s, force);
            if (a.element[e].absorbs)
                add_swirl_force(a, d, fetch, e, first, k, rate, u, before, s, force);
        }
    }
    for (std::ptrdiff_t s = 0; a.termination && s < slices; ++s)
        add_termination_force(a, get(k8, s), rate, u, before, s, force);
}

void add_internal_force(const VerticalArrays& a, const Block& k, double rate, const Block* u,
                        const Block* before, Block* force, NeededSoon soon) {
    constexpr std::ptrdiff_t usual = 9; // of the default solver.spectral.degree = 8
    if (a.nodes == usual)
        add_forces<usual>(a, k, rate, u, before, force, soon);
    else
        add_forces<0>(a, k, rate, u, before, force, soon);
}

Block twice_kinetic(const VerticalArrays& a, double rate, const Block* u, const Block* before,
                    const Block* counted) {
    Block energy;
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        Vector all{};
        const Value weight = get_parts(counted, s);
        for (std::ptrdiff_t level = 0; level < a.levels; ++level) {
            const NodeAt at = node_at(a, level);
            Vector squares{};
            const std::ptrdiff_t unknowns[3] = {at.u, at.w, at.v};
            for (const std::ptrdiff_t of : unknowns)
                for (std::ptrdiff_t p = 0; p < parts; ++p) {
                    const Vector v = rate * (get(u[of + p], s) - get(before[of + p], s));
                    squares += weight.part[p] * v * v;
                }
            all += a.mass_kg_m2[level] * squares;
        }
        set(energy, s, all);
    }
    return energy;
}

constexpr VerticalKernels table = {add_internal_force, twice_kinetic};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::VerticalKernels&
shearwake::simd::compiled<shearwake::spectral::VerticalKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
