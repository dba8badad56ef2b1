// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/view.hpp"
#include "storage/hdf5/h5.hpp"

#include <cstddef>
#include <hdf5.h>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::storage {

/// Values from a user file, in row-major order.
struct NumberBlock {
    std::vector<std::size_t> shape; // none: a single number
    std::vector<double> values;
    bool is_of_matlab = false;       // its indices have the order that MATLAB shows
    std::vector<std::string> scales; // the name of each dimension's scale; empty: not all have one
};

/// Reads a dataset of any number type, compressed or not, with at most 2^28 values. The order of
/// indices is that of its program: MATLAB, recognised by the attribute MATLAB_class, stores them in
/// reverse. `unit`: a suffix such as "_m"; values whose attribute `units` states another unit of
/// the same quantity are converted to it. Not collective. Throws UsageError if it is missing, not
/// numeric, too large, or has units of another quantity, and Error if it cannot be read.
NumberBlock read_numbers(hid_t file, const std::string& path, std::string_view unit = "");

/// The same array with other indices: number n of the result is number order[n] of the block.
NumberBlock with_indices(const NumberBlock& block, const std::vector<std::size_t>& order);
NumberBlock with_reversed_indices(const NumberBlock& block);

} // namespace shearwake::storage

namespace shearwake::h5 {

/// Position of the block of one rank in a dataset; the product of `count` is its size.
struct Block {
    std::vector<hsize_t> start, count;
};

/// Write or read one block per rank through MPI; ranks with an empty view participate without data.
/// Collective; throw CaseFailure with `what` on all ranks.
void write_block(const Id& dataset, const Block& block, View2<const double> values,
                 const std::string& what, const Comm& comm);
void read_block(const Id& dataset, const Block& block, View2<double> values,
                const std::string& what, const Comm& comm);

} // namespace shearwake::h5
