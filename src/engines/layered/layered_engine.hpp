#pragma once

#include "engines/engine.hpp"
#include "engines/layered/transfer_table.hpp"
#include "fft/slab_transform.hpp"

#include <memory>

namespace shearwake {

/// Stratified media, exactly: Fourier in x, y and t, one small linear system per (k, omega).
/// Frames come depth by depth, each depth in order of time.
/// Kept between cases: the transfer table of the last medium and grid, the transforms of the grid.
class LayeredEngine : public Engine {
public:
    Estimate estimate(const Case& c, int ranks) const override;
    void run(const Case& c, const Comm& team, Observer& observer,
             Checkpoints* checkpoints) override;

private:
    void prepare(const Case& c, const Comm& team);
    void keep_table(std::unique_ptr<TransferTable>& table, const TransferKey& key,
                    const Comm& team);

    std::unique_ptr<TransferTable> table_, stress_table_; // the second where stress is asked for
    std::unique_ptr<SlabTransform> slabs_;
    std::ptrdiff_t slabs_nx_ = 0, slabs_ny_ = 0;
    // The largest batch so far: fresh pages for each case cost as much as its transforms.
    AlignedVector<std::complex<double>> batch_;
};

} // namespace shearwake
