// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/stepper.hpp"
#include "problem/case/study_data.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace shearwake::kwave {

/// Both corners of a cuboid of sensor nodes, which belong to it; indices from 0.
struct Cuboid {
    pstd::Node first = {}, last = {};
    std::ptrdiff_t count(std::size_t axis) const { return last[axis] - first[axis] + 1; }
};

/// The largest steps of the medium of this rank's nodes, and what they follow from.
struct StepLimits {
    double p_modulus_Pa = 0.0, p_viscosity_Pa_s = 0.0; // the largest lambda + 2 mu, chi + 2 eta
    double density_kg_m3 = 0.0;                        // the smallest
    double alone_s = 0.0;                              // above it the step is unstable at a node
};

/// What a run needs of an input file, of which each rank reads its slab.
struct Input {
    pstd::Setup setup;
    std::ptrdiff_t steps = 0;
    /// The sensor: all points in the order of the output, those of cuboids one after another, each
    /// with x fastest. No cuboids: a list of points.
    SensorPoints sensor;
    std::vector<Cuboid> cuboids;
    /// Scalars that the output file repeats, and the description of the file.
    std::map<std::string, std::uint64_t> integers;
    std::map<std::string, double> numbers;
    std::string description;
    StepLimits limits;
    double soft_nodes = 0.0;                // of this rank, with a negative bulk modulus
    double fluid_faces = 0.0;               // of this rank, between a fluid node and a solid one
    std::size_t source_values = 0;          // stored on every rank
    std::shared_ptr<const StudyData> study; // to which `setup` refers; none for a file of k-Wave
};

/// Reads the elastic input file that k-Wave's pstdElastic3D saves, or the file of a study that
/// scripts/import-kwave writes, for a rank of a team, and validates all of it. Nothing is derived
/// from speeds: densities and moduli of the staggered grid, profiles of the absorbing layer and
/// scaled sources are those of the file. Throws UsageError whose message names the file, the
/// dataset and its error, also before more than available_B are allocated. Not collective.
Input read_input(const std::filesystem::path& path, int ranks, int rank, double available_B);

} // namespace shearwake::kwave
