// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kwave/input.hpp"
#include "storage/hdf5/h5.hpp"

#include <optional>
#include <span>

namespace shearwake::kwave {

using Shape = std::array<hsize_t, 3>; // (z, y, x)

enum class Kind { real, complex, integer };

constexpr std::array axes = {"x", "y", "z"};
constexpr std::array planes = {"xy", "xz", "yz"};

/// The text of an attribute of fixed or variable length; nothing if it is missing or is not a text.
std::optional<std::string> text_attribute(hid_t object, const char* name);

/// Values of every node of a slab of x, or one for all.
struct NodeValues {
    std::vector<float> values;
    std::ptrdiff_t x0 = 0, nx = 0, ny = 0;
    double operator()(pstd::Node n) const {
        const std::ptrdiff_t at = values.size() == 1 ? 0 : (n[2] * ny + n[1]) * nx + n[0] - x0;
        return static_cast<double>(values[static_cast<std::size_t>(at)]);
    }
};

/// Reads an elastic input file of k-Wave for a rank of a team: datasets.cpp reads and checks single
/// datasets, material.cpp the medium, and input.cpp the rest. No function is collective.
class Reader {
public:
    Reader(hid_t file, int ranks, int rank, double available_B)
        : file_(file), ranks_(ranks), rank_(rank), available_B_(available_B) {}
    Input input();

private:
    bool has(const std::string& name) const {
        return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
    }
    h5::Id open(const std::string& name, Kind kind) const;
    h5::Id open(const std::string& name, Kind kind, const Shape& expected) const;
    /// Throws if these bytes and those before exceed the available memory.
    void require_memory(const std::string& name, double bytes) const;
    static Shape shape_of(const h5::Id& dataset, const std::string& name);
    std::vector<float> reals(const std::string& name, const Shape& shape,
                             Kind kind = Kind::real) const;
    std::uint64_t integer(const std::string& name);
    std::uint64_t flag(const std::string& name, std::uint64_t most);
    double number(const std::string& name, bool positive);
    std::vector<std::ptrdiff_t> indices(const std::string& name) const;
    pstd::Node node_of(std::ptrdiff_t index) const;

    void check_kind();
    void read_grid();
    void check_operators() const;
    NodeValues field(const std::string& name) const;
    void read_material();
    void read_layer();
    void read_sources(const std::string& letter, std::span<const pstd::Field> fields);
    void read_sensor();

    hid_t file_;
    int ranks_, rank_;
    double available_B_;
    mutable double required_B_ = 0.0;
    Input input_;
    std::array<hsize_t, 3> n_ = {}; // along x, y, z
    pstd::Slabs slabs_;
};

} // namespace shearwake::kwave
