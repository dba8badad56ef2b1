#include "engines/pstd/split_axis.hpp"

#include <algorithm>

namespace shearwake::pstd {

template <class Real>
SplitAxis<Real>::SplitAxis(const Slabs& slabs, const Comm& team, std::size_t most_fields)
    : slabs_(slabs), team_(team), derivative_(slabs.nx(), slabs.grid.spacing_m[0], team),
      places_(static_cast<std::size_t>(slabs.ny())) {
    const auto fields = static_cast<std::ptrdiff_t>(most_fields);
    std::ptrdiff_t sent = 0, received = 0;
    for (int r = 0; r < slabs.ranks; ++r) {
        sent += fields * sent_to(r);
        received += fields * received_from(r);
    }
    const std::ptrdiff_t own = fields * slabs.x_count() * slabs.y_count(slabs.rank) * slabs.pitch;
    mine_.resize(static_cast<std::size_t>(own));
    travelling_.resize(static_cast<std::size_t>(sent));
    whole_lines_.resize(static_cast<std::size_t>(received));
}

template <class Real>
std::ptrdiff_t SplitAxis<Real>::sent_to(int rank) const {
    return rank == slabs_.rank ? 0 : slabs_.x_count() * slabs_.y_count(rank) * slabs_.pitch;
}

template <class Real>
std::ptrdiff_t SplitAxis<Real>::received_from(int rank) const {
    return rank == slabs_.rank ? 0
                               : slabs_.x_count(rank) * slabs_.y_count(slabs_.rank) * slabs_.pitch;
}

template <class Real>
void SplitAxis<Real>::set_places() {
    const Real* others = travelling_.data();
    for (int r = 0; r < slabs_.ranks; ++r) {
        const std::ptrdiff_t stride = slabs_.y_count(r) * slabs_.pitch;
        const Real* first = r == slabs_.rank ? mine_.data() : others;
        for (std::ptrdiff_t y = 0; y < slabs_.y_count(r); ++y)
            places_[static_cast<std::size_t>(slabs_.y_start(r) + y)] = {first + y * slabs_.pitch,
                                                                        stride};
        others += number_of_fields_ * sent_to(r);
    }
}

template <class Real>
void SplitAxis<Real>::pack(std::span<const Task> tasks) {
    Real* to = travelling_.data();
    for (int r = 0; r < slabs_.ranks; ++r) {
        if (r == slabs_.rank) continue;
        const std::ptrdiff_t run = slabs_.y_count(r) * slabs_.pitch;
        for (const Task& task : tasks)
            for (std::ptrdiff_t x = 0; x < slabs_.x_count(); ++x, to += run)
                std::copy_n(task.field + (x * slabs_.ny() + slabs_.y_start(r)) * slabs_.pitch, run,
                            to);
    }
}

template <class Real>
void SplitAxis<Real>::along_x(std::size_t number, const Task& task) {
    const std::ptrdiff_t columns = slabs_.y_count(slabs_.rank) * slabs_.pitch;
    const std::ptrdiff_t width = 2 * StaggeredDerivative<Real>::width;
    const auto f = static_cast<std::ptrdiff_t>(number);
    const Real* here = task.field + slabs_.y_start(slabs_.rank) * slabs_.pitch;
    Real* result = mine_.data() + f * slabs_.x_count() * columns;
    Real* block = reinterpret_cast<Real*>(derivative_.block());
    // The pieces of the x-lines by the rank that has them.
    struct Piece {
        const Real* from;
        std::ptrdiff_t from_stride;
        Real* to;
        std::ptrdiff_t x_count;
    };
    std::vector<Piece> pieces;
    Real* others = whole_lines_.data();
    for (int r = 0; r < slabs_.ranks; ++r) {
        const std::ptrdiff_t x_count = slabs_.x_count(r);
        if (r == slabs_.rank) {
            pieces.push_back({here, slabs_.ny() * slabs_.pitch, result, x_count});
            continue;
        }
        Real* of_field = others + f * x_count * columns;
        pieces.push_back({of_field, columns, of_field, x_count});
        others += number_of_fields_ * received_from(r);
    }
    for (std::ptrdiff_t c = 0; c < columns; c += width) {
        const std::ptrdiff_t count = std::min(width, columns - c);
        Real* at = block;
        for (const Piece& p : pieces)
            for (std::ptrdiff_t x = 0; x < p.x_count; ++x, at += width)
                StaggeredDerivative<Real>::copy_row(p.from + x * p.from_stride + c, count, at);
        // The next block's rows come while this one is transformed: no hardware follows such
        // strides.
        if (c + width < columns) {
            for (const Piece& p : pieces) {
                for (std::ptrdiff_t x = 0; x < p.x_count; ++x) {
                    const Real* next = p.from + x * p.from_stride + c + width;
                    __builtin_prefetch(next);
                    __builtin_prefetch(next + width / 2);
                }
            }
        }
        derivative_.differentiate_block(task.shift);
        at = block;
        for (const Piece& p : pieces) {
            // What stays here waits for its plane's turn; what travels goes at once.
            const bool travels = p.to == p.from;
            for (std::ptrdiff_t x = 0; x < p.x_count; ++x, at += width) {
                if (travels)
                    StaggeredDerivative<Real>::copy_row(at, count, p.to + x * columns + c);
                else
                    StaggeredDerivative<Real>::stream_row(at, count, p.to + x * columns + c);
            }
        }
    }
}

template <class Real>
std::vector<int> SplitAxis<Real>::counts(Side side) const {
    // In complex numbers of 16 bytes, as Comm sends them: rows are whole lines of the cache.
    const auto unit = static_cast<std::ptrdiff_t>(sizeof(std::complex<double>) / sizeof(Real));
    std::vector<int> counts;
    for (int r = 0; r < slabs_.ranks; ++r)
        counts.push_back(static_cast<int>(
            number_of_fields_ * (side == Side::x ? sent_to(r) : received_from(r)) / unit));
    return counts;
}

template <class Real>
void SplitAxis<Real>::differentiate(std::span<const Task> tasks) {
    number_of_fields_ = std::ssize(tasks);
    set_places();
    const bool alone = slabs_.ranks == 1;
    auto* x_side = reinterpret_cast<std::complex<double>*>(travelling_.data());
    auto* y_side = reinterpret_cast<std::complex<double>*>(whole_lines_.data());
    const auto sent = counts(Side::x), received = counts(Side::y);
    if (!alone) {
        pack(tasks);
        team_.all_to_all(x_side, sent, y_side, received);
    }
    for (std::size_t t = 0; t < tasks.size(); ++t)
        along_x(t, tasks[t]);
    if (!alone) team_.all_to_all(y_side, received, x_side, sent);
}

template class SplitAxis<double>;
template class SplitAxis<float>;

} // namespace shearwake::pstd
