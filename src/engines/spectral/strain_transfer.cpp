#include "engines/spectral/strain_transfer.hpp"

#include <algorithm>

namespace shearwake {
namespace {

using Complex = std::complex<double>;

/// i times the two halves (re, im at +kx; re, im at -kx) of a value.
void times_i(const Lanes* a, Lanes* out) {
    out[plus_re] = -a[plus_im];
    out[plus_im] = a[plus_re];
    out[minus_re] = -a[minus_im];
    out[minus_im] = a[minus_re];
}

/// Whether all eight -kx of a block lie in the row, apart from kx = 0.
bool is_full(const WaveVectors& vectors, std::ptrdiff_t block) {
    return block > 0 && vectors.is_there(block * lane_count + lane_count - 1);
}

} // namespace

StrainTransfer::StrainTransfer(const DepthMesh& mesh, std::vector<StrainPoint> points,
                               int components, const WaveVectors& vectors)
    : mesh_(mesh), points_(std::move(points)), components_(components), vectors_(vectors),
      nodes_(mesh.degree + 1), levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)) {}

void StrainTransfer::put(const WaveVectors& vectors, std::ptrdiff_t block, double* line,
                         const Lanes* v) {
    const std::ptrdiff_t nx = vectors.nx(), first = block * lane_count;
    Complex* out = reinterpret_cast<Complex*>(line);
    if (is_full(vectors, block)) {
        store_ascending(out + first, v[plus_re], v[plus_im]);
        store_descending(out + nx - first - lane_count + 1, v[minus_re], v[minus_im]);
        return;
    }
    for (std::ptrdiff_t lane = 0; lane < lane_count && vectors.is_there(first + lane); ++lane) {
        out[first + lane] = {v[plus_re][lane], v[plus_im][lane]};
        if (first + lane > 0) out[nx - first - lane] = {v[minus_re][lane], v[minus_im][lane]};
    }
}

void StrainTransfer::take(const WaveVectors& vectors, std::ptrdiff_t block, const double* line,
                          Lanes* v) {
    const std::ptrdiff_t nx = vectors.nx(), first = block * lane_count;
    const Complex* in = reinterpret_cast<const Complex*>(line);
    if (is_full(vectors, block)) {
        load_ascending(in + first, v[plus_re], v[plus_im]);
        load_descending(in + nx - first - lane_count + 1, v[minus_re], v[minus_im]);
        return;
    }
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v[p] = Lanes{};
    for (std::ptrdiff_t lane = 0; lane < lane_count && vectors.is_there(first + lane); ++lane) {
        const Complex plus = in[first + lane], minus = in[(nx - first - lane) % nx];
        v[plus_re][lane] = plus.real();
        v[plus_im][lane] = plus.imag();
        v[minus_re][lane] = minus.real();
        v[minus_im][lane] = minus.imag();
    }
}

StrainTransfer::Direction StrainTransfer::direction(std::ptrdiff_t row,
                                                    std::ptrdiff_t block) const {
    Direction at;
    at.ky = vectors_.ky_rad_m(row);
    at.k = vectors_.k(row, block);
    at.kx[0] = vectors_.kx(block);
    at.kx[1] = -at.kx[0];
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const double k = at.k[lane];
        at.c[0][lane] = k > 0.0 ? at.kx[0][lane] / k : 1.0;
        at.c[1][lane] = k > 0.0 ? at.kx[1][lane] / k : 1.0;
        at.s[lane] = k > 0.0 ? at.ky / k : 0.0;
    }
    return at;
}

