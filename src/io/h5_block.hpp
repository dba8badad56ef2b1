#pragma once

#include "base/view.hpp"
#include "io/h5.hpp"

namespace shearwake::h5 {

/// Where one rank's block of values lies in a dataset; the product of `count` is the block's size.
struct Block {
    std::vector<hsize_t> start, count;
};

/// Write or read one block a rank, through MPI and together; ranks with an empty view take part
/// with nothing. Collective; throw CaseFailure with `what` on all ranks together.
void write_block(const Id& dataset, const Block& block, View2<const double> values,
                 const std::string& what, const Comm& comm);
void read_block(const Id& dataset, const Block& block, View2<double> values,
                const std::string& what, const Comm& comm);

} // namespace shearwake::h5
