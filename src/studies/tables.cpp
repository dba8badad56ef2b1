// SPDX-License-Identifier: BSD-3-Clause
#include "studies/tables.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"

#include <algorithm>

namespace shearwake::studies {
namespace {

bool contains_cases(const schedule::OutputFolder& folder) {
    namespace fs = std::filesystem;
    if (!fs::is_directory(folder.cases())) return false;
    const fs::directory_iterator files(folder.cases());
    return std::any_of(fs::begin(files), fs::end(files),
                       [](const auto& entry) { return entry.path().extension() == ".h5"; });
}

/// The path of plan.json or, without it, of tables/plan.json, which is made from the case files.
std::filesystem::path plan_of(const schedule::OutputFolder& folder) {
    if (std::filesystem::exists(folder.plan()) || !contains_cases(folder)) return folder.plan();
    if (run_python_module("shearwake.report.from_cases", {folder.root.string()}) != 0)
        throw UsageError("cannot reconstruct the plan from the case files in " +
                             folder.cases().string(),
                         ExitCode::environment);
    return folder.tables() / "plan.json";
}

} // namespace

reduce::Table table_of(const schedule::OutputFolder& folder) {
    return reduce::table_of(
        {.folder = folder.root, .plan = folder.plan(), .tables = folder.tables()});
}

reduce::ReducedTables reduce_folder(const schedule::OutputFolder& folder,
                                    reduce::ErrorColumns errors) {
    reduce::ReduceInput input{.folder = folder.root,
                              .plan = plan_of(folder),
                              .tables = folder.tables(),
                              .errors = folder.errors(),
                              .error_columns = errors};
    if (std::filesystem::exists(folder.uncertainty())) {
        input.errors = folder.uncertainty();
        input.meaning_of_errors = "standard deviation over repetitions with noise and gaps";
    }
    return reduce::reduce(input);
}

} // namespace shearwake::studies
