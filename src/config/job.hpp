// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "config/document/diagnostic.hpp"
#include "config/files/files.hpp"
#include "config/sweep/override.hpp"
#include "config/sweep/sweep.hpp"
#include "problem/case/afferents.hpp"
#include "problem/case/optimise_options.hpp"
#include "problem/case/plan.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// A job file after reading and expansion.
struct Job {
    std::string
        text; // verbatim; with overrides: the job that they result in, in which they are marked
    Plan plan;
    std::vector<Diagnostic> diagnostics;                    // warnings
    std::optional<OptimiseOptions> optimise = std::nullopt; // if the job has [optimise]
    std::vector<std::string> files = {};                    // that it names, as it names them
};

/// Thrown for a job with errors. `what` contains all diagnostics, one per line.
class BadJob : public UsageError {
public:
    explicit BadJob(std::vector<Diagnostic> diagnostics);
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

private:
    std::vector<Diagnostic> diagnostics_;
};

/// Reads, expands and checks a job. Throws BadJob with all errors and warnings. Does not access
/// files: `file_name` is for messages, and the loaders provide maps and texts; without a loader, a
/// job that names such a file is rejected. `points`: of adaptive axes; the others have those of the
/// first round. Collective if the loaders are; the same text and files give the same job.
Job read_job(std::string_view text, const std::string& file_name,
             std::span<const Override> overrides = {}, const MapLoader& load_map = nullptr,
             const TextLoader& load_text = nullptr, const AxisPoints& points = {});

/// A job with its overrides and with a flattened [sweep] and [uncertain]; null after an error of
/// TOML.
NodePtr job_tree(std::string_view text, const std::string& file_name,
                 std::span<const Override> overrides, DiagnosticList& diagnostics);

/// Reads [afferents] of a job file, or of a file that contains only this table, and overrides of
/// its keys; without both, the defaults. Throws BadJob with all errors.
AfferentOptions read_afferent_options(std::string_view text, const std::string& file_name,
                                      std::span<const Override> overrides,
                                      const TextLoader& load_text);

} // namespace shearwake::config
