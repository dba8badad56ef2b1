// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/displacements.hpp"
#include "engines/spectral/stepping/receptor_stress.hpp"
#include "engines/spectral/stepping/stages.hpp"
#include "engines/spectral/stepping/tensor_volumes.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

class Output : public OutputStage {
public:
    Output(StepState& state, std::ptrdiff_t per_frame);
    void advance() override;
    std::vector<engines::Allocation> arrays() const override;
    // What is saved for the start of a step is emitted at its end, before a checkpoint.
    void save(StateWriter&) const override {}
    void restore(const StateReader&) override {}
    void emit_earlier(engines::Observer& observer) override;
    void emit(engines::Observer& observer) override;
    bool needs_next_step() const override;

private:
    /// The snapshot at the current time, if any.
    std::optional<std::size_t> snapshot() const;
    void emit_frame(std::ptrdiff_t number, engines::Observer& observer);
    void emit_displacement(std::size_t snapshot, std::size_t field, engines::Observer& observer);
    View2<const double> plane() const;

    std::ptrdiff_t per_frame_;
    InsideBodies inside_;
    TensorVolumes tensors_;
    ReceptorStress receptors_;
    fft::AlignedVector<double> plane_;
    // At the start of the step: the snapshot whose tensors, and the frame whose stress is saved.
    std::optional<std::size_t> saved_snapshot_;
    std::optional<std::ptrdiff_t> saved_frame_;
};

Output::Output(StepState& state, std::ptrdiff_t per_frame)
    : OutputStage(state), per_frame_(per_frame), inside_(s_.c, s_.slabs.share()),
      tensors_(s_.rigid.layers, s_.mesh, s_.slabs, s_.step_s, s_.team),
      receptors_(s_.rigid.layers, stress_depths_m(s_.c), s_.mesh, s_.slabs, s_.step_s, s_.team) {
    together(s_.team, [&] { plane_.resize(static_cast<std::size_t>(s_.slabs.share().reals)); });
}

std::optional<std::size_t> Output::snapshot() const {
    if (s_.step % per_frame_ != 0) return {};
    return engines::snapshot_at(s_.c, s_.step / per_frame_);
}

void Output::advance() {
    if (tensors_.wanted()) saved_snapshot_ = snapshot();
    if (receptors_.wanted() && s_.step > 0 && s_.step % per_frame_ == 0)
        saved_frame_ = s_.step / per_frame_ - 1;
    if (saved_snapshot_) tensors_.remember(s_);
    if (saved_frame_) receptors_.remember(s_.before.data());
}

std::vector<engines::Allocation> Output::arrays() const {
    return {{"volumes of strain and stress", tensors_.allocated_B()},
            {"stress at receptors", receptors_.allocated_B()}};
}

bool Output::needs_next_step() const {
    return receptors_.wanted() || (tensors_.wanted() && snapshot());
}

void Output::emit(engines::Observer& observer) {
    emit_earlier(observer);
    if (s_.step % per_frame_ == 0) emit_frame(s_.step / per_frame_ - 1, observer);
    const auto& fields = s_.c.record.volume_fields;
    const auto u = std::find(fields.begin(), fields.end(), VolumeField::u);
    if (const auto now = snapshot(); now && u != fields.end())
        emit_displacement(*now, static_cast<std::size_t>(u - fields.begin()), observer);
}

void Output::emit_earlier(engines::Observer& observer) {
    if (saved_snapshot_) tensors_.emit(s_, inside_, *saved_snapshot_, observer);
    if (saved_frame_) receptors_.emit({s_.before.data(), s_.now.data()}, *saved_frame_, observer);
    saved_snapshot_.reset();
    saved_frame_.reset();
}

void Output::emit_frame(std::ptrdiff_t number, engines::Observer& observer) {
    for (std::size_t depth = 0; depth < s_.c.measure.depths_m.size(); ++depth) {
        put_plane(s_, 2, depth_weights(s_.mesh, s_.c.measure.depths_m[depth]), plane_.data());
        s_.slabs.to_physical(plane_.data());
        observer.frame({.number = number, .depth = depth, .u_z_m = plane()});
    }
}

void Output::emit_displacement(std::size_t snapshot, std::size_t field,
                               engines::Observer& observer) {
    for (std::size_t component = 0; component < 3; ++component)
        for (std::size_t level = 0; level < s_.mesh.clear_levels(); ++level) {
            put_plane(s_, component, {static_cast<std::ptrdiff_t>(level), {1.0}}, plane_.data());
            s_.slabs.to_physical(plane_.data());
            inside_.set_displacement(s_.mesh.z_m(level), component, s_.bodies->motions(),
                                     plane_.data());
            observer.volume({.snapshot = snapshot,
                             .field = field,
                             .component = component,
                             .level = level,
                             .values = plane()});
        }
}

View2<const double> Output::plane() const {
    const fft::SlabShare& share = s_.slabs.share();
    return {plane_.data(), share.x_count, s_.c.domain.ny, share.padded_ny};
}

} // namespace

std::unique_ptr<OutputStage> make_output(StepState& state, std::ptrdiff_t per_frame) {
    return std::make_unique<Output>(state, per_frame);
}

void put_plane(const StepState& s, std::size_t component, DepthWeights at, double* plane) {
    while (at.weights.back() == 0.0) // all but one at a node
        at.weights.pop_back();
    const DisplacementKernels& kernels = simd::kernels<DisplacementKernels>();
    const DisplacementDepth depth = {at.first, at.weights.data()};
    const DisplacementArrays arrays = {.nodes = std::ssize(at.weights),
                                       .levels = s.vertical.levels(),
                                       .depths = 1,
                                       .depth = &depth};
    const std::ptrdiff_t stride = 2 * s.vectors.nx();
    fft::AlignedVector<double> lines(static_cast<std::size_t>(3 * stride));
    for (std::ptrdiff_t row = 0; row < s.vectors.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < s.vectors.blocks(); ++block)
            kernels.displacement(arrays, s.vectors.waves(row, block), s.u(s.pencil(row, block)),
                                 lines.data(), stride);
        std::copy_n(lines.data() + static_cast<std::ptrdiff_t>(component) * stride, stride,
                    plane + row * stride);
    }
    s.vectors.clear_nyquist(plane);
}

} // namespace shearwake::spectral
