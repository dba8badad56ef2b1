// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/split_axis.hpp"
#include "fft/aligned.hpp"

#include <algorithm>
#include <numeric>

namespace shearwake::pstd {
namespace {

std::ptrdiff_t sum(const std::vector<std::ptrdiff_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::ptrdiff_t{0});
}

} // namespace

std::ptrdiff_t parts_of_exchange(double bytes, int ranks) {
    // 128 cubed in double precision on two ranks: parts of 1 MiB instead of whole fields save 7 %
    // of the work of a step, parts of 256 KiB 1 %.
    const double in_cache_B = 1048576.0, message_B = 65536.0;
    if (ranks == 1) return 1;
    return std::max<std::ptrdiff_t>(
        1, static_cast<std::ptrdiff_t>(bytes / std::max(in_cache_B, message_B * ranks)));
}

template <class Real>
SplitAxis<Real>::SplitAxis(const Slabs& slabs, const Comm& team, std::size_t most_fields)
    : slabs_(slabs), team_(team), derivative_(slabs.nx(), slabs.grid.spacing_m[0], team),
      places_(static_cast<std::size_t>(slabs.ny())) {
    const auto fields = static_cast<std::ptrdiff_t>(most_fields);
    // The same on all ranks: of a rank's average share.
    const double bytes =
        static_cast<double>(slabs.nx() * slabs.ny() * slabs.pitch) * sizeof(Real) / slabs.ranks;
    const std::ptrdiff_t parts = std::min(parts_of_exchange(bytes, slabs.ranks),
                                          std::max<std::ptrdiff_t>(1, slabs.ny() / slabs.ranks));
    std::ptrdiff_t offset = 0, most_sent = 0, most_received = 0;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        parts_.push_back(part(p, parts));
        parts_.back().offset = offset;
        const std::ptrdiff_t sent = sum(parts_.back().sent);
        offset += sent;
        most_sent = std::max(most_sent, sent);
        most_received = std::max(most_received, sum(parts_.back().received));
    }
    const std::ptrdiff_t own = slabs.x_count() * slabs.y_count(slabs.rank) * slabs.pitch;
    mine_.resize(static_cast<std::size_t>(fields * own));
    others_.resize(static_cast<std::size_t>(fields * offset));
    leaving_.resize(static_cast<std::size_t>(most_sent));
    lines_.resize(static_cast<std::size_t>(most_received));
    set_places();
}

template <class Real>
auto SplitAxis<Real>::part(std::ptrdiff_t number, std::ptrdiff_t parts) const -> Part {
    Part part{};
    for (int r = 0; r < slabs_.ranks; ++r)
        part.rows.push_back(
            {slabs_.y_count(r) * number / parts, slabs_.y_count(r) * (number + 1) / parts});
    const std::ptrdiff_t here = part.rows[static_cast<std::size_t>(slabs_.rank)].count();
    for (int r = 0; r < slabs_.ranks; ++r) {
        const bool other = r != slabs_.rank;
        const std::ptrdiff_t there = part.rows[static_cast<std::size_t>(r)].count();
        part.sent.push_back(other ? slabs_.x_count() * there * slabs_.pitch : 0);
        part.received.push_back(other ? slabs_.x_count(r) * here * slabs_.pitch : 0);
    }
    return part;
}

template <class Real>
void SplitAxis<Real>::set_places() {
    if (slabs_.x_count() == 0) return; // this rank has no planes
    const std::ptrdiff_t own_columns = slabs_.y_count(slabs_.rank) * slabs_.pitch;
    const std::ptrdiff_t of_others = parts_.back().offset + sum(parts_.back().sent);
    for (const Part& part : parts_) {
        const Real* first = others_.data() + part.offset;
        for (int r = 0; r < slabs_.ranks; ++r) {
            const Rows& rows = part.rows[static_cast<std::size_t>(r)];
            for (std::ptrdiff_t y = rows.begin; y < rows.end; ++y)
                places_[static_cast<std::size_t>(slabs_.y_start(r) + y)] =
                    r == slabs_.rank ? Place{mine_.data() + y * slabs_.pitch, own_columns,
                                             slabs_.x_count() * own_columns}
                                     : Place{first + (y - rows.begin) * slabs_.pitch,
                                             rows.count() * slabs_.pitch, of_others};
            first += part.sent[static_cast<std::size_t>(r)];
        }
    }
}

