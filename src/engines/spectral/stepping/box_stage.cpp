// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stages.hpp"
#include "parallel/agree.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// The pencils without the stress of the elastic bodies, d = B^-1 (f - K u - C (u - u-)/dt), the
/// load f of the pencils and the strain of d at the cells. Usually the previous step has predicted
/// them in its pass.
class PredictedPencils : public Stage {
public:
    explicit PredictedPencils(StepState& state) : Stage(state) {
        together(s_.team, [&] {
            change_.resize(s_.now.size());
            load_.resize(static_cast<std::size_t>(s_.vectors.pencils() * parts));
            strain_.resize(s_.field.size());
        });
    }

    void advance() override {
        s_.load.sample(s_.step);
        if (is_valid_) return;
        s_.energy.clear();
        s_.each_pencil(
            {}, [](std::ptrdiff_t) {},
            [&](const Pencil& p) {
                predict(p, s_.scale(), s_.u(p), s_.u_before(p), s_.factor(p.at));
            });
        s_.planes.get(strain_);
        is_valid_ = true;
    }
    std::vector<engines::Allocation> arrays() const override {
        std::vector<engines::Allocation> all = s_.arrays();
        all.push_back({"prediction of the next step",
                       static_cast<double>((change_.size() + load_.size()) * sizeof(Block) +
                                           strain_.size() * sizeof(double))});
        return all;
    }
    void save(StateWriter& state) const override { s_.save_displacement(state); }
    void restore(const StateReader& state) override {
        s_.restore_displacement(state);
        is_valid_ = false;
    }

    const Block* change(const Pencil& p) const { return change_.data() + p.at * s_.size(); }
    const Block* load(const Pencil& p) const { return load_.data() + p.at * parts; }
    const StepState::Values& strain() const { return strain_; }

    /// Begins the prediction of the next step in a pass over the pencils, unless the sponge will
    /// change the displacement before it. Returns whether the pass predicts.
    bool begin_next() {
        is_valid_ = !s_.sponge_acts_at(s_.step + 1);
        if (is_valid_) s_.load.sample(s_.step + 1);
        return is_valid_;
    }
    /// Predicts the change of a pencil and puts its strain into the planes; `scale` is the weight
    /// of the second difference. Prefetches the factor that is needed next.
    void predict(const Pencil& p, double scale, const Block* u, const Block* before,
                 const Block* needed) {
        Block* change = change_.data() + p.at * s_.size();
        Block* pressure = load_.data() + p.at * parts;
        s_.put_forces(p, u, before, change, pressure, needed);
        s_.solve(p, change);
        s_.add_work(p, scale, u, before, change, pressure);
        s_.put_strain(p, change);
    }
    void end_next() { s_.planes.get(strain_); }

private:
    bool is_valid_ = false; // for the current displacement
    fft::AlignedVector<Block> change_, load_;
    StepState::Values strain_;
};

/// With G = E B^-1 E^T, g = B^-1 (f - K u - C (u - u-)/dt) and the explicit stress s of the bodies,
///     e = E g - G t,   t = s + S e,   d = g - B^-1 E^T t.
/// The box yields G, so that t is known before the pass over the pencils, which applies it and
/// predicts g of the next step while the factors are in the cache.
class BoxStage : public Stage {
public:
    BoxStage(StepState& state, const BoxGrid& grid, PredictedPencils& predicted)
        : Stage(state), predicted_(predicted), iteration_(state),
          box_(state.field, grid, state.slabs, state.team) {
        box_.assemble(
            [&](std::ptrdiff_t plane, StrainPlanes& planes) { respond_to_plane(plane, planes); });
    }

