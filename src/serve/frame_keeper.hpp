// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <vector>

namespace shearwake::serve {

/// Keeps the surface of all frames in single precision and passes everything on to another
/// observer.
class FrameKeeper : public engines::ForwardingObserver {
public:
    /// `rows`: memory for the frames of this rank, which keeps its size between cases.
    FrameKeeper(const Case& c, const Comm& team, engines::Observer& next, std::vector<float>& rows)
        : ForwardingObserver(next), case_(c), team_(team), rows_(rows) {}

    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;

    /// Moves the frames of all ranks to rank 0, into `all` with the shape [frame][x][y]; other
    /// ranks get an empty vector. Collective.
    void gather(std::vector<float>& all) const;

private:
    const Case& case_;
    const Comm& team_;
    std::vector<float>& rows_; // [frame][x of this rank][y]
    engines::Slab slab_;
};

} // namespace shearwake::serve
