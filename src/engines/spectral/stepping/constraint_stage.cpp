// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stages.hpp"

namespace shearwake::spectral {
namespace {

/// Determines the forces F at the markers of the rigid bodies for the next displacement that the
/// pencils have left there, and adds the response B^-1 J^T F to it and its strain to the change of
/// the strain.
class ConstraintStage : public Stage {
public:
    using Stage::Stage;

    void advance() override {
        s_.bodies->advance(s_.scale());
        double work = 0.0;
        s_.each_reaction([&](const Pencil& p, const Block* displacement) {
            work += s_.add_to_next(p, displacement);
        });
        s_.energy.watch.add_work(s_.scale() * work);
        if (s_.varies()) s_.add_planes(s_.change);
    }

    std::vector<engines::Allocation> arrays() const override { return {s_.bodies->array()}; }
    void save(StateWriter& state) const override { s_.bodies->save(state); }
    void restore(const StateReader& state) override { s_.bodies->restore(state); }
};

} // namespace

std::unique_ptr<Stage> make_constraint(StepState& state) {
    return std::make_unique<ConstraintStage>(state);
}

} // namespace shearwake::spectral
