// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/input.hpp"

#include "base/error.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/study_run.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/input/study_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>
#include <numbers>
#include <optional>

namespace shearwake::kwave {
namespace {

using pstd::Field;
using pstd::Node;
using Shape = std::array<hsize_t, 3>; // (z, y, x)

enum class Kind { real, complex, integer };

/// Sizes above these are not plausible, and products of smaller ones do not overflow.
constexpr std::uint64_t most_points = 1u << 20, most_steps = 1u << 30;
/// Values of a dataset per stored byte: gzip shortens constant data by at most this factor.
constexpr hsize_t most_compression = 1100, always_allowed_B = 64'000'000;

constexpr std::array axes = {"x", "y", "z"};
constexpr std::array planes = {"xy", "xz", "yz"};

std::string text_of(const Shape& shape) {
    return fmt::format("({}, {}, {})", shape[0], shape[1], shape[2]);
}

/// The text of an attribute of fixed or variable length; nothing if it is missing or no text.
std::optional<std::string> text_attribute(hid_t object, const char* name) {
    if (!h5::has_attribute(object, name)) return {};
    const h5::Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open an attribute");
    const h5::Id type(H5Aget_type(attribute.raw()), H5Tclose, "inspect an attribute"),
        space(H5Aget_space(attribute.raw()), H5Sclose, "inspect an attribute");
    if (H5Tget_class(type.raw()) != H5T_STRING || H5Sget_simple_extent_npoints(space.raw()) != 1)
        return {};
    if (H5Tis_variable_str(type.raw()) <= 0) return h5::text_attribute(object, name);
    char* text = nullptr;
    h5::check(H5Aread(attribute.raw(), type.raw(), &text), "read an attribute");
    std::string copy = text ? text : "";
    H5free_memory(text);
    return copy;
}

/// Values of every node of a slab of x, or one for all.
struct NodeValues {
    std::vector<float> values;
    std::ptrdiff_t x0 = 0, nx = 0, ny = 0;
    double operator()(Node n) const {
        const std::ptrdiff_t at = values.size() == 1 ? 0 : (n[2] * ny + n[1]) * nx + n[0] - x0;
        return static_cast<double>(values[static_cast<std::size_t>(at)]);
    }
};

/// The material of a slab, to which the functions of Setup refer.
struct Material {
    NodeValues lambda, mu, chi, eta;
    std::array<NodeValues, 3> rho, mu_sg, eta_sg;
    std::ptrdiff_t x0 = 0, x1 = 0;
    bool lossy = false;
};

class Reader {
public:
    Reader(hid_t file, int ranks, int rank) : file_(file), ranks_(ranks), rank_(rank) {}
    Input input();

private:
    bool has(const std::string& name) const {
        return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
    }
    h5::Id open(const std::string& name, Kind kind) const;
    h5::Id open(const std::string& name, Kind kind, const Shape& expected) const;
    static Shape shape_of(const h5::Id& dataset, const std::string& name);
    std::vector<float> reals(const std::string& name, const Shape& shape,
                             Kind kind = Kind::real) const;
    std::uint64_t integer(const std::string& name);
    std::uint64_t flag(const std::string& name, std::uint64_t most);
    double number(const std::string& name, bool positive);
    std::vector<std::ptrdiff_t> indices(const std::string& name) const;
    Node node_of(std::ptrdiff_t index) const;

    void check_kind();
    void read_grid();
    void check_operators() const;
    NodeValues field(const std::string& name) const;
    void read_material();
    void read_layer();
    void read_sources(const std::string& letter, std::span<const Field> fields);
    void read_sensor();

