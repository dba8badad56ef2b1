// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/lateral/lateral_field.hpp"
#include "engines/spectral/lateral/step_clock.hpp"
#include "fft/run_transform.hpp"

namespace shearwake::spectral {

/// The planes of strain or stress, [point][component], between the cells where the medium varies
/// and the pencils, stored as lines over x, one per ky of this rank. A line is transformed to a
/// spectrum only while its pencils are processed, when it is in the cache.
class StrainPlanes {
public:
    /// Collective; `field`, `slabs` and `clock` must outlive this object.
    StrainPlanes(const LateralField& field, const fft::SlabTransform& slabs, const Comm& team,
                 StepClock& clock);
    /// Allocates the planes. Not collective.
    void assemble();

    std::ptrdiff_t count() const { return count_; }
    /// Number of plane transforms so far, in both directions.
    std::ptrdiff_t transforms() const { return transforms_; }
    double memory_B() const { return static_cast<double>(planes_.size() * sizeof(double)); }

    /// Set the planes from the values at the cells, and read them back. Collective.
    void set(const LateralField::Values& values);
    void get(LateralField::Values& values);
    /// Transform the lines of one ky to spectra and back. With Modes::emptied the Nyquist modes, of
    /// x or of the complete row, are set to zero. Not collective.
    void begin_row(std::ptrdiff_t row);
    enum class Modes { kept, emptied };
    void end_row(std::ptrdiff_t row, Modes modes);
    /// The line of plane 0; that of the next plane begins stride() doubles later.
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_.line_pitch(); }
    std::ptrdiff_t stride() const { return slabs_.lines_reals(); }

private:
    const LateralField& field_;
    const fft::SlabTransform& slabs_;
    StepClock& clock_;
    std::vector<fft::RunTransform> runs_; // per point
    std::ptrdiff_t nx_, count_, transforms_ = 0;
    fft::AlignedVector<double> planes_;
};

} // namespace shearwake::spectral
