#include "io/case_file_writer.hpp"

#include "base/error.hpp"
#include "io/files.hpp"
#include "io/h5_block.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <variant>

namespace shearwake {
namespace {

void put_words(hid_t object, const Variable& variable) {
    h5::put_attribute(object, "units", variable.units);
    h5::put_attribute(object, "long_name", variable.long_name);
    if (!variable.note.empty()) h5::put_attribute(object, "note", variable.note);
}

/// Coordinates first, then what lies over them.
void write_group(hid_t group, const std::vector<Variable>& variables) {
    std::map<std::string, h5::Id> coordinates;
    for (const Variable& v : variables) {
        if (v.dimensions != std::vector{v.name}) continue;
        const hsize_t extent = v.values.size();
        h5::Id dataset = h5::create_dataset(group, v.name, std::span(&extent, 1));
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        h5::make_scale(dataset, v.name);
        coordinates.emplace(v.name, std::move(dataset));
    }
    for (const Variable& v : variables) {
        if (v.dimensions == std::vector{v.name}) continue;
        std::vector<hsize_t> shape;
        hsize_t count = 1;
        for (const std::string& dimension : v.dimensions) {
            shape.push_back(h5::shape(coordinates.at(dimension)).at(0));
            count *= shape.back();
        }
        if (count != v.values.size()) throw Error("variable " + v.name + " has not its shape");
        const h5::Id dataset = h5::create_dataset(group, v.name, shape);
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        for (std::size_t d = 0; d < v.dimensions.size(); ++d)
            h5::attach_scale(dataset, coordinates.at(v.dimensions[d]), static_cast<unsigned>(d));
    }
}

std::vector<double> coordinate(std::ptrdiff_t count, const auto& at) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::ptrdiff_t i = 0; i < count; ++i)
        values[static_cast<std::size_t>(i)] = at(i);
    return values;
}

std::vector<hsize_t> shape_of(const SurfaceLayout& layout) {
    return {layout.times_s.size(), layout.depths_m.size(), static_cast<hsize_t>(layout.domain.nx),
            static_cast<hsize_t>(layout.domain.ny)};
}

} // namespace

double SurfaceLayout::bytes() const {
    return static_cast<double>(times_s.size() * depths_m.size()) *
           static_cast<double>(domain.nx * domain.ny) * sizeof(double);
}

CaseFileWriter::CaseFileWriter(const std::filesystem::path& path, const Comm& team,
                               SurfaceLayout surface, Beginning beginning)
    : path_(path), part_(path.string() + ".part"), team_(team), surface_(std::move(surface)) {
    on_root(team_, [&] {
        if (beginning == Beginning::go_on && !surface_.empty()) return;
        // Asked before it is used: an MPI write that finds the disk full may end the whole program.
        const double needed = surface_.bytes() + 1e6;
        const double free = free_bytes(path_.parent_path());
        if (free < needed)
            throw CaseFailure(
                fmt::format("cannot write {}: it needs {:.1f} MB and the disk has {:.1f} MB "
                            "left",
                            path_.string(), needed / 1e6, free / 1e6));
        try {
            create_surface();
        } catch (...) {
            std::error_code ignored;
            std::filesystem::remove(part_, ignored);
            throw;
        }
    });
    if (surface_.empty()) return;
    shared_file_ = h5::open_shared(part_, team_);
    shared_field_ = h5::open_dataset(shared_file_.raw(), "surface/u_z");
}

CaseFileWriter::~CaseFileWriter() {
    if (committed_ || left_ || !team_.is_root()) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void CaseFileWriter::create_surface() const {
    h5::Id file = h5::open_file(part_, h5::Access::create);
    if (!surface_.empty()) {
        const h5::Id group = h5::create_group(file.raw(), "surface");
        const Domain& d = surface_.domain;
        const std::vector<Variable> axes = {
            {"time", {"time"}, surface_.times_s, "s", "time since the load began", ""},
            {"depth", {"depth"}, surface_.depths_m, "m", "depth below the skin surface", ""},
            {"x",
             {"x"},
             coordinate(d.nx, [&](auto i) { return d.x_m(i); }),
             "m",
             "position along x, the scan direction",
             ""},
            {"y",
             {"y"},
             coordinate(d.ny, [&](auto j) { return d.y_m(j); }),
             "m",
             "position along y",
             ""}};
        write_group(group.raw(), axes);
        const h5::Id field = h5::create_dataset(group.raw(), "u_z", shape_of(surface_));
        put_words(field.raw(), {.name = "u_z",
                                .units = "m",
                                .long_name = "normal displacement, positive into the tissue"});
        for (unsigned i = 0; i < axes.size(); ++i)
            h5::attach_scale(field, h5::open_dataset(group.raw(), axes[i].name), i);
    }
    file.close("close " + part_.string());
}

void CaseFileWriter::write_surface(std::size_t time, std::size_t depth, View2<const double> u_z_m,
                                   std::ptrdiff_t x_start) {
    const h5::Block block{
        {time, depth, static_cast<hsize_t>(x_start), 0},
        {1, 1, static_cast<hsize_t>(u_z_m.rows()), static_cast<hsize_t>(u_z_m.columns())}};
    h5::write_block(shared_field_, block, u_z_m, "write a surface field to " + part_.string(),
                    team_);
}

void CaseFileWriter::flush() {
    if (surface_.empty()) return;
    const herr_t status = H5Fflush(shared_file_.raw(), H5F_SCOPE_GLOBAL);
    if (team_.max(status < 0 ? 1 : 0) != 0)
        throw CaseFailure(fmt::format("cannot flush {} {}", part_.string(), h5::last_error()));
    on_root(team_, [&] { flush_to_disk(part_); });
}

std::string trouble_with_part(const std::filesystem::path& path, const SurfaceLayout& surface) {
    const std::filesystem::path part = path.string() + ".part";
    if (!std::filesystem::exists(part)) return "is missing";
    try {
        const h5::Id file = h5::open_file(part, h5::Access::read);
        const h5::Id field = h5::open_dataset(file.raw(), "surface/u_z");
        H5G_info_t root{};
        h5::check(H5Gget_info(file.raw(), &root), "look at the root group");
        if (root.nlinks != 1) return "was ended while it was being completed";
        if (h5::shape(field) != shape_of(surface)) return "holds other surface fields";
        if (H5Dget_offset(field.raw()) == HADDR_UNDEF) return "has no room for its surface fields";
        return "";
    } catch (const Error& error) {
        return fmt::format("is damaged ({})", error.what());
    }
}

void CaseFileWriter::commit(const std::vector<VariableGroup>& groups,
                            const std::vector<Attribute>& attributes) {
    if (!surface_.empty()) {
        shared_field_.close_shared("close a surface field", team_);
        shared_file_.close_shared("close " + part_.string(), team_);
    }
    on_root(team_, [&] {
        h5::Id file = h5::open_file(part_, h5::Access::read_write);
        for (const VariableGroup& group : groups) {
            if (group.name.empty())
                write_group(file.raw(), group.variables);
            else
                write_group(h5::create_group(file.raw(), group.name).raw(), group.variables);
        }
        for (const Attribute& attribute : attributes)
            std::visit(
                [&](const auto& value) { h5::put_attribute(file.raw(), attribute.name, value); },
                attribute.value);
        h5::check(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), "flush " + part_.string());
        file.close("close " + part_.string());
        publish(part_, path_);
        committed_ = true;
    });
}

} // namespace shearwake