void StrainTransfer::strain(std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* pencil,
                            double* line, std::ptrdiff_t stride) const {
    const Direction at = direction(row, block);
    for (const StrainPoint& point : points_) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(point.element) * (nodes_ - 1);
        const double slope = 2.0 / mesh_.length_m(point.element);
        Lanes u[3 * parts] = {}, du[3 * parts] = {}; // U, W, V and their slopes
        for (std::ptrdiff_t j = 0; j < nodes_ && first + j < levels_; ++j) {
            const double d =
                slope * mesh_.rule.derivative[static_cast<std::size_t>(point.node * nodes_ + j)];
            const Lanes* uw = pencil + 2 * (first + j) * parts;
            const Lanes* v = pencil + (2 * levels_ + first + j) * parts;
            for (std::ptrdiff_t p = 0; p < 2 * parts; ++p)
                du[p] += d * uw[p];
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                du[2 * parts + p] += d * v[p];
            if (j != point.node) continue;
            std::copy_n(uw, 2 * parts, u);
            std::copy_n(v, parts, u + 2 * parts);
        }
        Lanes value[all_components][parts], turned[parts];
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Lanes c = at.c[p / 2], kx = at.kx[p / 2], s = at.s;
            const Lanes x = c * u[p] - s * u[2 * parts + p]; // u_x = i x
            const Lanes y = s * u[p] + c * u[2 * parts + p]; // u_y = i y
            const Lanes dx = c * du[p] - s * du[2 * parts + p];
            const Lanes dy = s * du[p] + c * du[2 * parts + p];
            value[xx][p] = -kx * x;
            value[yy][p] = -at.ky * y;
            value[zz][p] = du[parts + p];
            value[yz][p] = dy + at.ky * u[parts + p]; // times i below
            value[xz][p] = dx + kx * u[parts + p];
            value[xy][p] = -kx * y - at.ky * x;
            value[ux][p] = x;
            value[uy][p] = y;
            value[uz][p] = u[parts + p];
        }
        for (int component = 0; component < components_; ++component, line += stride) {
            const bool imaginary =
                component == yz || component == xz || component == ux || component == uy;
            if (imaginary) times_i(value[component], turned);
            put(vectors_, block, line, imaginary ? turned : value[component]);
        }
    }
}

void StrainTransfer::add_force(std::ptrdiff_t row, std::ptrdiff_t block, const double* line,
                               std::ptrdiff_t stride, double scale, Lanes* pencil) const {
    const Direction at = direction(row, block);
    for (const StrainPoint& point : points_) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(point.element) * (nodes_ - 1);
        const double slope = 2.0 / mesh_.length_m(point.element);
        Lanes value[all_components][parts] = {}, turned[parts];
        for (int component = 0; component < components_; ++component, line += stride) {
            take(vectors_, block, line, value[component]);
            const bool imaginary =
                component == yz || component == xz || component == ux || component == uy;
            if (!imaginary) continue;
            times_i(value[component], turned); // times -i: the adjoint
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                value[component][p] = -turned[p];
        }
        Lanes force[3 * parts], pull[3 * parts];
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Lanes c = at.c[p / 2], kx = at.kx[p / 2], s = at.s;
            const Lanes x = -kx * value[xx][p] - at.ky * value[xy][p] + value[ux][p];
            const Lanes y = -at.ky * value[yy][p] - kx * value[xy][p] + value[uy][p];
            force[p] = -scale * (c * x + s * y);
            force[parts + p] = -scale * (kx * value[xz][p] + at.ky * value[yz][p] + value[uz][p]);
            force[2 * parts + p] = -scale * (c * y - s * x);
            pull[p] = -scale * slope * (c * value[xz][p] + s * value[yz][p]);
            pull[parts + p] = -scale * slope * value[zz][p];
            pull[2 * parts + p] = -scale * slope * (c * value[yz][p] - s * value[xz][p]);
        }
        for (std::ptrdiff_t j = 0; j < nodes_ && first + j < levels_; ++j) {
            const double d =
                mesh_.rule.derivative[static_cast<std::size_t>(point.node * nodes_ + j)];
            Lanes* uw = pencil + 2 * (first + j) * parts;
            Lanes* v = pencil + (2 * levels_ + first + j) * parts;
            for (std::ptrdiff_t p = 0; p < 2 * parts; ++p)
                uw[p] += d * pull[p];
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                v[p] += d * pull[2 * parts + p];
            if (j != point.node) continue;
            for (std::ptrdiff_t p = 0; p < 2 * parts; ++p)
                uw[p] += force[p];
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                v[p] += force[2 * parts + p];
        }
    }
}

} // namespace shearwake
