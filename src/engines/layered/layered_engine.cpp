// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/layered_engine.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "engines/layered/energy_balance.hpp"
#include "engines/layered/load/jump_tail.hpp"
#include "engines/layered/load/load_spectrum.hpp"
#include "engines/layered/load/time_step.hpp"
#include "fft/aligned.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

/// Number of lines (kx) that are transposed together from time order to frame order: four cache
/// lines per frame.
constexpr std::ptrdiff_t lines_together = 16;

/// The responses of this rank's wave vectors at a batch of frames, before multiplication by the
/// factors that are common to all frames.
class FieldSpectra {
public:
    FieldSpectra(const Case& c, const TransferKey& key, const fft::SlabShare& share,
                 std::ptrdiff_t most_frames, fft::AlignedVector<Complex>& memory,
                 SteeredSpectra& steered, CaseProgress& progress)
        : case_(c), kernels_(simd::kernels<ResponseKernels>()), time_(key.time), share_(share),
          coarse_(key.time.samples / samples_per_frame(c, key.time)),
          first_frame_(key.time.first_s > 0.0 ? 0 : 1), roll_off_(roll_off(key.time)),
          load_(c, key.time, share.ky_start, share.ky_count, steered, progress),
          stored_nx_(load_.is_mirrored() ? c.domain.nx / 2 + 1 : c.domain.nx),
          backward_(coarse_, fft::Direction::backward, lines_together),
          lines_(static_cast<std::size_t>(coarse_ * lines_together)),
          jumps_(static_cast<std::size_t>(jumps_per_line() * lines_together)), spectra_(memory) {
        const auto needed = static_cast<std::size_t>(most_frames * plane());
        if (spectra_.size() < needed) spectra_.resize(needed);
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
            growth_.push_back(std::exp(time_.decay_rad_s * c.time.frame_s(n)));
        factors_.resize(static_cast<std::size_t>(share.ky_count * c.domain.nx));
        for (std::ptrdiff_t ky = 0; ky < share.ky_count; ++ky)
            find_factors(ky);
    }

    /// What a sum of energies needs in addition to the table of H.
    struct Energy {
        TransferTable* losses;
        EnergySums sums;
    };
    Energy energy(TransferTable& losses) const { return {&losses, {time_, roll_off_}}; }

    /// `most_rows`: the largest number of rows of a rank; `energy`: sums to which the wave vectors
    /// are added, or null. Collective.
    void compute(TransferTable& table, std::size_t depth, std::ptrdiff_t first,
                 std::ptrdiff_t count, std::ptrdiff_t most_rows, Energy* energy,
                 CaseProgress& progress) {
        const JumpTail tail(load_.nodes(), time_, time_.samples / coarse_, table.key().quantity);
        for (std::ptrdiff_t ky = 0; ky < most_rows; ++ky) {
            const bool is_mine = ky < share_.ky_count;
            const auto h = is_mine ? table.row(ky, depth) : std::span<const Complex>();
            const bool adds = energy && is_mine; // the tables are then in memory, see TransferTable
            const Row surface = adds ? Row{table.row(ky, 0), energy->losses->row(ky, 0)} : Row{};
            for (std::ptrdiff_t kx = 0; kx < stored_nx_; kx += lines_together) {
                progress.end_if_asked();
                if (!is_mine) continue;
                const std::ptrdiff_t lines = std::min(lines_together, stored_nx_ - kx);
                for (std::ptrdiff_t l = 0; l < lines; ++l) {
                    const auto load = respond(kx + l, ky, h, lines_.data() + l * coarse_,
                                              jumps_.data() + l * jumps_per_line());
                    if (adds && !load.empty()) add(kx + l, ky, load, surface, energy->sums);
                }
                backward_.execute(lines_.data());
                for (std::ptrdiff_t l = 0; l < lines; ++l)
                    tail.add(kernels_, line_response(h, kx + l),
                             jumps_.data() + l * jumps_per_line(), lines_.data() + l * coarse_);
                kernels_.turn(fft::reals(lines_.data() + first + first_frame_), lines, coarse_,
                              count, plane(), fft::reals(spectra_.data() + ky * stored_nx_ + kx));
                progress.record_completed(CaseProgress::Stage::samples, static_cast<double>(lines));
            }
        }
    }