    void advance() override {
        s_.find_stress();
        box_.respond(s_.stress, s_.change, BoxResponse::Precision::full);
        for (std::size_t i = 0; i < s_.change.size(); ++i)
            s_.change[i] += predicted_.strain()[i];
        const auto with = [this](BoxResponse::Precision precision) {
            return [this, precision](const StepState::Values& stress, StepState::Values& strain) {
                box_.respond(stress, strain, precision);
            };
        };
        if (iteration_.solve({.full = with(BoxResponse::Precision::full),
                              .rounded = with(BoxResponse::Precision::rounded)}) > 0) {
            const StepState::Values& implicit = iteration_.stress();
            for (std::size_t i = 0; i < s_.stress.size(); ++i)
                s_.stress[i] += implicit[i];
        }
        s_.planes.set(s_.stress);
        complete_and_predict();
        iteration_.advance_strains();
    }
    std::vector<engines::Allocation> arrays() const override {
        std::vector<engines::Allocation> all = iteration_.arrays();
        all.push_back({"box of elastic bodies", box_.memory_B()});
        return all;
    }
    void save(StateWriter& state) const override { iteration_.save(state); }
    void restore(const StateReader& state) override { iteration_.restore(state); }

private:
    /// Ends the rows of `planes` from `plane` on with the strain for a unit stress in this plane.
    /// Not collective.
    void respond_to_plane(std::ptrdiff_t plane, StrainPlanes& planes) {
        const std::ptrdiff_t components = s_.transfer.components(), pitch = 2 * s_.slabs.nx();
        const StrainPoint& point =
            s_.transfer.points()[static_cast<std::size_t>(plane / components)];
        const StrainTransfer one(s_.mesh, {point}, static_cast<int>(components));
        std::vector<double> unit(static_cast<std::size_t>(components * pitch), 0.0);
        for (std::ptrdiff_t i = 0; i < s_.slabs.nx(); ++i)
            unit[static_cast<std::size_t>(plane % components * pitch + 2 * i)] = 1.0;
        Block* force = s_.scratch.data();
        for (std::ptrdiff_t row = 0; row < s_.vectors.rows(); ++row) {
            if (s_.vectors.is_nyquist(row)) {
                planes.end_row(row, StrainPlanes::Modes::emptied);
                continue;
            }
            for (std::ptrdiff_t block = 0; block < s_.vectors.blocks(); ++block) {
                std::fill(s_.scratch.begin(), s_.scratch.end(), Block{});
                const WaveBlock waves = s_.vectors.waves(row, block);
                one.add_force(waves, unit.data(), pitch, s_.per_point(), force);
                s_.solve(s_.pencil(row, block), force);
                s_.transfer.strain(planes.in_line(waves), force, planes.line(row), planes.stride());
            }
            planes.end_row_from(row, plane);
        }
    }

    void complete_and_predict() {
        const double scale = s_.scale();
        Block* response = s_.scratch.data();
        double work = 0.0;
        s_.energy.clear();
        const bool predicts = predicted_.begin_next();
        s_.each_pencil({.strain = predicts}, [&](const Pencil& p) {
            const Block* u = s_.u(p);
            Block* before = s_.u_before(p);
            std::fill_n(response, s_.size(), Block{});
            s_.add_planes_force(p, response);
            s_.solve(p, response);
            s_.kernels.advance_by_sum(s_.size(), scale, u, predicted_.change(p), response, before);
            work += s_.work_of_change(p, scale, response, predicted_.load(p));
            // The factor of the next pencil, since this one is in the cache.
            if (predicts)
                predicted_.predict(p, 1.0, before, u,
                                   s_.factor(std::min(p.at + 1, s_.vectors.pencils() - 1)));
        });
        s_.energy.watch.add_work(scale * work);
        if (predicts) predicted_.end_next();
    }

    PredictedPencils& predicted_;
    StrainIteration iteration_;
    BoxResponse box_;
};

} // namespace

BoxStages make_box_stages(StepState& state, const BoxGrid& grid) {
    auto pencils = std::make_unique<PredictedPencils>(state);
    auto variation = std::make_unique<BoxStage>(state, grid, *pencils);
    return {std::move(pencils), std::move(variation)};
}

} // namespace shearwake::spectral
