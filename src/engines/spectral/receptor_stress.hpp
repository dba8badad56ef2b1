#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/stepper.hpp"

#include <array>
#include <vector>

namespace shearwake {

/// -sigma_zz at the depths of a case's receptors, a frame at a time: the zz component of what
/// TensorVolumes keeps, but right at these depths. It is linear in the displacement a step before,
/// at and after the frame, so that each wave vector needs sums over the element that holds the
/// depth, and a depth one transform; where the medium varies laterally within that element, one for
/// each of its nodes (lambda div u) and two more (mu, viscosity). Where elements meet: the mean of
/// both.
class ReceptorStress {
public:
    /// Collective. Holds no memory where the case asks for none. Throws CaseFailure on all ranks
    /// together.
    ReceptorStress(const Case& c, const DepthMesh& mesh, const SlabTransform& slabs, double step_s,
                   const Comm& team);

    bool wanted() const { return depths_ > 0; }
    /// Before the step that follows a frame: what that step forgets. Not collective.
    void remember(const Stepper& stepper);
    /// After that step. Collective.
    void give(const Stepper& stepper, std::ptrdiff_t frame, Observer& observer);
    /// How many planes it transforms a frame, as far as the case tells.
    static double planes(const Case& c, const DepthMesh& mesh);

private:
    /// One plane: a sum over the nodes of an element, then times a modulus of each cell.
    struct Part {
        std::size_t depth;
        std::ptrdiff_t first;                       // level of the element
        std::array<std::vector<double>, 3> weights; // a step before the frame, at it, after it:
                                                    // of W at the nodes, then of -k U
        std::vector<double> factors;                // of each cell; none: 1
    };
    void add_parts(std::size_t depth, double depth_m, std::size_t element, double share);
    void add(const Part& part, std::size_t time, Lanes k, const Lanes* pencil, Lanes* value) const;
    /// use(row, block, where its pencil begins, what is kept of it).
    template <class Use>
    void each_pencil(const Part& part, Use use);

    const Case& case_;
    DepthMesh mesh_;
    const SlabTransform& slabs_;
    double step_s_;
    WaveVectors vectors_;
    std::size_t depths_;
    std::ptrdiff_t levels_; // that move
    std::vector<Part> parts_;
    AlignedVector<double> kept_; // what the step before the frame adds, part by part
    AlignedVector<double> plane_, compression_;
};

} // namespace shearwake
