#pragma once

#include "fft/slab_transform.hpp"

#include <vector>

namespace shearwake {

/// Values at columns [begin, end) of one of a rank's physical rows, from `offset` on in an array
/// that holds only those.
struct RowRun {
    std::ptrdiff_t row, begin, end;
    std::size_t offset;
};

/// Along y and from rank to rank, planes that are zero but for some runs of their rows, or wanted
/// only there: from the values in the runs to lines over x, one for each of this rank's ky (which
/// SlabTransform transforms along x), and back. Only rows between the first and the last of a rank
/// that has runs are transformed and sent. Its buffers are the SlabTransform's.
class RunTransform {
public:
    /// The ky of a rank, in the order of ranks.
    struct Lines {
        std::ptrdiff_t ky_start, ky_count;
    };
    /// `runs` of this rank's rows, ascending; lines of the ky that the SlabTransform gives it, or
    /// of others, all ky being somebody's. Collective.
    RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs);
    RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                 Lines lines);

    /// Doubles from the lines of one plane to those of the next.
    std::ptrdiff_t lines_reals() const { return lines_reals_; }

    /// Of `planes` planes at once: values of each `cells` doubles apart, lines lines_reals().
    /// Collective.
    void to_lines(const double* values, std::size_t cells, std::ptrdiff_t planes,
                  double* lines) const;
    void to_values(const double* lines, std::ptrdiff_t planes, double* values,
                   std::size_t cells) const;

private:
    struct Share { // of a rank: the rows of x that it has something in, and its ky
        std::ptrdiff_t x_begin, x_end, ky_start, ky_count;
        std::ptrdiff_t rows() const { return x_end - x_begin; }
    };
    /// What goes from rank to rank: counts and places in the buffers, by rank.
    struct Parcels {
        std::vector<int> of_rows, of_lines;
        std::vector<std::ptrdiff_t> of_rows_at, of_lines_at;
        std::complex<double>*rows = nullptr, *lines = nullptr;
    };
    Parcels parcels(std::ptrdiff_t planes) const;
    /// What other ranks have sent for a line, and zeros where nobody has runs.
    void fill_line(const Parcels& parcels, std::ptrdiff_t which, std::complex<double>* line) const;
    void transform_row(std::ptrdiff_t row, std::vector<RowRun>::const_iterator& run,
                       const double* values, std::complex<double>* modes) const;
    void untransform_row(std::ptrdiff_t row, std::vector<RowRun>::const_iterator& run,
                         std::complex<double>* modes, double* values) const;

    const SlabTransform& slabs_;
    Comm team_;
    std::vector<RowRun> runs_;
    std::ptrdiff_t begin_ = 0, end_ = 0; // this rank's rows with runs, its own numbers
    std::vector<Share> shares_;          // by rank
    Lines mine_;
    std::size_t me_;
    std::ptrdiff_t lines_reals_;
};

} // namespace shearwake
