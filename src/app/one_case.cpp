// SPDX-License-Identifier: BSD-3-Clause
#include "app/one_case.hpp"

#include "config/document/tree.hpp"
#include "parallel/agree.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

/// The reference of the job as the table [table] of a job without axes.
std::string table_without_axes(const std::filesystem::path& job) {
    config::DiagnosticList ignored; // load_job() reports errors
    const config::NodePtr tree = config::parse_toml(
        storage::read_file(job, storage::largest_user_text_B), job.string(), ignored);
    const config::NodePtr reference =
        tree ? config::find(tree, {{"table"}, {"reference"}}) : nullptr;
    return reference ? fmt::format("{{ reference = {} }}", config::render(*reference)) : "{}";
}

} // namespace

std::vector<std::string> one_case_overrides(const schedule::JobArguments& arguments,
                                            const Comm& world) {
    std::string table;
    on_root(world, [&] { table = table_without_axes(arguments.job); });
    std::vector<std::string> overrides = {"sweep={}", "uncertain={}",
                                          "table=" + world.broadcast(std::move(table))};
    overrides.insert(overrides.end(), arguments.overrides.begin(), arguments.overrides.end());
    return overrides;
}

} // namespace shearwake::app
