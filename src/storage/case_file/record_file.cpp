// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/record_file.hpp"

#include "storage/case_file/variable_group.hpp"
#include "storage/checksum/file_checksum.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"

namespace shearwake::storage {

void write_record(const std::filesystem::path& path, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes) {
    const std::filesystem::path part = path.string() + ".part";
    h5::Id file = h5::open_file(part, h5::Access::create);
    for (const VariableGroup& group : groups) {
        if (group.name.empty())
            write_group(file.raw(), group.variables);
        else
            write_group(h5::create_group(file.raw(), group.name).raw(), group.variables);
    }
    for (const Attribute& attribute : attributes)
        std::visit([&](const auto& value) { h5::put_attribute(file.raw(), attribute.name, value); },
                   attribute.value);
    h5::put_attribute(file.raw(), checksum_attribute, std::string(checksum_promise));
    file.close("close " + part.string());
    append_checksum(part);
    publish(part, path);
}

} // namespace shearwake::storage
