// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <memory>
#include <vector>

namespace shearwake::spectral {

/// The inverse of a symmetric positive definite matrix whose blocks of columns are distributed over
/// a team in turn. The operations on each column do not depend on the number of ranks.
class BlockInverse {
public:
    BlockInverse(std::size_t size, const Comm& team);
    ~BlockInverse();

    std::size_t size() const { return size_; }
    double memory_B() const; // of this rank
    /// Whether a column belongs to this rank, and the values of one that does. Not collective.
    bool is_mine(std::size_t column) const;
    double* column(std::size_t index);
    /// Replaces the matrix by its inverse (Gauss-Jordan elimination by blocks). Returns false on
    /// all ranks if it is not positive definite or its condition exceeds 1e13. Collective.
    bool invert();
    /// The product of the matrix with columns of size(), on every rank. Collective.
    std::vector<double> multiply(const std::vector<double>& columns) const;

private:
    struct Blocks;
    std::size_t first(std::size_t block) const;
    int owner(std::size_t block) const;
    double norm() const;
    std::size_t size_;
    Comm team_;
    std::unique_ptr<Blocks> blocks_;
};

} // namespace shearwake::spectral
