// SPDX-License-Identifier: BSD-3-Clause
#include "config/afferent_options.hpp"

#include "config/job.hpp"
#include "config/sections/read_afferents.hpp"
#include "config/sections/read_case.hpp"

#include <array>

namespace shearwake::config {

AfferentOptions read_afferent_options(std::string_view text, const std::string& file_name,
                                      std::span<const Override> overrides,
                                      const TextLoader& load_text) {
    DiagnosticList diagnostics;
    AfferentOptions options;
    if (NodePtr tree = parse_toml(text, file_name, diagnostics)) {
        for (const Override& override : overrides)
            tree = with_override(tree, override, diagnostics);
        Reader root(tree, "", diagnostics);
        root.allow(case_tables());
        root.allow(std::array<std::string_view, 4>{"schema", "job", "sweep", "table"});
        Reader afferents = root.optional_table("afferents");
        if (const auto read = read_afferents(afferents, Domain{}, nullptr, load_text))
            options = *read;
        root.finish();
    }
    if (diagnostics.errors() > 0) throw BadJob(diagnostics.sorted());
    return options;
}

} // namespace shearwake::config
