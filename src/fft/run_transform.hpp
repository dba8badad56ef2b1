// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "fft/kernels/row_window.hpp"
#include "fft/slab_transform.hpp"

#include <complex>
#include <memory>
#include <span>
#include <vector>

namespace shearwake::fft {

/// Transforms of window_rows rows at a time that are zero outside of a window of y, or are needed
/// only there, with precomputed cosines and sines. Not collective.
class RowWindow {
public:
    /// Whether the sums are faster than FFTs of rows of `ny` points.
    static bool pays(std::ptrdiff_t ny, std::ptrdiff_t count);
    /// A window of the points from `begin` on.
    RowWindow(std::ptrdiff_t ny, std::ptrdiff_t begin, std::ptrdiff_t count);

    /// The values of the rows at a point of the complete row.
    double* point(std::ptrdiff_t y) { return rows_.data() + (y - begin_) * window_rows; }
    void clear_rows();
    /// The coefficients of the rows at one of the ny/2 + 1 ky.
    std::complex<double>* mode(std::ptrdiff_t ky) { return modes_.data() + ky * window_rows; }
    /// Compute the modes from the points, and the points from the modes. Unnormalised.
    void to_modes();
    void to_rows();

private:
    RowWindowArrays arrays() const;

    const RowWindowKernels& kernels_;
    std::ptrdiff_t begin_, count_, mode_count_;
    AlignedVector<double> angles_, middle_, weights_, rows_, scratch_;
    AlignedVector<std::complex<double>> modes_;
};

/// Columns [begin, end) of one of the physical rows of this rank. Their values begin at `offset` in
/// a compact array that holds the values of all runs.
struct RowRun {
    std::ptrdiff_t row, begin, end;
    std::size_t offset;
};

/// The y part of the transform of planes that are zero outside of some runs of their rows, or are
/// needed only there. to_lines() transforms the values of the runs to lines over x, one line per ky
/// of this rank (SlabTransform transforms these along x); to_values() is the way back. Of each
/// plane, only the rows between the first and the last row with runs of each rank are transformed
/// and sent, by FFTs, or by sums if the runs of all ranks occupy a short window of y (RowWindow).
/// The buffers are those of the SlabTransform, which must outlive this object.
class RunTransform {
public:
    /// The range of ky of a rank; ranges ascend with the rank.
    struct Lines {
        std::ptrdiff_t ky_start, ky_count;
    };
    /// Where the lines of a rank are, and what they contain. Row 0 of this rank is point `x_start`
    /// of a line of `length` points; consecutive lines are `pitch` complex numbers apart,
    /// consecutive planes `reals` doubles. Any distribution of the rows will do that ascends with
    /// the rank.
    struct Layout {
        Lines lines;
        std::ptrdiff_t x_start, length, pitch, reals;
    };
    /// `runs` are those of this rank, in ascending order. The first constructor uses the ky of the
    /// SlabTransform, the second one any distribution that covers all ky, both with the lines of
    /// the SlabTransform. Collective.
    RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs);
    RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                 Lines lines);
    RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                 const Layout& layout);
    /// Planes with different runs that are exchanged together.
    RunTransform(const SlabTransform& slabs, const Comm& team,
                 std::vector<std::vector<RowRun>> run_sets, const Layout& layout);

    /// Number of doubles between the lines of consecutive planes.
    std::ptrdiff_t lines_reals() const { return layout_.reals; }

    /// Transforms `planes` planes at once. The values of consecutive planes are `cells` doubles
    /// apart, their lines lines_reals() doubles. Unnormalised. Collective.
    void to_lines(const double* values, std::size_t cells, std::ptrdiff_t planes,
                  double* lines) const;
    void to_values(const double* lines, std::ptrdiff_t planes, double* values,
                   std::size_t cells) const;

    /// The same for planes that differ in their runs: which of them a plane has, and where its
    /// values begin. Collective.
    struct Plane {
        std::size_t sheet, first;
    };
    void to_lines(const double* values, std::span<const Plane> planes, double* lines) const;
    void to_values(const double* lines, std::span<const Plane> planes, double* values) const;

private:
    /// Points [begin, end) of a line whose rows have runs.
    struct Range {
        std::ptrdiff_t begin = 0, end = 0;
        std::ptrdiff_t count() const { return end - begin; }
    };
    /// The ky of a rank, and its rows with runs by sheet.
    struct Share {
        Lines lines;
        std::vector<Range> rows;
    };
    void gather_shares();
    /// Number of values exchanged with each rank, and offset of the next ones to be copied.
    struct ExchangeBuffers {
        std::vector<std::ptrdiff_t> of_rows, of_lines;
        std::vector<std::ptrdiff_t> of_rows_at, of_lines_at;
        std::span<std::complex<double>> rows, lines;
    };
    ExchangeBuffers exchange_buffers(std::span<const Plane> planes) const;
    static std::vector<Plane> equal_planes(std::ptrdiff_t count, std::size_t cells);
    std::ptrdiff_t rows_of(std::span<const Plane> planes, const Share& share) const;
    /// The lines of a plane; null if this rank has none.
    template <class Real>
    auto* lines_of(Real* lines, std::ptrdiff_t plane) const;
    /// Copies the data received for a line, and zeros for rows without runs.
    void fill_line(ExchangeBuffers& exchange_buffers, std::size_t sheet,
                   std::complex<double>* line) const;
    /// Runs that have not been processed yet, in ascending order.
    using RemainingRuns = std::span<const RowRun>;
    /// Rows that are transformed together.
    struct Rows {
        std::ptrdiff_t first, count;
    };
    /// The rows of this rank from i on; none at the end.
    Rows rows_at(std::ptrdiff_t i, const Range& of) const;
    void transform(Rows rows, RemainingRuns& runs, const double* values) const;
    void untransform(Rows rows, RemainingRuns& runs, double* values) const;
    void put_columns(Rows rows, const Lines& to, std::complex<double>* columns,
                     std::ptrdiff_t pitch) const;
    void gather_columns(Rows rows, const Lines& from, const std::complex<double>* columns,
                        std::ptrdiff_t pitch) const;
    void transform_row(std::ptrdiff_t row, RemainingRuns& runs, const double* values,
                       std::complex<double>* modes) const;
    void untransform_row(std::ptrdiff_t row, RemainingRuns& runs, std::complex<double>* modes,
                         double* values) const;

    const SlabTransform& slabs_;
    Comm team_;
    std::vector<std::vector<RowRun>> run_sets_;
    Layout layout_;
    std::size_t me_;
    std::vector<Share> shares_;         // by rank
    std::unique_ptr<RowWindow> window_; // if the runs occupy a short window of y
};

} // namespace shearwake::fft