    /// Writes a row of u_z(ky, kx) at frame `first + in_batch`.
    void put_row(std::ptrdiff_t first, std::ptrdiff_t in_batch, std::ptrdiff_t ky,
                 Complex* row) const {
        const auto scale = load_.is_mirrored() ? kernels_.scale_mirrored_row : kernels_.scale_row;
        scale(fft::reals(spectra_.data() + in_batch * plane() + ky * stored_nx_),
              fft::reals(factors_.data() + ky * case_.domain.nx),
              growth_[static_cast<std::size_t>(first + in_batch)], case_.domain.nx,
              fft::reals(row));
    }

    /// From now on, rows are those of the derivative along x (0) or y (1) of the inverse transform:
    /// the tangential displacement that belongs to its potential U / k.
    void differentiate(std::size_t component) {
        const std::ptrdiff_t nx = case_.domain.nx;
        const double dkx = two_pi / case_.domain.extent_x_m(),
                     dky = two_pi / case_.domain.extent_y_m();
        for (std::ptrdiff_t row = 0; row < share_.ky_count; ++row) {
            find_factors(row);
            for (std::ptrdiff_t kx = 0; kx < nx; ++kx) {
                const double k = component == 0
                                     ? dkx * static_cast<double>(2 * kx < nx ? kx : kx - nx)
                                     : dky * static_cast<double>(share_.ky_start + row);
                factors_[static_cast<std::size_t>(row * nx + kx)] *= Complex(0.0, k);
            }
        }
    }

private:
    std::ptrdiff_t plane() const { return share_.ky_count * stored_nx_; }
    std::ptrdiff_t jumps_per_line() const {
        return jump_orders * std::ssize(load_.nodes().breaks());
    }
    /// H of one wave vector of a row.
    std::span<const Complex> line_response(std::span<const Complex> h_row,
                                           std::ptrdiff_t kx) const {
        const auto frequencies = static_cast<std::size_t>(time_.samples / 2 + 1);
        return h_row.subspan(static_cast<std::size_t>(std::min(kx, case_.domain.nx - kx)) *
                                 frequencies,
                             frequencies);
    }

    /// Computes the factors of a row, all but e^{+decay t}. They are zero at the Nyquist modes,
    /// which carry no load.
    void find_factors(std::ptrdiff_t row) {
        const std::ptrdiff_t nx = case_.domain.nx, ky = share_.ky_start + row;
        const auto factors = std::span(factors_).subspan(static_cast<std::size_t>(row * nx),
                                                         static_cast<std::size_t>(nx));
        load_.factors(ky, factors);
        factors[static_cast<std::size_t>(nx / 2)] = 0.0;
        if (2 * ky == case_.domain.ny) std::fill(factors.begin(), factors.end(), 0.0);
        const double scale =
            case_.scene.load.peak_Pa / (case_.domain.extent_x_m() * case_.domain.extent_y_m() *
                                        static_cast<double>(time_.samples));
        for (Complex& factor : factors)
            factor *= scale;
    }

    /// Whether the load is nonzero at this wave vector or its mirror image.
    bool is_loaded(std::ptrdiff_t kx, std::ptrdiff_t ky) const {
        const std::ptrdiff_t nx = case_.domain.nx;
        const Complex* factors = factors_.data() + ky * nx;
        return factors[kx] != 0.0 || (load_.is_mirrored() && factors[(nx - kx) % nx] != 0.0);
    }

    /// Computes one wave vector: load times H at the frequencies of the frames. Returns the load,
    /// or nothing where it is zero, and stores its jumps.
    std::span<const Complex> respond(std::ptrdiff_t kx, std::ptrdiff_t ky,
                                     std::span<const Complex> h_row, Complex* line,
                                     Complex* jumps) {
        if (!is_loaded(kx, ky)) {
            std::fill_n(line, coarse_, Complex(0.0));
            std::fill_n(jumps, jumps_per_line(), Complex(0.0));
            return {};
        }
        const LoadSpectrum::Line of_load = load_.line(kx, share_.ky_start + ky);
        std::ranges::copy(of_load.jumps, jumps);
        kernels_.respond(fft::reals(line_response(h_row, kx).data()), roll_off_.data(),
                         fft::reals(of_load.load.data()), time_.samples, coarse_, fft::reals(line));
        return of_load.load;
    }

