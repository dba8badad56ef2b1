// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cassert>
#include <cstddef>
#include <span>

namespace shearwake {

/// Non-owning view of a matrix with `rows` rows of `columns` contiguous values. Consecutive rows
/// begin `stride` values apart; stride >= columns.
template <class T>
class View2 {
public:
    View2() = default;
    View2(T* data, std::ptrdiff_t rows, std::ptrdiff_t columns, std::ptrdiff_t stride)
        : data_(data), rows_(rows), columns_(columns), stride_(stride) {
        assert(stride >= columns);
    }
    View2(T* data, std::ptrdiff_t rows, std::ptrdiff_t columns)
        : View2(data, rows, columns, columns) {}
    template <class U>
    requires std::is_same_v<const U, T>
    View2(View2<U> other) // NOLINT: implicit conversion to a view of const values
        : View2(other.data(), other.rows(), other.columns(), other.stride()) {}

    T& operator()(std::ptrdiff_t i, std::ptrdiff_t j) const {
        assert(i >= 0 && i < rows_ && j >= 0 && j < columns_);
        return data_[i * stride_ + j];
    }
    std::span<T> row(std::ptrdiff_t i) const {
        assert(i >= 0 && i < rows_);
        return {data_ + i * stride_, static_cast<std::size_t>(columns_)};
    }
    T* data() const { return data_; }
    std::ptrdiff_t rows() const { return rows_; }
    std::ptrdiff_t columns() const { return columns_; }
    std::ptrdiff_t stride() const { return stride_; }

private:
    T* data_ = nullptr;
    std::ptrdiff_t rows_ = 0;
    std::ptrdiff_t columns_ = 0;
    std::ptrdiff_t stride_ = 0;
};

} // namespace shearwake
