#include "io/record_file.hpp"

#include "io/files.hpp"
#include "io/h5.hpp"
#include "io/variable_group.hpp"

namespace shearwake {

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
    file.close("close " + part.string());
    publish(part, path);
}

} // namespace shearwake
