// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/cases.hpp"

namespace shearwake::test {

/// Stores the stress that an engine passes to receptors, on this rank's slab, instead of frames.
class StressStore : public FrameStore {
public:
    void frame(const engines::Frame& /*frame*/) override {}
    void stress(const engines::StressFrame& frame) override {
        frames_[{static_cast<long>(frame.depth), frame.number}] = values_of(frame.compression_Pa);
    }
};

/// All receptor stresses of a case, computed on this rank alone.
inline StressStore stresses_of(const Case& c) {
    return frames_of<StressStore>(c);
}

} // namespace shearwake::test