template <class Real>
void SplitAxis<Real>::pack(const Task& task, const Part& part) {
    Real* to = leaving_.data();
    for (int r = 0; r < slabs_.ranks; ++r) {
        if (r == slabs_.rank) continue;
        const Rows& rows = part.rows[static_cast<std::size_t>(r)];
        const std::ptrdiff_t run = rows.count() * slabs_.pitch;
        const std::ptrdiff_t first = slabs_.y_start(r) + rows.begin;
        for (std::ptrdiff_t x = 0; x < slabs_.x_count(); ++x, to += run)
            std::copy_n(task.field + (x * slabs_.ny() + first) * slabs_.pitch, run, to);
    }
}

template <class Real>
void SplitAxis<Real>::along_x(std::size_t number, const Task& task, const Part& part) {
    const Rows& rows = part.rows[static_cast<std::size_t>(slabs_.rank)];
    const std::ptrdiff_t columns = rows.count() * slabs_.pitch;
    const std::ptrdiff_t own_columns = slabs_.y_count(slabs_.rank) * slabs_.pitch;
    const std::ptrdiff_t width = 2 * fft::StaggeredDerivative<Real>::width;
    Real* block = fft::reals(derivative_.block());
    // The pieces of the x-lines by the rank that has them.
    struct Piece {
        const Real* from;
        std::ptrdiff_t from_stride;
        Real* to;
        std::ptrdiff_t to_stride, x_count;
        bool travels;
    };
    std::vector<Piece> pieces;
    Real* others = lines_.data();
    for (int r = 0; r < slabs_.ranks; ++r) {
        const std::ptrdiff_t x_count = slabs_.x_count(r);
        if (x_count == 0) continue;
        if (r == slabs_.rank) {
            const std::ptrdiff_t first = rows.begin * slabs_.pitch;
            pieces.push_back(
                {task.field + slabs_.y_start(r) * slabs_.pitch + first, slabs_.ny() * slabs_.pitch,
                 mine_.data() + static_cast<std::ptrdiff_t>(number) * x_count * own_columns + first,
                 own_columns, x_count, false});
            continue;
        }
        pieces.push_back({others, columns, others, columns, x_count, true});
        others += x_count * columns;
    }
    for (std::ptrdiff_t c = 0; c < columns; c += width) {
        const std::ptrdiff_t count = std::min(width, columns - c);
        Real* at = block;
        for (const Piece& p : pieces) {
            derivative_.copy_rows(p.from + c, p.from_stride, p.x_count, count, at, width);
            at += p.x_count * width;
        }
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
            if (p.travels)
                derivative_.copy_rows(at, width, p.x_count, count, p.to + c, p.to_stride);
            else
                derivative_.stream_rows(at, width, p.x_count, count, p.to + c, p.to_stride);
            at += p.x_count * width;
        }
    }
}

template <class Real>
void SplitAxis<Real>::differentiate(std::span<const Task> tasks) {
    if (slabs_.grid.is_plane) return; // the derivatives remain 0
    const bool alone = slabs_.ranks == 1;
    const auto of_a_field =
        static_cast<std::size_t>(parts_.back().offset + sum(parts_.back().sent));
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        for (const Part& part : parts_) {
            if (!alone) {
                pack(tasks[t], part);
                team_.all_to_all(std::span<const Real>(leaving_), part.sent, std::span(lines_),
                                 part.received);
            }
            along_x(t, tasks[t], part);
            if (alone) continue;
            const auto back =
                std::span(others_).subspan(t * of_a_field + static_cast<std::size_t>(part.offset));
            team_.all_to_all(std::span<const Real>(lines_), part.received, back, part.sent);
        }
    }
}

template class SplitAxis<double>;
template class SplitAxis<float>;

} // namespace shearwake::pstd