    hid_t file_;
    int ranks_, rank_;
    Input input_;
    std::array<hsize_t, 3> n_ = {}; // along x, y, z
    pstd::Slabs slabs_;
};

// ---- datasets

h5::Id Reader::open(const std::string& name, Kind kind) const {
    if (!has(name)) throw UsageError(fmt::format("the dataset {} is missing", name));
    h5::Id dataset = h5::open_dataset(file_, name);
    const h5::Id type(H5Dget_type(dataset.raw()), H5Tclose, "inspect " + name);
    const bool integers = kind == Kind::integer;
    const std::size_t size = H5Tget_size(type.raw());
    if (H5Tget_class(type.raw()) != (integers ? H5T_INTEGER : H5T_FLOAT) ||
        size != (integers ? 8 : 4) || (integers && H5Tget_sign(type.raw()) != H5T_SGN_NONE))
        throw UsageError(fmt::format("{} must contain {} numbers, but contains others of {} bytes",
                                     name,
                                     integers ? "unsigned integers of 64 bits as"
                                              : "floating-point numbers of "
                                                "32 bits as",
                                     size));
    const std::string data = integers ? "long" : "float",
                      domain = kind == Kind::complex ? "complex" : "real";
    const auto found_data = text_attribute(dataset.raw(), "data_type"),
               found_domain = text_attribute(dataset.raw(), "domain_type");
    if (found_data != data || found_domain != domain)
        throw UsageError(fmt::format("{} has the attributes data_type \"{}\" and domain_type "
                                     "\"{}\"; they must be \"{}\" and \"{}\"",
                                     name, found_data.value_or(""), found_domain.value_or(""), data,
                                     domain));
    return dataset;
}

Shape Reader::shape_of(const h5::Id& dataset, const std::string& name) {
    const std::vector<hsize_t> found = h5::shape(dataset);
    if (found.size() != 3)
        throw UsageError(fmt::format("{} has {} dimensions; it must have 3", name, found.size()));
    return {found[0], found[1], found[2]};
}

h5::Id Reader::open(const std::string& name, Kind kind, const Shape& expected) const {
    h5::Id dataset = open(name, kind);
    const Shape shape = shape_of(dataset, name);
    if (shape != expected)
        throw UsageError(fmt::format("{} has the shape {}, but {} is expected", name,
                                     text_of(shape), text_of(expected)));
    hsize_t values = 1;
    for (const hsize_t extent : shape)
        values *= extent;
    const hsize_t stored_B = H5Dget_storage_size(dataset.raw());
    if (4 * values > std::max(always_allowed_B, most_compression * stored_B))
        throw UsageError(
            fmt::format("{} declares {} values, but stores only {} bytes", name, values, stored_B));
    return dataset;
}

void must_be_finite(const std::string& name, std::span<const float> values, const Shape& shape,
                    std::ptrdiff_t x0 = 0) {
    const auto bad = std::find_if(values.begin(), values.end(),
                                  [](float value) { return !std::isfinite(value); });
    if (bad == values.end()) return;
    const auto at = static_cast<hsize_t>(bad - values.begin());
    throw UsageError(fmt::format("{} contains {} at index ({}, {}, {})", name, *bad,
                                 at % shape[2] + static_cast<hsize_t>(x0) + 1,
                                 at / shape[2] % shape[1] + 1, at / shape[2] / shape[1] + 1));
}

std::vector<float> Reader::reals(const std::string& name, const Shape& shape, Kind kind) const {
    const h5::Id dataset = open(name, kind, shape);
    std::vector<float> values(static_cast<std::size_t>(shape[0] * shape[1] * shape[2]));
    h5::check(
        H5Dread(dataset.raw(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "read " + name);
    must_be_finite(name, values, shape);
    return values;
}

std::uint64_t Reader::integer(const std::string& name) {
    const h5::Id dataset = open(name, Kind::integer, {1, 1, 1});
    std::uint64_t value = 0;
    h5::check(H5Dread(dataset.raw(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value),
              "read " + name);
    return input_.integers[name] = value;
}

std::uint64_t Reader::flag(const std::string& name, std::uint64_t most) {
    const std::uint64_t value = integer(name);
    if (value > most)
        throw UsageError(fmt::format("{} is {}; it must be at most {}", name, value, most));
    return value;
}

double Reader::number(const std::string& name, bool positive) {
    const double value = static_cast<double>(reals(name, {1, 1, 1})[0]);
    if (value < 0.0 || (positive && value == 0.0))
        throw UsageError(fmt::format("{} is {}; it must be {}", name, value,
                                     positive ? "positive" : "0 or more"));
    return input_.numbers[name] = value;
}

/// Indices of nodes, from 0.
std::vector<std::ptrdiff_t> Reader::indices(const std::string& name) const {
    const hsize_t count = shape_of(open(name, Kind::integer), name)[2];
    if (count > n_[0] * n_[1] * n_[2])
        throw UsageError(fmt::format("{} has {} nodes, more than the grid", name, count));
    const h5::Id dataset = open(name, Kind::integer, {1, 1, count});
    std::vector<std::uint64_t> values(count);
    if (count > 0)
        h5::check(
            H5Dread(dataset.raw(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "read " + name);
    std::vector<std::ptrdiff_t> result;
    for (const std::uint64_t value : values) {
        if (value < 1 || value > n_[0] * n_[1] * n_[2])
            throw UsageError(fmt::format("{} contains {}; indices must be 1 to {}, the number of "
                                         "nodes",
                                         name, value, n_[0] * n_[1] * n_[2]));
        result.push_back(static_cast<std::ptrdiff_t>(value) - 1);
    }
    return result;
}

Node Reader::node_of(std::ptrdiff_t index) const {
    const auto nx = static_cast<std::ptrdiff_t>(n_[0]), ny = static_cast<std::ptrdiff_t>(n_[1]);
    return {index % nx, index / nx % ny, index / nx / ny};
}

// ---- the kind of file, and the grid

void Reader::check_kind() {
    const auto attribute = [&](const char* name) {
        return text_attribute(file_, name).value_or("");
    };
    if (const std::string type = attribute("file_type"); type != "input")
        throw UsageError(fmt::format("it is not an input file of k-Wave: its attribute file_type "
                                     "is \"{}\", not \"input\"",
                                     type));
    const std::string major = attribute("major_version"), minor = attribute("minor_version");
    if (major != "1" || (minor != "0" && minor != "1" && minor != "2"))
        throw UsageError(fmt::format("it has version {}.{} of the format of k-Wave; versions 1.0 "
                                     "to 1.2 are supported",
                                     major, minor));
    input_.description = attribute("file_description");
    if (!has("elastic_flag") || integer("elastic_flag") != 1)
        throw UsageError(
            "elastic_flag is not 1: it is an acoustic file, which kspaceFirstOrder-OMP "
            "of k-Wave runs");
    constexpr std::pair<const char*, const char*> without[] = {
        {"nonlinear_flag", "a nonlinear medium"},
        {"nonuniform_grid_flag", "a nonuniform grid"},
        {"axisymmetric_flag", "axial symmetry"},
        {"transducer_source_flag", "a transducer"},
        {"p_source_flag", "a pressure source or time reversal"}};
    for (const auto& [name, what] : without)
        if (integer(name) != 0)
            throw UsageError(fmt::format("{} is {}: the elastic scheme does not support {}", name,
                                         input_.integers[name], what));
}

void Reader::read_grid() {
    auto& grid = input_.setup.grid;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string name = fmt::format("N{}", axes[a]);
        n_[a] = integer(name);
        if (n_[a] < 2 || n_[a] > most_points)
            throw UsageError(fmt::format("{} is {}; it must be 2 to {}{}", name, n_[a], most_points,
                                         a == 2 && n_[a] == 1 ? ": elastic files are "
                                                                "three-dimensional"
                                                              : ""));
        grid.points[a] = static_cast<std::ptrdiff_t>(n_[a]);
        grid.spacing_m[a] = number(fmt::format("d{}", axes[a]), true);
    }
    grid.dt_s = number("dt", true);
    const std::uint64_t steps = integer("Nt");
    if (steps < 1 || steps > most_steps)
        throw UsageError(fmt::format("Nt is {}; it must be 1 to {}", steps, most_steps));
    input_.steps = static_cast<std::ptrdiff_t>(steps);
    number("c_ref", true);
    slabs_ = pstd::slabs_of(grid, ranks_, rank_);
}

/// The differences between the operators of the file and those of the scheme must be rounding
/// errors: 1e-5 of the largest value, where numbers of 32 bits have 6e-8.
void Reader::check_operators() const {
    const auto check = [&](const std::string& name, std::size_t axis, hsize_t count,
                           double half_cells, bool derivative) {
        Shape shape = {1, 1, 1};
        shape[2 - axis] = 2 * count;
        const std::vector<float> found = reals(name, shape, Kind::complex);
        const auto n = static_cast<double>(n_[axis]);
        const double d_m = input_.setup.grid.spacing_m[axis],
                     largest = derivative ? std::numbers::pi / d_m : 1.0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto m = static_cast<double>(i);
            const double k = 2.0 * std::numbers::pi / (n * d_m) * (2.0 * m < n ? m : m - n);
            const std::complex<double> shift = std::polar(1.0, half_cells * k * d_m / 2.0),
                                       expected = derivative ? std::complex(0.0, k) * shift : shift,
                                       value(static_cast<double>(found[2 * i]),
                                             static_cast<double>(found[2 * i + 1]));
            // At the Nyquist frequency of a half spectrum the sign of k is a convention.
            const bool nyquist = 2.0 * m == n;
            if (std::min(std::abs(value - expected),
                         nyquist ? std::abs(value - std::conj(expected)) : 1e300) > 1e-5 * largest)
                throw UsageError(fmt::format(
                    "{} differs from the operator of a grid that is staggered by half a cell: the "
                    "file was saved with 'UseSG' false, or dx, dy, dz have been changed",
                    name));
        }
    };
    for (std::size_t a = 0; a < 3; ++a) {
        const hsize_t half = n_[a] / 2 + 1, count = a == 0 ? half : n_[a];
        const char* end = a == 0 ? "_r" : "";
        check(fmt::format("dd{}_k_shift_pos{}", axes[a], end), a, count, 1.0, true);
        check(fmt::format("dd{}_k_shift_neg{}", axes[a], end), a, count, -1.0, true);
        check(fmt::format("{}_shift_neg_r", axes[a]), a, half, -1.0, false);
    }
}

// ---- medium and absorbing layer

/// One value, or this rank's planes and the next one.
NodeValues Reader::field(const std::string& name) const {
    const Shape one = {1, 1, 1}, all = {n_[2], n_[1], n_[0]};
    if (const h5::Id dataset = open(name, Kind::real); shape_of(dataset, name) == one)
        return {.values = reals(name, one)};
    const h5::Id dataset = open(name, Kind::real, all);
    const std::ptrdiff_t x0 = slabs_.x_start();
    const hsize_t start[3] = {0, 0, static_cast<hsize_t>(x0)};
    const Shape count = {n_[2], n_[1],
                         slabs_.x_count() == 0 ? 0
                                               : static_cast<hsize_t>(std::min(slabs_.x_count() + 1,
                                                                               slabs_.nx() - x0))};
    NodeValues field{.values = std::vector<float>(count[0] * count[1] * count[2]),
                     .x0 = x0,
                     .nx = static_cast<std::ptrdiff_t>(count[2]),
                     .ny = slabs_.ny()};
    if (field.values.empty()) return field;
    const h5::Id in_file(H5Dget_space(dataset.raw()), H5Sclose, "find a dataspace"),
        memory(H5Screate_simple(3, count.data(), nullptr), H5Sclose, "create a dataspace");
    h5::check(
        H5Sselect_hyperslab(in_file.raw(), H5S_SELECT_SET, start, nullptr, count.data(), nullptr),
        "select a block");
    h5::check(H5Dread(dataset.raw(), H5T_NATIVE_FLOAT, memory.raw(), in_file.raw(), H5P_DEFAULT,
                      field.values.data()),
              "read " + name);
    must_be_finite(name, field.values, count, x0);
    return field;
}

void check_values(const std::string& name, const NodeValues& field, const char* must,
                  const auto& is_valid) {
    const auto bad = std::find_if_not(field.values.begin(), field.values.end(), is_valid);
    if (bad == field.values.end()) return;
    const auto at = static_cast<std::ptrdiff_t>(bad - field.values.begin());
    const std::string where =
        field.values.size() == 1
            ? std::string()
            : fmt::format(" at index ({}, {}, {})", at % field.nx + field.x0 + 1,
                          at / field.nx % field.ny + 1, at / field.nx / field.ny + 1);
    throw UsageError(fmt::format("{} is {}{}; it must be {}", name, *bad, where, must));
}

void Reader::read_material() {
    auto material = std::make_shared<Material>();
    Material& m = *material;
    m.lossy = flag("absorbing_flag", 1) == 1;
    m.x0 = slabs_.x_start();
    m.x1 = std::min(m.x0 + slabs_.x_count() + 1, slabs_.nx());
    const auto positive = [](float value) { return value > 0.0f; };
    const auto not_negative = [](float value) { return value >= 0.0f; };
    const auto moduli = [&](const std::string& name) {
        NodeValues values = field(name);
        check_values(name, values, "0 or more", not_negative);
        return values;
    };
    m.lambda = field("lambda");
    m.mu = moduli("mu");
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string name = fmt::format("rho0_sg{}", axes[i]);
        m.rho[i] = field(name);
        check_values(name, m.rho[i], "positive", positive);
        m.mu_sg[i] = moduli(fmt::format("mu_sg{}", planes[i]));
    }
    if (m.lossy) {
        m.chi = field("chi");
        m.eta = moduli("eta");
        for (std::size_t i = 0; i < 3; ++i)
            m.eta_sg[i] = moduli(fmt::format("eta_sg{}", planes[i]));
    }
    auto& setup = input_.setup;
    setup.absorption = m.lossy ? pstd::Absorption::kelvin_voigt : pstd::Absorption::none;
    setup.material = [material](Node n) {
        const Material& of = *material;
        if (n[0] < of.x0 || n[0] >= of.x1) return pstd::NodeMaterial{}; // of another rank
        const double rho = of.rho[0](n), mu = of.mu(n);
        return pstd::NodeMaterial{.density_kg_m3 = rho,
                                  .c_p_m_s = std::sqrt((of.lambda(n) + 2.0 * mu) / rho),
                                  .c_s_m_s = std::sqrt(mu / rho),
                                  .chi_Pa_s = of.lossy ? of.chi(n) : 0.0,
                                  .eta_Pa_s = of.lossy ? of.eta(n) : 0.0};
    };
    pstd::StaggeredMaterial& staggered = setup.staggered.emplace();
    for (std::size_t i = 0; i < 3; ++i) {
        staggered.density_kg_m3[i] = [=](Node n) { return material->rho[i](n); };
        staggered.mu_Pa[i] = [=](Node n) { return material->mu_sg[i](n); };
        staggered.eta_Pa_s[i] = [=](Node n) { return material->eta_sg[i](n); };
    }
    if (m.mu.values.size() > 1)
        for (std::ptrdiff_t x = m.x0; x < m.x0 + slabs_.x_count(); ++x)
            for (std::ptrdiff_t y = 0; y < slabs_.ny(); ++y)
                for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z)
                    for (const Node next :
                         {Node{x + 1, y, z}, Node{x, y + 1, z}, Node{x, y, z + 1}})
                        if (next[0] < slabs_.nx() && next[1] < slabs_.ny() &&
                            next[2] < slabs_.nz() &&
                            (m.mu({x, y, z}) == 0.0) != (m.mu(next) == 0.0))
                            input_.fluid_faces += 1.0;
    // The step is certainly unstable above the limit of a node with the largest of its densities.
    StepLimits& limits = input_.limits;
    limits.alone_s = limits.density_kg_m3 = std::numeric_limits<double>::infinity();
    const double spacing_m = pstd::cubic_spacing_m(setup.grid);
    pstd::NodeMaterial last; // most neighbours are equal
    double last_density = 0.0;
    for (std::ptrdiff_t x = m.x0; x < m.x0 + slabs_.x_count(); ++x)
        for (std::ptrdiff_t y = 0; y < slabs_.ny(); ++y)
            for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z) {
                const Node n{x, y, z};
                const pstd::NodeMaterial here = setup.material(n);
                const auto [low, high] = std::minmax({m.rho[0](n), m.rho[1](n), m.rho[2](n)});
                if (here == last && high == last_density) continue;
                last = here;
                last_density = high;
                const double modulus = m.lambda(n) + 2.0 * m.mu(n);
                if (!(modulus > 0.0))
                    throw UsageError(fmt::format("lambda + 2 mu is {} at index ({}, {}, {}); it "
                                                 "must be positive",
                                                 modulus, x + 1, y + 1, z + 1));
                const pstd::NodeMaterial heaviest{high, std::sqrt(modulus / high),
                                                  std::sqrt(m.mu(n) / high), here.chi_Pa_s,
                                                  here.eta_Pa_s};
                limits.alone_s =
                    std::min(limits.alone_s, pstd::largest_step_s(heaviest, spacing_m));
                limits.density_kg_m3 = std::min(limits.density_kg_m3, low);
                limits.p_modulus_Pa = std::max(limits.p_modulus_Pa, modulus);
                limits.p_viscosity_Pa_s =
                    std::max(limits.p_viscosity_Pa_s, here.chi_Pa_s + 2.0 * here.eta_Pa_s);
            }
}

void Reader::read_layer() {
    auto& pml = input_.setup.pml;
    pml.reference_speed_m_s = input_.numbers["c_ref"];
    for (std::size_t a = 0; a < 3; ++a) {
        const char* axis = axes[a];
        const std::string size = fmt::format("pml_{}_size", axis);
        pml.points[a] = static_cast<std::ptrdiff_t>(flag(size, n_[a] / 2));
        pml.strength_1[a] = number(fmt::format("pml_{}_alpha", axis), false);
        Shape shape = {1, 1, 1};
        shape[2 - a] = n_[a];
        const auto profile = [&](const std::string& name) {
            const std::vector<float> found = reals(name, shape);
            for (std::size_t i = 0; i < found.size(); ++i)
                if (found[i] < 0.0f || found[i] > 1.0f)
                    throw UsageError(fmt::format("{} is {} at index {}; factors of the absorbing "
                                                 "layer must be 0 to 1",
                                                 name, found[i], i + 1));
            return std::vector<double>(found.begin(), found.end());
        };
        const std::string half = fmt::format("{0}_sg{0}", axis);
        pml.given[a] = {pstd::PmlProfile{profile(fmt::format("pml_{}", axis)),
                                         profile(fmt::format("mpml_{}", axis))},
                        pstd::PmlProfile{profile("pml_" + half), profile("mpml_" + half)}};
    }
}

// ---- sources and sensor

void Reader::read_sources(const std::string& letter, std::span<const Field> fields) {
    std::vector<std::uint64_t> samples;
    for (const Field field : fields)
        samples.push_back(
            flag(fmt::format("{}_source_flag", grid_fields[index_of(field)]), most_steps));
    if (std::all_of(samples.begin(), samples.end(), [](auto n) { return n == 0; })) return;
    const bool dirichlet = flag(letter + "_source_mode", letter == "u" ? 2 : 1) == 0;
    flag(letter + "_source_many", 1);
    const std::string name = letter + "_source_index";
    const std::vector<std::ptrdiff_t> at = indices(name);
    if (at.empty()) throw UsageError(name + " contains no nodes");
    std::vector<std::ptrdiff_t> sorted = at;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
        throw UsageError(fmt::format("{} contains {} more than once", name, *twice + 1));
    std::vector<Node> nodes;
    for (const std::ptrdiff_t index : at)
        nodes.push_back(node_of(index));
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (samples[i] == 0) continue;
        const std::string input = fmt::format("{}_source_input", grid_fields[index_of(fields[i])]);
        const hsize_t rows = shape_of(open(input, Kind::real), input)[2];
        if (rows != 1 && rows != at.size())
            throw UsageError(fmt::format("{} has {} series for {} source nodes; there must be one, "
                                         "or one per node: the mask was labelled, and the file "
                                         "does not contain the labels",
                                         input, rows, at.size()));
        auto values =
            std::make_shared<const std::vector<float>>(reals(input, {1, samples[i], rows}));
        input_.source_values += values->size();
        pstd::Source source{.field = fields[i],
                            .mode = dirichlet ? pstd::SourceMode::dirichlet
                                              : pstd::SourceMode::additive,
                            .scaling = pstd::SourceScaling::none,
                            .nodes = nodes,
                            .samples = static_cast<std::ptrdiff_t>(samples[i])};
        // Dirichlet stresses: the file has one third of the value, which each part is set to. The
        // other stresses and PlacedSource divide by three as well.
        const double scale = is_velocity(fields[i]) ? 1.0 : 3.0;
        source.values = [values, rows, scale](std::ptrdiff_t sample,
                                              std::span<const std::size_t> which,
                                              std::span<double> out) {
            const float* row = values->data() + static_cast<std::size_t>(sample) * rows;
            for (std::size_t n = 0; n < which.size(); ++n)
                out[n] = scale * static_cast<double>(row[rows == 1 ? 0 : which[n]]);
        };
        input_.setup.sources.push_back(std::move(source));
    }
}

void Reader::read_sensor() {
    if (flag("sensor_mask_type", 1) == 0) {
        for (const std::ptrdiff_t index : indices("sensor_mask_index"))
            input_.sensor.nodes.push_back(node_of(index));
        if (input_.sensor.nodes.empty()) throw UsageError("sensor_mask_index contains no nodes");
        return;
    }
    const std::string name = "sensor_mask_corners";
    const hsize_t count = shape_of(open(name, Kind::integer), name)[1];
    if (count < 1 || count > 1'000'000)
        throw UsageError(fmt::format("{} has {} cuboids; it must have 1 to 1000000", name, count));
    const h5::Id dataset = open(name, Kind::integer, {1, count, 6});
    std::vector<std::uint64_t> corners(6 * count);
    h5::check(
        H5Dread(dataset.raw(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, corners.data()),
        "read " + name);
    double nodes = 0.0;
    for (std::size_t c = 0; c < count; ++c) {
        Cuboid cuboid;
        double of_cuboid = 1.0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t first = corners[6 * c + a], last = corners[6 * c + 3 + a];
            if (first < 1 || last < first || last > n_[a])
                throw UsageError(fmt::format(
                    "{}: cuboid {} has the corners {} and {} along {}; they must be ordered and 1 "
                    "to {}",
                    name, c + 1, first, last, axes[a], n_[a]));
            cuboid.first[a] = static_cast<std::ptrdiff_t>(first) - 1;
            cuboid.last[a] = static_cast<std::ptrdiff_t>(last) - 1;
            of_cuboid *= static_cast<double>(cuboid.count(a));
        }
        nodes += of_cuboid;
        if (nodes > 1e9) throw UsageError(name + " has more than 1e9 nodes");
        input_.cuboids.push_back(cuboid);
        for (std::ptrdiff_t z = cuboid.first[2]; z <= cuboid.last[2]; ++z)
            for (std::ptrdiff_t y = cuboid.first[1]; y <= cuboid.last[1]; ++y)
                for (std::ptrdiff_t x = cuboid.first[0]; x <= cuboid.last[0]; ++x)
                    input_.sensor.nodes.push_back({x, y, z});
    }
}

Input Reader::input() {
    check_kind();
    read_grid();
    read_layer();
    check_operators();
    read_material();
    constexpr Field velocities[] = {Field::ux, Field::uy, Field::uz},
                    stresses[] = {Field::sxx, Field::syy, Field::szz,
                                  Field::sxy, Field::sxz, Field::syz};
    read_sources("u", velocities);
    read_sources("s", stresses);
    // The samples of sxx, syy and szz contain p0 already.
    if (flag("p0_source_flag", 1) == 1) open("p0_source_input", Kind::real, {n_[2], n_[1], n_[0]});
    read_sensor();
    return std::move(input_);
}

// ---- studies

Input input_of_study(const std::filesystem::path& path) {
    Input input;
    auto study = std::make_shared<StudyData>(storage::read_study_file(path));
    for (const Remark& remark : pstd::study_step_remarks(*study))
        if (remark.severity == Severity::error)
            throw UsageError(fmt::format("{}: the study {}", path.string(), remark.message));
    input.setup = pstd::study_setup(*study);
    input.steps = study->steps;
    input.sensor = study->sensor;
    for (const NodeSource& source : study->sources)
        input.source_values += 2 * source.series.size();
    input.description = "grid study " + study->content_hash;
    const auto& grid = input.setup.grid;
    input.numbers = {{"dt", grid.dt_s}, {"c_ref", study->layer_speed_m_s}};
    input.integers = {{"Nt", static_cast<std::uint64_t>(input.steps)},
                      {"elastic_flag", 1},
                      {"axisymmetric_flag", 0},
                      {"absorbing_flag", study->lossy() ? 1 : 0}};
    for (std::size_t a = 0; a < 3; ++a) {
        input.integers[fmt::format("N{}", axes[a])] = static_cast<std::uint64_t>(grid.points[a]);
        input.integers[fmt::format("pml_{}_size", axes[a])] =
            static_cast<std::uint64_t>(study->layer_points[a]);
        input.numbers[fmt::format("d{}", axes[a])] = grid.spacing_m[a];
        input.numbers[fmt::format("pml_{}_alpha", axes[a])] = study->layer_strength[a];
    }
    input.limits.alone_s = std::numeric_limits<double>::infinity(); // checked above
    input.study = std::move(study);
    return input;
}

} // namespace

Input read_input(const std::filesystem::path& path, int ranks, int rank) {
    bool is_study = false;
    Input input = storage::read_user_file(path, [&](hid_t file) {
        is_study = text_attribute(file, "schema").value_or("").starts_with("shearwake grid study");
        return is_study ? Input{} : Reader(file, ranks, rank).input();
    });
    return is_study ? input_of_study(path) : input;
}

} // namespace shearwake::kwave
