// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/pstd/scheme/material.hpp"
#include "engines/pstd/scheme/pml.hpp"
#include "engines/pstd/scheme/source.hpp"
#include "parallel/comm.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::pstd {

enum class Absorption { none, kelvin_voigt };

struct Setup {
    Grid grid;
    PmlOptions pml;
    MaterialOfNode material; // asked on every rank for its nodes and the next plane of them
    Absorption absorption = Absorption::none;
    std::vector<Source> sources; // put in in this order
    /// In place of the averages of the material of the nodes.
    std::optional<StaggeredMaterial> staggered = std::nullopt;
};

/// What can be observed at every node: a field, or the pressure. The pressure is -(sxx + syy +
/// szz)/3, in a plane -(syy + szz)/2.
using Quantity = std::optional<Field>;
constexpr Quantity pressure_quantity = std::nullopt;

/// The sum, or an extreme, of each value of some planes of z after the steps.
class Tally {
public:
    enum class Kind { sum, max, min };
    struct Of {
        Quantity quantity;
        Kind kind = Kind::sum;
        std::ptrdiff_t first_z = 0, planes = 0;
        double scale = 1.0; // of what is added to a sum
    };
    virtual ~Tally() = default;
    virtual void add() = 0; // after a step; not collective
    /// [x of the slab][y][plane]. Not collective.
    virtual const std::vector<double>& values() const = 0;
    virtual void restore(const std::vector<double>& values) = 0; // not collective
};

/// The nodes of a sensor: those of all ranks, sorted by x, of which `count` from `first` on belong
/// to this one.
struct SensorNodes {
    std::vector<Node> nodes;
    std::size_t first = 0, count = 0;
};

/// Reads fields at the nodes of a sensor.
class Sensor {
public:
    virtual ~Sensor() = default;
    /// The quantities at this rank's nodes. Not collective.
    virtual std::vector<std::vector<double>> values(std::span<const Quantity> quantities) const = 0;
    /// For a velocity, sums of weights[(i - j) mod n] u[j] over the lines along its own axis, where
    /// i is the index of a node: of this rank's nodes, or along x this rank's share of the sums of
    /// all nodes. Not collective.
    virtual std::vector<double> line_sums(Field velocity,
                                          std::span<const double> weights) const = 0;
};

/// The fields of a setup, which advance by steps: on the ranks of a team (stepper.hpp), or on
/// another device (make_scheme.hpp). After step n velocities belong to (n - 1/2) dt and stresses to
/// n dt.
class Scheme {
public:
    virtual ~Scheme() = default;
    /// Another device may still work when this returns. Collective.
    virtual void step() = 0;
    std::ptrdiff_t steps() const { return steps_; } // done so far
    const Slabs& slabs() const { return slabs_; }

    /// A quantity on this rank's slab, [x][y][z]. Not collective.
    virtual std::vector<double> dense(const Quantity& quantity) const = 0;
    /// They refer to the scheme. Not collective.
    virtual std::unique_ptr<Tally> tally(const Tally::Of& tally) const = 0;
    virtual std::unique_ptr<Sensor> sensor(const SensorNodes& nodes) const = 0;

    /// This rank's part of the kinetic energy of the medium and of the work of the sources. Empty
    /// nodes do not contribute. Not collective.
    virtual double kinetic_J() const = 0;
    virtual double work_J() const = 0;

    /// Totals, kept parts and the count of steps ("step"), for any scheme of the same setup on any
    /// number of ranks; the work of the sources is not saved. Names: "step", "ux", "ux_part_0" and
    /// the like. Collective.
    virtual void save(StateWriter& state) const = 0;
    virtual void restore(const StateReader& state) = 0;

    /// The device that computes, and the share of the bandwidth of its copies, measured now, that
    /// steps at this rate use; nothing for the processor. Not collective.
    virtual std::string device_name() const { return ""; }
    virtual double copy_share(double /*steps_per_s*/) const { return 0.0; }

protected:
    explicit Scheme(const Slabs& slabs) : slabs_(slabs) {}
    Slabs slabs_;
    std::ptrdiff_t steps_ = 0;
};

/// Saves and restores a field: its totals with the pitch of the slab, and its kept parts.
/// Collective.
template <class Real>
void save_field(StateWriter& state, Field field, const Slabs& slabs, const Comm& team,
                std::span<const Real> total, const std::array<std::span<const Real>, 2>& parts);
template <class Real>
void restore_field(const StateReader& state, Field field, const Slabs& slabs, const Comm& team,
                   std::span<Real> total, const std::array<std::span<Real>, 2>& parts);

} // namespace shearwake::pstd
