// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"

#include "engines/pstd/scene/case_step.hpp"
#include "kwave/files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <hdf5.h>

namespace shearwake::kwave {
namespace {

std::string text_of(const Shape& shape) {
    return fmt::format("({}, {}, {})", shape[0], shape[1], shape[2]);
}

/// The size of a number in bytes.
std::size_t width_of(const h5::Id& dataset) {
    const h5::Id type(H5Dget_type(dataset.raw()), H5Tclose, "inspect a dataset");
    return H5Tget_size(type.raw());
}

/// All values of a dataset, or those that the dataspaces select.
Reals read_reals(const h5::Id& dataset, const std::string& name, std::size_t count,
                 hid_t memory = H5S_ALL, hid_t in_file = H5S_ALL) {
    Reals values;
    const bool is_wide = width_of(dataset) == sizeof(double);
    if (is_wide)
        values.wide.resize(count);
    else
        values.narrow.resize(count);
    void* const to = is_wide ? static_cast<void*>(values.wide.data()) : values.narrow.data();
    h5::check(H5Dread(dataset.raw(), is_wide ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT, memory,
                      in_file, H5P_DEFAULT, to),
              "read " + name);
    return values;
}

void check_finite(const std::string& name, const Reals& values, const Shape& shape,
                  std::ptrdiff_t x0 = 0) {
    const std::size_t at = values.find_if_not([](double value) { return std::isfinite(value); });
    if (at == values.size()) return;
    throw UsageError(fmt::format("{} contains {} at index ({}, {}, {})", name, values[at],
                                 at % shape[2] + static_cast<hsize_t>(x0) + 1,
                                 at / shape[2] % shape[1] + 1, at / shape[2] / shape[1] + 1));
}

} // namespace

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

h5::Id Reader::open(const std::string& name, Kind kind) const {
    if (!has(name)) throw UsageError(fmt::format("the dataset {} is missing", name));
    h5::Id dataset = h5::open_dataset(file_, name);
    const h5::Id type(H5Dget_type(dataset.raw()), H5Tclose, "inspect " + name);
    const bool integers = kind == Kind::integer;
    const std::size_t size = H5Tget_size(type.raw());
    if (H5Tget_class(type.raw()) != (integers ? H5T_INTEGER : H5T_FLOAT) ||
        (size != 8 && (integers || size != 4)) ||
        (integers && H5Tget_sign(type.raw()) != H5T_SGN_NONE))
        throw UsageError(fmt::format(
            "{} must contain {}, but contains other values of {} bytes", name,
            integers ? "unsigned integers of 64 bits" : "floating-point numbers of 32 or 64 bits",
            size));
    const std::string data = integers    ? "long"
                             : size == 8 ? "double"
                                         : "float",
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
    const bool is_field = shape == field_shape();
    require_memory(name,
                   static_cast<double>(width_of(dataset) * values) /
                       (is_field ? std::min<double>(ranks_, static_cast<double>(n_[0])) : 1.0));
    return dataset;
}

void Reader::require_memory(const std::string& name, double bytes) const {
    required_B_ += bytes;
    if (required_B_ > available_B_)
        throw UsageError(fmt::format("{} and what precedes it need {:.3g} GB of memory, but only "
                                     "{:.3g} GB are available",
                                     name, 1e-9 * required_B_, 1e-9 * available_B_));
}

Reals Reader::reals(const std::string& name, const Shape& shape, Kind kind) const {
    Reals values = read_reals(open(name, kind, shape), name, shape[0] * shape[1] * shape[2]);
    check_finite(name, values, shape);
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

double Reader::number(const std::string& name, Sign sign) {
    const double value = reals(name, {1, 1, 1})[0];
    if (value < 0.0 || (sign == Sign::positive && value == 0.0))
        throw UsageError(fmt::format("{} is {:.7g}; it must be {}", name, value,
                                     sign == Sign::positive ? "positive" : "0 or more"));
    return input_.numbers[name] = value;
}

/// Indices of nodes, from 0.
std::vector<std::ptrdiff_t> Reader::indices(const std::string& name, hsize_t most) const {
    const hsize_t count = shape_of(open(name, Kind::integer), name)[2];
    if (count > most)
        throw UsageError(
            fmt::format("{} has {} nodes; it must have at most {}", name, count, most));
    const h5::Id dataset = open(name, Kind::integer, {1, 1, count});
    std::vector<std::uint64_t> values(count);
    if (count > 0)
        h5::check(
            H5Dread(dataset.raw(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "read " + name);
    std::vector<std::ptrdiff_t> result;
    for (const std::uint64_t value : values) {
        if (value < 1 || value > node_count())
            throw UsageError(fmt::format("{} contains {}; indices must be 1 to {}, the number of "
                                         "nodes",
                                         name, value, node_count()));
        result.push_back(static_cast<std::ptrdiff_t>(value) - 1);
    }
    return result;
}

pstd::Node Reader::node_of(std::ptrdiff_t index) const {
    const auto nx = static_cast<std::ptrdiff_t>(n_[0]), ny = static_cast<std::ptrdiff_t>(n_[1]);
    return {index % nx, index / nx % ny, index / nx / ny};
}

/// One value, or this rank's planes and the next one.
NodeValues Reader::field(const std::string& name) const {
    const Shape one = {1, 1, 1}, all = field_shape();
    if (const h5::Id dataset = open(name, Kind::real); shape_of(dataset, name) == one)
        return {.values = reals(name, one)};
    const h5::Id dataset = open(name, Kind::real, all);
    const std::ptrdiff_t x0 = slabs_.x_start();
    NodeValues field{.values = {},
                     .x0 = x0,
                     .nx = slabs_.x_count() == 0 ? 0
                                                 : std::min(slabs_.x_count() + 1, slabs_.nx() - x0),
                     .ny = slabs_.ny()};
    if (field.nx == 0) return field;
    const Shape start = kwave_shape(slabs_.grid, pstd::Node{x0, 0, 0}),
                count = kwave_shape(slabs_.grid, pstd::Node{field.nx, slabs_.ny(), slabs_.nz()});
    const h5::Id in_file(H5Dget_space(dataset.raw()), H5Sclose, "find a dataspace"),
        memory(H5Screate_simple(3, count.data(), nullptr), H5Sclose, "create a dataspace");
    h5::check(H5Sselect_hyperslab(in_file.raw(), H5S_SELECT_SET, start.data(), nullptr,
                                  count.data(), nullptr),
              "select a block");
    field.values =
        read_reals(dataset, name, count[0] * count[1] * count[2], memory.raw(), in_file.raw());
    check_finite(name, field.values, count, x0);
    return field;
}

namespace {

using pstd::Node;

/// The material of a slab, to which the functions of Setup refer.
struct Material {
    NodeValues lambda, mu, chi, eta;
    std::array<NodeValues, 3> rho, mu_sg, eta_sg;
    std::ptrdiff_t x0 = 0, x1 = 0;
    bool lossy = false;
};

/// The indices of a node along the axes of k-Wave, from 1.
std::string index_text(const pstd::Grid& grid, const Node& node) {
    const Shape at = kwave_shape(grid, node);
    return fmt::format("index ({}, {}, {})", at[2] + 1, at[1] + 1, at[0] + 1);
}

void check_values(const pstd::Grid& grid, const std::string& name, const NodeValues& field,
                  const char* must, const auto& is_valid) {
    const std::size_t bad = field.values.find_if_not(is_valid);
    if (bad == field.values.size()) return;
    const auto at = static_cast<std::ptrdiff_t>(bad);
    const std::string where =
        field.values.size() == 1
            ? std::string()
            : " at " + index_text(grid, {at % field.nx + field.x0, at / field.nx % field.ny,
                                         at / field.nx / field.ny});
    throw UsageError(
        fmt::format("{} is {:.7g}{}; it must be {}", name, field.values[bad], where, must));
}

/// Limits of the step, and numbers of nodes and faces for warnings.
void survey(const Material& m, const pstd::Slabs& slabs, Input& input) {
    // The step is certainly unstable above the limit of a node with the largest of its densities.
    StepLimits& limits = input.limits;
    limits.alone_s = limits.density_kg_m3 = std::numeric_limits<double>::infinity();
    const double spacing_m = pstd::cubic_spacing_m(input.setup.grid);
    pstd::NodeMaterial last; // most neighbours are equal
    std::pair<double, double> last_densities;
    for (std::ptrdiff_t x = m.x0; x < m.x0 + slabs.x_count(); ++x)
        for (std::ptrdiff_t y = 0; y < slabs.ny(); ++y)
            for (std::ptrdiff_t z = 0; z < slabs.nz(); ++z) {
                const Node n{x, y, z};
                const pstd::NodeMaterial here = input.setup.material(n);
                if (3.0 * m.lambda(n) + 2.0 * m.mu(n) < 0.0) input.soft_nodes += 1.0;
                for (const Node next : {Node{x + 1, y, z}, Node{x, y + 1, z}, Node{x, y, z + 1}})
                    if (next[0] < slabs.nx() && next[1] < slabs.ny() && next[2] < slabs.nz() &&
                        (m.mu(n) == 0.0) != (m.mu(next) == 0.0))
                        input.fluid_faces += 1.0;
                const auto densities = std::minmax({m.rho[0](n), m.rho[1](n), m.rho[2](n)});
                if (here == last && densities == last_densities) continue;
                last = here;
                last_densities = densities;
                const auto [low, high] = densities;
                const double modulus = m.lambda(n) + 2.0 * m.mu(n);
                if (!(modulus > 0.0))
                    throw UsageError(fmt::format("lambda + 2 mu is {} at {}; it must be positive",
                                                 modulus, index_text(input.setup.grid, n)));
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

} // namespace

void Reader::read_material() {
    auto material = std::make_shared<Material>();
    Material& m = *material;
    m.lossy = flag("absorbing_flag", 1) == 1;
    m.x0 = slabs_.x_start();
    m.x1 = slabs_.x_count() == 0 ? m.x0 : std::min(m.x0 + slabs_.x_count() + 1, slabs_.nx());
    const auto positive = [](double value) { return value > 0.0; };
    const auto not_negative = [](double value) { return value >= 0.0; };
    const auto moduli = [&](const std::string& name) {
        NodeValues values = field(name);
        check_values(slabs_.grid, name, values, "0 or more", not_negative);
        return values;
    };
    m.lambda = field("lambda");
    m.mu = moduli("mu");
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string name = fmt::format("rho0_sg{}", axis(i));
        m.rho[i] = field(name);
        check_values(slabs_.grid, name, m.rho[i], "positive", positive);
        m.mu_sg[i] = moduli(fmt::format("mu_sg{}", plane(i)));
    }
    if (m.lossy) {
        m.chi = field("chi");
        m.eta = moduli("eta");
        for (std::size_t i = 0; i < 3; ++i)
            m.eta_sg[i] = moduli(fmt::format("eta_sg{}", plane(i)));
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
    survey(m, slabs_, input_);
}

} // namespace shearwake::kwave