    /// H and the loss of a row of wave vectors.
    struct Row {
        std::span<const Complex> h, loss;
    };
    /// Adds the energies of a wave vector, of its mirror image in x if that has no line, and of the
    /// complex conjugates in the other half of the spectrum.
    void add(std::ptrdiff_t kx, std::ptrdiff_t row, std::span<const Complex> load,
             const Row& surface, EnergySums& sums) const {
        const std::ptrdiff_t nx = case_.domain.nx;
        const auto frequencies = static_cast<std::size_t>(time_.samples / 2 + 1);
        const Complex* factors = factors_.data() + row * nx;
        double weight = std::norm(factors[kx]);
        if (load_.is_mirrored() && kx > 0 && 2 * kx < nx) weight += std::norm(factors[nx - kx]);
        if (share_.ky_start + row > 0) weight *= 2.0;
        const auto at = static_cast<std::size_t>(std::min(kx, nx - kx)) * frequencies;
        sums.add(load, surface.h.subspan(at, frequencies), surface.loss.subspan(at, frequencies),
                 weight);
    }

    const Case& case_;
    const ResponseKernels& kernels_;
    TimeTransform time_;
    fft::SlabShare share_;
    std::ptrdiff_t coarse_, first_frame_;   // the frame in a line that is frame 0 of the case
    std::vector<double> roll_off_, growth_; // per frequency; per frame
    LoadSpectrum load_;
    std::ptrdiff_t stored_nx_; // modes stored per row
    fft::LineTransform backward_;
    fft::AlignedVector<Complex> lines_;
    std::vector<Complex> jumps_;   // of each line
    std::vector<Complex> factors_; // [row][kx]
    fft::AlignedVector<Complex>& spectra_;
};

/// Adds a warning to a report if the step is too long.
void warn_of_step(const Case& c, double step_s, engines::SolverReport& report) {
    const double error = step_error(c, step_s);
    if (error <= stated_accuracy) return;
    const bool is_given = std::get<LayeredOptions>(c.solver).time_step_s.has_value();
    report.warnings.push_back(
        {Severity::warning, is_given ? "solver.layered.time_step_us" : "load.modulation",
         fmt::format("a time step of {:.4g} us does not resolve the load and the response to its "
                     "jumps{}; {}",
                     1e6 * step_s,
                     error < largest_estimate
                         ? fmt::format(": the estimated error is {:.1e} of the maximum of the "
                                       "field, more than {:.0e}",
                                       error, stated_accuracy)
                         : "",
                     is_given ? "remove this key, or use a shorter step"
                              : "use longer edges or smoother gains")});
}

double period_times_area_s_m2(const Case& c) {
    return c.time.duration_s() * c.domain.extent_x_m() * c.domain.extent_y_m();
}

/// Passes frames from their spectra.
struct FrameLoop {
    const LayeredPlan& plan;
    const Domain& domain; // of the observer
    InnerRows inner;
    fft::SlabTransform& slabs;
    FieldSpectra& spectra;
    fft::AlignedVector<double>& plane;
    CaseProgress& progress;

    /// Calls emit(frame, depth, values) for the last `depths` depths of a table. `energy`: sums for
    /// the first of them, or null. Collective.
    void pass(TransferTable& table, std::size_t depths, FieldSpectra::Energy* energy,
              const auto& emit) {
        const std::size_t other = table.key().depths_m.size() - depths; // that are not measured
        // All ranks use the same batch, determined by the largest slab.
        const std::ptrdiff_t batch = plan.frames_together, frames = plan.c.time.frames;
        for (std::size_t depth = 0; depth < depths; ++depth)
            for (std::ptrdiff_t first = 0; first < frames; first += batch) {
                const std::ptrdiff_t count = std::min(batch, frames - first);
                spectra.compute(table, other + depth, first, count, plan.ky_count,
                                depth == 0 && first == 0 ? energy : nullptr, progress);
                for (std::ptrdiff_t n = 0; n < count; ++n) {
                    progress.end_if_asked();
                    slabs.to_physical([&](std::ptrdiff_t ky,
                                          Complex* row) { spectra.put_row(first, n, ky, row); },
                                      plane.data());
                    emit(first + n, depth,
                         View2<const double>(plane.data() + inner.offset, inner.x_count, domain.ny,
                                             slabs.share().padded_ny));
                    progress.record_completed(CaseProgress::Stage::frames);
                }
            }
    }
};

} // namespace

void LayeredEngine::prepare(const LayeredPlan& plan, const Comm& team, CaseProgress& progress) {
    const Case& c = plan.c;
    if (!slabs_ || slabs_nx_ != c.domain.nx || slabs_ny_ != c.domain.ny) {
        slabs_ = std::make_unique<fft::SlabTransform>(c.domain.nx, c.domain.ny, team);
        slabs_nx_ = c.domain.nx;
        slabs_ny_ = c.domain.ny;
        tables_ = {};
    }
    const std::ptrdiff_t ky_count = slabs_->share().ky_count;
    expect_frames(progress, plan, ky_count);
    for (std::size_t i = 0; i < tables_.size(); ++i)
        if (!tables_[i] || tables_[i]->key() != plan.keys[i])
            expect_table(progress, plan.keys[i], ky_count, team.size());
    for (std::size_t i = 0; i < tables_.size(); ++i)
        store_table(tables_[i], plan.keys[i], team, progress);
}

