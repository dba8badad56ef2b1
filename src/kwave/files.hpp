// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/pstd/scheme/recorder.hpp"
#include "engines/pstd/scheme/scheme.hpp"
#include "kwave/run.hpp"
#include "parallel/comm.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace shearwake::kwave {

/// Both corners of a cuboid of sensor nodes, which belong to it; indices from 0, along the axes of
/// k-Wave.
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
    pstd::SensorPoints sensor;
    std::vector<Cuboid> cuboids;
    /// Scalars that the output file repeats, and the description of the file.
    std::map<std::string, std::uint64_t> integers;
    std::map<std::string, double> numbers;
    std::string description;
    StepLimits limits;
    double soft_nodes = 0.0;  // of this rank, with a negative bulk modulus
    double fluid_faces = 0.0; // of this rank, between a fluid node and a solid one
};

/// Reads the elastic input file that k-Wave's pstdElastic3D saves for a rank of a team, and
/// validates all of it. A file with Nz = 1, which k-Wave does not write, is a plane of the scheme,
/// without an absorbing layer along z. Nothing is derived from speeds: densities and moduli of the
/// staggered grid, profiles of the absorbing layer and scaled sources are those of the file. Real
/// numbers have 32 bits and the data_type "float", as in k-Wave, or 64 bits and the data_type
/// "double", as scripts/import-kwave writes them. The sensor_mask_type 2, which k-Wave does not
/// have either, adds the dataset sensor_mask_weights, (1, points, n): n nodes of sensor_mask_index
/// make up a point. Throws UsageError whose message names the file, the dataset and its error, also
/// before more than available_B are allocated. Not collective.
Input read_input(const std::filesystem::path& path, int ranks, int rank, double available_B);

/// Throws UsageError if the step is unstable; a warning if it may be unstable, or nothing.
/// Collective.
std::string check_step(const Input& input, const std::string& name, const Comm& world);

using Shape = std::array<hsize_t, 3>; // (z, y, x)

enum class Kind { real, complex, integer };

constexpr std::array axes = {"x", "y", "z"};
constexpr std::array planes = {"xy", "xz", "yz"};

/// Three values along the axes of the scheme, in the order of a dataset of k-Wave.
template <class T>
Shape kwave_shape(const pstd::Grid& grid, const std::array<T, 3>& along) {
    Shape shape = {};
    for (std::size_t a = 0; a < 3; ++a)
        shape[2 - pstd::kwave_axis(grid, a)] = static_cast<hsize_t>(along[a]);
    return shape;
}

/// The text of an attribute of fixed or variable length; nothing if it is missing or is not a text.
std::optional<std::string> text_attribute(hid_t object, const char* name);

/// Real numbers with the width that they have in the file.
struct Reals {
    std::vector<float> narrow; // of 32 bits
    std::vector<double> wide;  // of 64 bits; either is empty
    std::size_t size() const { return narrow.size() + wide.size(); }
    double operator[](std::size_t i) const {
        return wide.empty() ? static_cast<double>(narrow[i]) : wide[i];
    }
    /// The index of the first number for which this is false; size() if there is none.
    std::size_t find_if_not(const auto& is_valid) const {
        std::size_t i = 0;
        while (i < size() && is_valid((*this)[i]))
            ++i;
        return i;
    }
};

/// Values of every node of a slab of x, or one for all.
struct NodeValues {
    Reals values;
    std::ptrdiff_t x0 = 0, nx = 0, ny = 0;
    double operator()(pstd::Node n) const {
        const std::ptrdiff_t at = values.size() == 1 ? 0 : (n[2] * ny + n[1]) * nx + n[0] - x0;
        return values[static_cast<std::size_t>(at)];
    }
};

