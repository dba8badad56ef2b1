#pragma once

#include "engines/spectral/lateral_field.hpp"
#include "engines/spectral/step_clock.hpp"
#include "fft/run_transform.hpp"

namespace shearwake {

/// The planes of strain or stress [point][component] between the cells where the medium varies and
/// the pencils: as lines over x, one for each of this rank's ky. A line is a spectrum only while
/// its pencils are worked on, when it is in the cache.
class StrainPlanes {
public:
    /// Collective.
    StrainPlanes(const LateralField& field, const SlabTransform& slabs, const Comm& team,
                 StepClock& clock);
    /// Their memory. Not collective.
    void assemble();

    std::ptrdiff_t count() const { return count_; }
    std::ptrdiff_t transforms() const { return transforms_; } // of planes so far, there or back
    double memory_B() const { return static_cast<double>(planes_.size() * sizeof(double)); }

    /// From the values at the cells, and back to them. Collective.
    void set(const LateralField::Values& values);
    void get(LateralField::Values& values);
    /// Lines of one ky to spectra; and back, the Nyquist modes emptied.
    void begin_row(std::ptrdiff_t row);
    void end_row(std::ptrdiff_t row, bool is_nyquist);
    /// Plane 0's line; the next plane's is `stride` doubles on.
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_.line_pitch(); }
    std::ptrdiff_t stride() const { return slabs_.lines_reals(); }

private:
    const LateralField& field_;
    const SlabTransform& slabs_;
    StepClock& clock_;
    std::vector<RunTransform> runs_; // of each point
    std::ptrdiff_t nx_, count_, transforms_ = 0;
    AlignedVector<double> planes_;
};

} // namespace shearwake
