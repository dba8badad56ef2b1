// SPDX-License-Identifier: BSD-3-Clause
#include "serve/frame_keeper.hpp"

#include "parallel/agree.hpp"

#include <algorithm>

namespace shearwake::serve {

void FrameKeeper::begin(const engines::Slab& slab) {
    slab_ = slab;
    together(team_, [&] {
        rows_.resize(static_cast<std::size_t>(case_.time.frames * slab.x_count * case_.domain.ny));
    });
    ForwardingObserver::begin(slab);
}

void FrameKeeper::frame(const engines::Frame& frame) {
    if (frame.depth == 0) {
        float* out = rows_.data() + frame.number * slab_.x_count * case_.domain.ny;
        for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i)
            for (const double value : frame.u_z_m.row(i))
                *out++ = static_cast<float>(value);
    }
    ForwardingObserver::frame(frame);
}

void FrameKeeper::gather(std::vector<float>& all) const {
    if (team_.size() == 1) {
        all.swap(rows_);
        return;
    }
    const std::ptrdiff_t ny = case_.domain.ny, frames = case_.time.frames;
    const std::vector<long> starts = team_.gather(std::vector<long>{slab_.x_start}),
                            counts = team_.gather(std::vector<long>{slab_.x_count});
    const std::vector<float> parts = team_.gather(rows_);
    together(team_, [&] {
        all.resize(team_.is_root() ? static_cast<std::size_t>(frames * case_.domain.nx * ny) : 0);
        const float* from = parts.data();
        for (std::size_t rank = 0; rank < starts.size(); ++rank)
            for (std::ptrdiff_t n = 0; n < frames; ++n) {
                float* to = all.data() + (n * case_.domain.nx + starts[rank]) * ny;
                std::copy_n(from, counts[rank] * ny, to);
                from += counts[rank] * ny;
            }
    });
}

} // namespace shearwake::serve
