// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/run.hpp"

#include <cctype>
#include <fmt/format.h>

namespace shearwake::schedule {
namespace {

bool is_plain(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("._-/=+,:@%").find(c) != std::string_view::npos;
}

std::string job_command_line(std::string_view command, const std::filesystem::path& job,
                             const std::vector<std::string>& overrides,
                             const std::filesystem::path& out) {
    std::string line = fmt::format("shearwake {} {}", command, shell_word(job.string()));
    for (const std::string& text : overrides)
        line += " -S " + shell_word(text);
    if (!out.empty()) line += " --out " + shell_word(out.string());
    return line;
}

std::string team_option(int ranks_per_case) {
    return ranks_per_case > 0 ? fmt::format(" --ranks-per-case {}", ranks_per_case) : "";
}

} // namespace

std::string shell_word(const std::string& word) {
    bool plain = !word.empty();
    for (const char c : word)
        plain = plain && is_plain(c);
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word)
        quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

std::string run_command_line(const std::filesystem::path& job,
                             const std::vector<std::string>& overrides,
                             const std::filesystem::path& out) {
    return job_command_line("run", job, overrides, out);
}

std::string planned_command_line(const std::filesystem::path& job,
                                 const std::vector<std::string>& overrides, int ranks,
                                 int ranks_per_case) {
    return (ranks > 1 ? fmt::format("mpirun -n {} ", ranks) : "") +
           run_command_line(job, overrides, {}) + team_option(ranks_per_case);
}

std::string command_line(std::string_view command, const RunArguments& arguments) {
    std::string line =
        job_command_line(command, arguments.job, arguments.overrides, arguments.out) +
        team_option(arguments.ranks_per_case);
    if (!arguments.only.empty())
        line += fmt::format(" --only {}",
                            shell_word(fmt::format("{}", fmt::join(arguments.only, ","))));
    if (arguments.force) line += " --force";
    if (arguments.extend) line += " --extend";
    if (arguments.allow_mixed) line += " --allow-mixed";
    return line;
}

std::string run_command_line(const RunArguments& arguments) {
    return arguments.resumed_by.empty() ? command_line("run", arguments) : arguments.resumed_by;
}

std::string reduce_command_line(const OutputFolder& folder) {
    const std::string root = shell_word(folder.root.string());
    return fmt::format("shearwake reduce {0} && shearwake report {0}", root);
}

} // namespace shearwake::schedule
