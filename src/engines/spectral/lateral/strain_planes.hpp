// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/window.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "fft/aligned.hpp"
#include "fft/run_transform.hpp"

#include <optional>

namespace shearwake::spectral {

/// Transforms along x between complete spectra and a window of their points. Not collective.
class LineWindow {
public:
    /// Points [begin, begin + count) of lines of nx points.
    LineWindow(std::ptrdiff_t nx, std::ptrdiff_t begin, std::ptrdiff_t count);
    /// Whether the sums over a window of this length are faster than FFTs.
    static bool pays(std::ptrdiff_t nx, std::ptrdiff_t count);

    std::ptrdiff_t begin() const { return begin_; }
    std::ptrdiff_t count() const { return count_; }
    /// Number of doubles of a folded line, of which the last ones are unused, so that consecutive
    /// planes do not occupy the same sets of the cache; and its format for a block of wave vectors.
    std::ptrdiff_t line_reals() const { return folds * fold_pitch(nx_) + lane_count; }
    WaveBlock folded(WaveBlock waves) const {
        waves.middle = of_middle_.data() + waves.first / lane_count;
        return waves;
    }

    /// Transform `planes` folded lines; the strides are in doubles. Unnormalised.
    void to_window(std::ptrdiff_t planes, const double* line, std::ptrdiff_t line_stride,
                   double* window, std::ptrdiff_t window_stride);
    void to_line(std::ptrdiff_t planes, const double* window, std::ptrdiff_t window_stride,
                 double* line, std::ptrdiff_t line_stride);

private:
    WindowArrays arrays() const;
    double* scratch(std::ptrdiff_t size);

    const WindowKernels& kernels_;
    std::ptrdiff_t nx_, begin_, count_;
    fft::AlignedVector<Turn> by_distance_, by_kx_, of_middle_;
    fft::AlignedVector<double> scratch_;
};

/// The planes of strain or stress, [point][component], between the cells where the medium varies
/// and the pencils, or those of displacement and force around the markers of rigid bodies. They are
/// stored as lines over x, one per ky of this rank. A line is transformed to a spectrum only while
/// its pencils are processed, when it is in the cache. If the cells occupy a small part of the
/// lines (LineWindow), only this part is stored, and the spectra of one ky.
class StrainPlanes {
public:
    /// Indices in the plane of the point that is the first one of `slabs`, which may be smaller
    /// than the plane if it contains all cells.
    struct Corner {
        std::ptrdiff_t x = 0, y = 0;
    };
    /// Collective; the owners of `cells` and `slabs` must outlive this object.
    StrainPlanes(const PlaneCells& cells, const fft::SlabTransform& slabs, const Comm& team,
                 Corner corner);
    /// Allocates the planes. Not collective.
    void assemble();

    std::ptrdiff_t count() const { return count_; }
    /// Number of plane transforms so far, in both directions.
    std::ptrdiff_t transforms() const { return transforms_; }
    double memory_B() const {
        return static_cast<double>((planes_.size() + spectra_.size()) * sizeof(double));
    }

    /// Number of points that are exchanged together if the data of one takes `of_point_B` bytes on
    /// all ranks.
    static double points_together(double points, double of_point_B);

    /// Set the planes from the values at the cells, and read them back. Collective.
    using Values = std::vector<double>;
    void set(const Values& values);
    void get(Values& values);
    /// get() for the points from `first` on. Collective.
    void get_from(std::size_t first, Values& values);
    /// Transform the lines of one ky to spectra and back. With Modes::emptied the Nyquist modes, of
    /// x or of the complete row, are set to zero. Not collective.
    void begin_row(std::ptrdiff_t row);
    enum class Modes { retained, emptied };
    void end_row(std::ptrdiff_t row, Modes modes);
    /// end_row() with Modes::retained for the planes from `first` on.
    void end_row_from(std::ptrdiff_t row, std::ptrdiff_t first);
    /// The spectrum of plane 0 between begin_row() and end_row(); that of the next plane begins
    /// stride() doubles later.
    double* line(std::ptrdiff_t row) {
        return window_ ? spectra_.data() : reals_from(2 * row * slabs_.line_pitch());
    }
    std::ptrdiff_t stride() const { return window_ ? window_->line_reals() : slabs_.lines_reals(); }
    /// Wave vectors with the format of the spectrum.
    WaveBlock in_line(const WaveBlock& waves) const {
        return window_ ? window_->folded(waves) : waves;
    }

private:
    /// A place in planes_, which are empty in a medium without bodies.
    double* reals_from(std::ptrdiff_t offset) {
        return planes_.empty() ? nullptr : planes_.data() + offset;
    }
    /// Number of doubles between planes as stored, and the stored part of a line of plane 0.
    std::ptrdiff_t stored_stride() const;
    double* stored(std::ptrdiff_t row) {
        return window_ ? reals_from(2 * row * window_->count()) : line(row);
    }
    PlaneCells cells_;
    const fft::SlabTransform& slabs_;
    /// Consecutive points that are exchanged between the ranks together.
    struct Group {
        std::size_t first_point, end_point;
        fft::RunTransform transform;
        std::vector<fft::RunTransform::Plane> planes;
    };
    double* stored_plane(std::size_t point) {
        return planes_.data() +
               static_cast<std::ptrdiff_t>(point * cells_.components) * stored_stride();
    }
    std::vector<Group> groups_;
    std::optional<LineWindow> window_;
    std::ptrdiff_t nx_, count_, transforms_ = 0;
    fft::AlignedVector<double> planes_;
    fft::AlignedVector<double> spectra_; // of one ky; only with a window
};

} // namespace shearwake::spectral