void LayeredEngine::store_table(std::unique_ptr<TransferTable>& table, const TransferKey& key,
                                const Comm& team, CaseProgress& progress) {
    if (table && table->key() == key) return;
    table.reset(); // freed first, as two tables may not fit into memory
    if (key.depths_m.empty()) return;
    const fft::SlabShare& share = slabs_->share();
    const bool is_open = key.edges == DomainEdges::open;
    if (is_open && (!open_grid_ || !open_grid_->is_of(key.nx, key.ny, key.spacing_m)))
        together(team, [&] {
            open_grid_.reset();
            open_grid_ = std::make_shared<OpenGrid>(key.nx, key.ny, key.spacing_m);
        });
    table = std::make_unique<TransferTable>(key, share.ky_start, share.ky_count, team,
                                            is_open ? open_grid_.get() : nullptr, &progress);
}

engines::StepRefinement LayeredEngine::refine_time_step(const Case& c) const {
    auto options = std::get<LayeredOptions>(c.solver);
    options.time_step_s = 0.5 * time_transform(solved_case(c), options).step_s;
    options.interpolation_tolerance = std::max(0.25 * options.interpolation_tolerance, 1e-12);
    return {.options = options,
            .change =
                fmt::format("half the time step, {:.4g} us, and a quarter of the interpolation "
                            "tolerance",
                            1e6 * *options.time_step_s)};
}

void LayeredEngine::run(const Case& c, const Comm& team, engines::Observer& observer,
                        engines::Checkpoints* checkpoints) {
    try {
        compute(c, team, observer, checkpoints);
    } catch (const engines::StopRequested&) { // on all ranks
    }
}

void LayeredEngine::compute(const Case& given, const Comm& team, engines::Observer& observer,
                            engines::Checkpoints* checkpoints) {
    const LayeredPlan plan(given, team.size());
    const Case& c = plan.c;
    CaseProgress progress(checkpoints);
    prepare(plan, team, progress);
    const fft::SlabShare& share = slabs_->share();
    std::optional<FieldSpectra> spectra;
    fft::AlignedVector<double> plane;
    bool stops = false;
    fail_together(team, [&] {
        try {
            spectra.emplace(c, plan.keys[displacement_table], share, plan.frames_together, batch_,
                            steered_, progress);
        } catch (const engines::StopRequested&) { // on all ranks
            stops = true;
        }
        plane.resize(static_cast<std::size_t>(share.reals));
    });
    if (stops) throw engines::StopRequested{};

    progress.record_completed(CaseProgress::Stage::setup);
    std::optional<FieldSpectra::Energy> energy;
    if (tables_[loss_table]) energy = spectra->energy(*tables_[loss_table]);
    const InnerRows inner = inner_rows(given.domain, c.domain, share);
    observer.begin({inner.x_start, inner.x_count});
    FrameLoop frames{plan, given.domain, inner, *slabs_, *spectra, plane, progress};
    frames.pass(*tables_[displacement_table], c.measure.depths_m.size(),
                energy ? &*energy : nullptr,
                [&](std::ptrdiff_t n, std::size_t depth, View2<const double> values) {
                    observer.frame({.number = n, .depth = depth, .u_z_m = values});
                });
    engines::SolverReport report;
    if (energy) report = report_of(energy->sums.total(period_times_area_s_m2(c), team));
    for (std::string& note : plan.notes())
        report.notes.push_back(std::move(note));
    warn_of_step(c, plan.keys[displacement_table].time.step_s, report);
    observer.solved(report);
    if (tables_[stress_table])
        frames.pass(*tables_[stress_table], stress_depths_m(c).size(), nullptr,
                    [&](std::ptrdiff_t n, std::size_t depth, View2<const double> values) {
                        observer.stress({.number = n, .depth = depth, .compression_Pa = values});
                    });
    for (const std::size_t component : {0u, 1u}) {
        if (!tables_[tangential_table]) break;
        spectra->differentiate(component);
        frames.pass(*tables_[tangential_table], 1, nullptr,
                    [&](std::ptrdiff_t n, std::size_t, View2<const double> values) {
                        observer.tangential({.number = n, .component = component, .u_m = values});
                    });
    }
}

} // namespace shearwake::layered
