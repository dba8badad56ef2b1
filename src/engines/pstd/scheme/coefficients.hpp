// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/field_state.hpp"
#include "engines/pstd/scheme/scheme.hpp"

#include <algorithm>

namespace shearwake::pstd {

/// A rank's nodes and the plane after them, asked once.
class KnownNodes {
public:
    KnownNodes(const Slabs& slabs, const MaterialOfNode& material)
        : slabs_(slabs), start_(slabs.x_start()) {
        const std::ptrdiff_t end = std::min(start_ + slabs.x_count() + 1, slabs.nx());
        if (slabs.x_count() > 0)
            nodes_.reserve(static_cast<std::size_t>((end - start_) * slabs.ny() * slabs.nz()));
        for (std::ptrdiff_t x = start_; x < end && slabs.x_count() > 0; ++x)
            for (std::ptrdiff_t y = 0; y < slabs.ny(); ++y)
                for (std::ptrdiff_t z = 0; z < slabs.nz(); ++z)
                    nodes_.push_back(material({x, y, z}));
    }
    const NodeMaterial& operator()(Node n) const {
        return nodes_[static_cast<std::size_t>(
            ((n[0] - start_) * slabs_.ny() + n[1]) * slabs_.nz() + n[2])];
    }
    /// The highest plane of z with nodes that are not empty; the number of planes without any.
    std::ptrdiff_t top() const {
        for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z)
            for (auto at = static_cast<std::size_t>(z); at < nodes_.size();
                 at += static_cast<std::size_t>(slabs_.nz()))
                if (!nodes_[at].empty) return z;
        return slabs_.nz();
    }
    double largest_c_p_m_s() const {
        double largest = 0.0;
        for (const NodeMaterial& m : nodes_)
            largest = std::max(largest, m.c_p_m_s);
        return largest;
    }

private:
    const Slabs& slabs_;
    std::ptrdiff_t start_;
    std::vector<NodeMaterial> nodes_;
};

/// What every scheme makes of a setup at first.
struct Preparation {
    /// `slabs` must outlive this object. Collective.
    Preparation(const Setup& setup, const Slabs& slabs, const Comm& team);
    KnownNodes nodes;
    MaterialOfNode material = [this](Node n) { return nodes(n); };
    double reference_m_s = 0.0; // of the layer
    std::ptrdiff_t top = 0;     // the highest plane of z with nodes that are not empty
    Preparation(const Preparation&) = delete;
    Preparation& operator=(const Preparation&) = delete;
};

/// dt/rho at ux, uy, uz; dt lambda, dt (lambda + 2 mu) at the nodes; dt mu at sxy, sxz, syz.
/// Kelvin-Voigt: chi and chi + 2 eta at the nodes; eta at sxy, sxz, syz.
template <class Real>
struct Coefficients {
    /// Collective.
    Coefficients(const Setup& setup, const Preparation& prepared, const Slabs& slabs,
                 const Comm& team);
    std::array<Coefficient<Real>, 3> dt_over_rho, dt_mu, eta;
    Coefficient<Real> dt_lambda, dt_p_modulus, chi, chi_2eta;
};

/// The number of samples of a source that are copied to a GPU at once, by its number of nodes.
constexpr std::size_t samples_at_once(std::size_t nodes) {
    return std::clamp<std::size_t>((std::size_t{1} << 18) / std::max<std::size_t>(nodes, 1), 1, 64);
}

/// Memory that the scheme needs on a GPU (gpu/device_stepper.hpp), apart from tables of some lines,
/// in bytes: with values of `value_B` bytes, `coefficients` that vary laterally, and sources on
/// `source_nodes` nodes in all. Not collective.
double device_memory_B(const Setup& setup, double value_B, double coefficients,
                       double source_nodes);

/// The nodes of a rank where a field's parts must be kept outside the layer. Not collective.
std::vector<Node> split_nodes(Field field, const Slabs& slabs, const std::vector<Source>& sources);

} // namespace shearwake::pstd