/// Reads an elastic input file of k-Wave for a rank of a team: datasets.cpp reads and checks single
/// datasets and the medium, and input.cpp the rest. No function is collective.
class Reader {
public:
    Reader(hid_t file, int ranks, int rank, double available_B)
        : file_(file), ranks_(ranks), rank_(rank), available_B_(available_B) {}
    Input input();

private:
    enum class Sign { positive, not_negative };
    bool has(const std::string& name) const {
        return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
    }
    h5::Id open(const std::string& name, Kind kind) const;
    h5::Id open(const std::string& name, Kind kind, const Shape& expected) const;
    /// Throws if these bytes and those before exceed the available memory.
    void require_memory(const std::string& name, double bytes) const;
    static Shape shape_of(const h5::Id& dataset, const std::string& name);
    Reals reals(const std::string& name, const Shape& shape, Kind kind = Kind::real) const;
    std::uint64_t integer(const std::string& name);
    std::uint64_t flag(const std::string& name, std::uint64_t most);
    double number(const std::string& name, Sign sign = Sign::positive);
    std::vector<std::ptrdiff_t> indices(const std::string& name, hsize_t most) const;
    hsize_t node_count() const { return n_[0] * n_[1] * n_[2]; }
    std::size_t kwave_axis(std::size_t axis) const {
        return pstd::kwave_axis(input_.setup.grid, axis);
    }
    const char* axis(std::size_t scheme_axis) const { return axes[kwave_axis(scheme_axis)]; }
    /// Each plane of a shear stress lacks another axis.
    const char* plane(std::size_t scheme_axis) const {
        return planes[2 - kwave_axis(2 - scheme_axis)];
    }
    std::string field_name(pstd::Field field) const {
        const std::size_t f = index_of(field);
        return f < 3   ? std::string("u") + axis(f)
               : f < 6 ? std::string("s") + axis(f - 3) + axis(f - 3)
                       : std::string("s") + plane(f - 6);
    }
    Shape field_shape() const { return kwave_shape(input_.setup.grid, n_); }
    Shape line_shape(std::size_t axis, hsize_t count) const {
        Shape shape = {1, 1, 1};
        shape[2 - kwave_axis(axis)] = count;
        return shape;
    }
    pstd::Node node_of(std::ptrdiff_t index) const;

    void check_kind();
    void read_grid();
    void check_operators() const;
    NodeValues field(const std::string& name) const;
    void read_material();
    void read_layer();
    void read_sources(const std::string& letter, std::span<const pstd::Field> fields);
    void read_sensor();
    void read_cuboids();

    hid_t file_;
    int ranks_, rank_;
    double available_B_;
    mutable double required_B_ = 0.0;
    Input input_;
    std::array<hsize_t, 3> n_ = {}; // along the axes of the scheme
    pstd::Slabs slabs_;
};

/// An output file that rank 0 writes.
struct OutputFile {
    hid_t file = -1;
    bool doubles = false; // real numbers of 64 bits instead of 32
    int gzip_level = 0;
};

/// Times of the phases of a run, for the output file.
struct Phases {
    double loading_s = 0.0, preparing_s = 0.0, stepping_s = 0.0;
    Clock::time_point began = Clock::now(), phase = began;
    double next() {
        const auto now = Clock::now(), from = std::exchange(phase, now);
        return seconds_between(from, now);
    }
};

/// Writes scalars and attributes. Not collective.
void write_facts(const OutputFile& output, const Arguments& arguments, const Input& input,
                 long steps, long done, Phases& phases, int ranks, double memory_B);

/// Writes the records after the last step, in the layout of k-Wave: (1, samples, points) or one
/// dataset per cuboid, (samples, z, y, x); grids as (z, y, x). Collective.
void write_records(const OutputFile& output, const pstd::Recorder& recorder, const Input& input,
                   const Comm& team);

using Locks = std::vector<std::unique_ptr<storage::FileLock>>;
/// Excludes other processes that write these files, and removes what killed ones have left; empty
/// names are ignored. Throws UsageError (usage) if there is another process. Not collective.
Locks lock_files(std::initializer_list<std::filesystem::path> files);

/// A hash of the input file and of everything else that determines the result. Not collective.
std::string identity_of(const Arguments& arguments, long steps);

/// The name of the checkpoint before the last one. Not collective.
std::filesystem::path previous_checkpoint(const std::filesystem::path& checkpoint);

/// The last checkpoint of this owner, or the previous one with a note if the last one is damaged;
/// empty if there is none. Throws UsageError if there are only others. Not collective.
std::filesystem::path usable_checkpoint(const std::filesystem::path& checkpoint,
                                        const storage::CheckpointOwner& owner);

} // namespace shearwake::kwave
