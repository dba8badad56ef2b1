// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/layered/load/load_spectrum.hpp"
#include "engines/layered/response/case_progress.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"

#include <array>
#include <memory>
#include <optional>

namespace shearwake::layered {

struct LayeredPlan;

/// The tables of a case, in the order of LayeredPlan::keys.
enum Table : std::size_t {
    displacement_table,
    stress_table,
    tangential_table,
    loss_table,
    table_count
};

/// Exact solution for stratified media by Fourier transforms in x, y and t: one small linear system
/// per (k, omega), see docs/explanation/engine-layered.md. Passes the frames depth by depth and in
/// order of time for each depth. Between cases it keeps the transfer table of the last medium and
/// grid, the transforms of the grid, the Bessel functions of a grid with open edges, and the
/// spectra of a steered array.
class LayeredEngine : public engines::Engine {
public:
    engines::Resources resources(const Case& c, int ranks) const override;
    std::vector<Remark> limits(const Case& c) const override;
    std::vector<std::string> choices(const Case& c) const override;
    engines::Capabilities capabilities(const Case& c) const override;
    engines::StepChooser step_chooser(const Case&) const override { return {}; }
    /// Also the interpolation of H has a tolerance.
    engines::StepRefinement refine_time_step(const Case& c) const override;
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override;

private:
    /// run() without the end of a stop: throws StopRequested on all ranks.
    void compute(const Case& c, const Comm& team, engines::Observer& observer,
                 engines::Checkpoints* checkpoints);
    void prepare(const LayeredPlan& plan, const Comm& team, CaseProgress& progress);
    /// Frees the table if the key has no depths.
    void store_table(std::unique_ptr<TransferTable>& table, const TransferKey& key,
                     const Comm& team, CaseProgress& progress);

    /// Those of LayeredPlan::keys that the last case needed.
    std::array<std::unique_ptr<TransferTable>, table_count> tables_;
    std::shared_ptr<OpenGrid> open_grid_;
    std::unique_ptr<fft::SlabTransform> slabs_;
    std::ptrdiff_t slabs_nx_ = 0, slabs_ny_ = 0;
    SteeredSpectra steered_;
    // The largest batch so far. Allocating it for each case would cost as much as its transforms.
    fft::AlignedVector<std::complex<double>> batch_;
};

/// Everything that the transfer function of the displacement, of the stress at the receptors, or
/// the loss depends on. In the periodic regime the surface is always among the depths of the
/// displacement, as the first one; the others have an empty list of depths where they are not
/// needed. Not collective.
TransferKey key_of(const Case& c, const LayeredOptions& options);
/// `displacement`: key_of() this case.
TransferKey stress_key_of(const Case& c, const TransferKey& displacement);
/// Without depths if the case does not request the tangential displacement.
TransferKey tangential_key_of(const Case& c, const TransferKey& displacement);
TransferKey loss_key_of(const Case& c, const TransferKey& displacement);

/// The decisions of the engine for a case on a team of `ranks` ranks: `run` executes them, and the
/// resources follow from them. Not collective.
struct LayeredPlan {
    LayeredPlan(const Case& given, int ranks);

    Case c; // on the solved grid
    int ranks;
    std::ptrdiff_t ky_count;        // of the rank with most rows
    std::ptrdiff_t frames_together; // whose spectra are in memory at the same time
    std::array<TransferKey, table_count> keys;
    bool moves_along_x = false; // whether the load moves along x alone

    /// Whether a table is expanded once, not for each batch of frames.
    bool is_stored(const TransferKey& table) const;
    /// The decisions that do not depend on the ranks, one line each.
    std::vector<std::string> notes() const;
    std::vector<engines::Allocation> arrays() const;
};

/// Adds the work of a table to the progress of a case, on a rank with ky_count rows of a team of
/// `ranks`. Not collective.
void expect_table(CaseProgress& progress, const TransferKey& key, std::ptrdiff_t ky_count,
                  int ranks);
/// Adds the work of the frames of this rank. Not collective.
void expect_frames(CaseProgress& progress, const LayeredPlan& plan, std::ptrdiff_t ky_count);

/// The grid on which a case is solved: its domain or, with open edges, the domain enlarged on all
/// sides so that a periodic convolution equals that on the infinite plane. The enlargement is a
/// whole number of eighths of the domain and at most its size, so that cases with similar paths
/// share their tables. Not collective.
Domain solved_domain(const Case& c);
/// The case on that grid. Not collective.
Case solved_case(const Case& c);

/// The part of the rows of a rank on the solved grid that lies inside the domain.
struct InnerRows {
    std::ptrdiff_t x_start = 0, x_count = 0; // rows of the domain
    std::ptrdiff_t offset = 0;               // of its first value in the rank's plane
};
InnerRows inner_rows(const Domain& domain, const Domain& solved, const fft::SlabShare& share);

} // namespace shearwake::layered
