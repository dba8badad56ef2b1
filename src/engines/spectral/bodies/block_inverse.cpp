// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/block_inverse.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace shearwake::spectral {
namespace {

using Matrix = Eigen::MatrixXd;
/// Columns per block.
constexpr std::size_t width = 48;

Eigen::Index index(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

} // namespace

struct BlockInverse::Blocks {
    std::vector<Matrix> mine; // in ascending order
};

BlockInverse::BlockInverse(std::size_t size, const Comm& team)
    : size_(size), team_(team), blocks_(std::make_unique<Blocks>()) {
    for (std::size_t block = 0; first(block) < size; ++block)
        if (owner(block) == team.rank())
            blocks_->mine.push_back(
                Matrix::Zero(index(size), index(first(block + 1) - first(block))));
}

BlockInverse::~BlockInverse() = default;

double BlockInverse::memory_B() const {
    double values = 0.0;
    for (const Matrix& block : blocks_->mine)
        values += static_cast<double>(block.size());
    return values * sizeof(double);
}

std::size_t BlockInverse::first(std::size_t block) const {
    return std::min(block * width, size_);
}

int BlockInverse::owner(std::size_t block) const {
    return static_cast<int>(block % static_cast<std::size_t>(team_.size()));
}

bool BlockInverse::is_mine(std::size_t column) const {
    return owner(column / width) == team_.rank();
}

double* BlockInverse::column(std::size_t i) {
    const std::size_t block = i / width / static_cast<std::size_t>(team_.size());
    return blocks_->mine[block].col(index(i % width)).data();
}

/// The largest sum of the magnitudes of a column.
double BlockInverse::norm() const {
    double most = 0.0;
    for (const Matrix& block : blocks_->mine)
        most = std::max(most, block.cwiseAbs().colwise().sum().maxCoeff());
    return team_.max(most);
}

bool BlockInverse::invert() {
    const double before = norm();
    for (std::size_t k = 0; first(k) < size_; ++k) {
        const auto from = index(first(k)), count = index(first(k + 1) - first(k));
        const auto mine = k / static_cast<std::size_t>(team_.size());
        const bool owns = owner(k) == team_.rank();
        std::vector<double> values;
        if (owns)
            values.assign(blocks_->mine[mine].data(),
                          blocks_->mine[mine].data() + blocks_->mine[mine].size());
        team_.broadcast(values, owner(k));
        const Eigen::Map<const Matrix> panel(values.data(), index(size_), count);
        const Eigen::LLT<Matrix> pivot(panel.middleRows(from, count));
        if (pivot.info() != Eigen::Success) return false;
        const Matrix inverse = pivot.solve(Matrix::Identity(count, count));
        for (std::size_t j = 0; j < blocks_->mine.size(); ++j) {
            Matrix& block = blocks_->mine[j];
            if (owns && j == mine) {
                block.noalias() = -panel * inverse;
                block.middleRows(from, count) = inverse;
                continue;
            }
            const Matrix row = inverse * block.middleRows(from, count);
            block.noalias() -= panel * row;
            block.middleRows(from, count) = row;
        }
    }
    return before * norm() < 1e13;
}

std::vector<double> BlockInverse::multiply(const std::vector<double>& columns) const {
    const auto n = index(size_), count = index(columns.size() / size_);
    const Eigen::Map<const Matrix> given(columns.data(), n, count);
    std::vector<double> mine; // [block][row][column]; the matrix is symmetric
    for (const Matrix& block : blocks_->mine) {
        const Matrix part = given.transpose() * block;
        mine.insert(mine.end(), part.data(), part.data() + part.size());
    }
    const std::vector<double> all = team_.all_gather(mine);
    std::vector<double> product(columns.size());
    std::size_t at = 0;
    for (int rank = 0; rank < team_.size(); ++rank)
        for (std::size_t block = 0; first(block) < size_; ++block) {
            if (owner(block) != rank) continue;
            for (std::size_t row = first(block); row < first(block + 1); ++row)
                for (Eigen::Index c = 0; c < count; ++c, ++at)
                    product[static_cast<std::size_t>(c) * size_ + row] = all[at];
        }
    return product;
}

} // namespace shearwake::spectral
