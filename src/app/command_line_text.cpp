// SPDX-License-Identifier: BSD-3-Clause
#include "app/program.hpp"

#include "base/error.hpp"
#include "pipeline/provenance.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string_view>

namespace shearwake::app {
namespace {

// The only text about them: --help, the manual page and docs/reference/exit-codes.md show it.
constexpr std::pair<ExitCode, std::string_view> exit_codes[] = {
    {ExitCode::done, "The command succeeded."},
    {ExitCode::internal, "An internal error occurred. Please report it."},
    {ExitCode::usage, "The command line is invalid, or a folder does not fit the job."},
    {ExitCode::bad_job, "The job file contains errors, which 'check' lists, or a case needs more "
                        "memory than the machine has."},
    {ExitCode::some_cases_failed, "Some cases failed: see failed/, then use 'run --retry-failed'. "
                                  "Or files are damaged: rerun 'run'."},
    {ExitCode::differs_from_baseline, "The table differs from the baseline."},
    {ExitCode::environment, "A file, a disk or the environment caused an error. Remove the cause "
                            "and rerun the command."},
    {ExitCode::stopped_early, "The run stopped early. Rerun the command to resume it."},
};

/// Text for man(7): a hyphen that can be copied, no accidental requests at the start of a line.
std::string roff(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool at_start = i == 0 || text[i - 1] == '\n';
        if (at_start && (text[i] == '.' || text[i] == '\'')) out += "\\&";
        if (text[i] == '\\')
            out += "\\e";
        else if (text[i] == '-')
            out += "\\-";
        else
            out += text[i];
    }
    return out;
}

std::vector<std::string> names_of(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames())
        names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
        names.push_back("--" + name);
    return names;
}

/// The options of a command and of its unnamed groups.
std::vector<const CLI::Option*> options_of(const CLI::App& command) {
    std::vector<const CLI::Option*> options = command.get_options();
    for (const CLI::App* group : command.get_subcommands({}))
        if (group->get_name().empty())
            for (const CLI::Option* option : group->get_options())
                if (option != group->get_help_ptr()) options.push_back(option);
    return options;
}

bool is_positional(const CLI::Option& option) {
    return names_of(option).empty();
}

/// CLI11 prints the type, then each validator's description: "TEXT:{a,b}".
std::string type_of(const CLI::Option& option) {
    const std::string name = option.get_type_name();
    return name.substr(0, name.find(':'));
}

std::vector<std::string> choices_of(const CLI::Option& option) {
    const std::string name = option.get_type_name();
    const std::size_t open = name.find('{'), close = name.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    return CLI::detail::split(name.substr(open + 1, close - open - 1), ',');
}

std::string synopsis(const CLI::App& command) {
    std::string text = fmt::format(".B shearwake {}\n", roff(command.get_name()));
    text += ".RI [ option ...]\n";
    for (const CLI::Option* option : options_of(command))
        if (is_positional(*option))
            text += option->get_required()
                        ? fmt::format(".I {}\n", roff(option->get_name(true)))
                        : fmt::format(".RI [ {} ]\n", roff(option->get_name(true)));
    return text;
}

std::string describe(const CLI::Option& option) {
    std::string heading;
    if (is_positional(option)) {
        heading = fmt::format("\\fI{}\\fR", roff(option.get_name(true)));
    } else {
        std::vector<std::string> names;
        for (const std::string& name : names_of(option))
            names.push_back(fmt::format("\\fB{}\\fR", roff(name)));
        heading = fmt::format("{}", fmt::join(names, ", "));
        if (option.get_items_expected_max() > 0)
            heading += fmt::format(" \\fI{}\\fR", roff(type_of(option)));
    }
    return fmt::format(".TP\n{}\n{}\n", heading, roff(option.get_description()));
}

std::string describe(const CLI::App& command) {
    std::string text = fmt::format(".SS {}\n{}\n.PP\n{}", roff(command.get_name()),
                                   synopsis(command), roff(command.get_description()) + ".\n");
    for (const CLI::Option* option : options_of(command))
        text += describe(*option);
    return text;
}

constexpr std::string_view closing = R"(.SH ENVIRONMENT
.TP
.B SHEARWAKE_CACHE
The folder in which FFTW plans and the measured speed of the machine are stored. The default is
.IR $XDG_CACHE_HOME/shearwake ,
or
.I ~/.cache/shearwake
without
.BR XDG_CACHE_HOME .
The value
.B off
disables the cache.
.TP
.B SHEARWAKE_SIMD
The instruction set of the kernels:
.BR baseline ,
.B avx2
or
.BR avx512 .
The default is the widest one that the processor has.
.TP
.B SHEARWAKE_PYTHON
The Python interpreter that draws figures. It needs numpy, h5py, matplotlib and xxhash.
.SH SCRIPTS
These scripts are installed with the program. Each prints its options with
.BR \-\-help .
.TP
.B shearwake\-submit
submits a job to Slurm
.TP
.B shearwake\-import\-kwave
converts a simulation of k-Wave to a job
.TP
.B shearwake\-make\-map
writes a map of the medium
.TP
.B shearwake\-nightly
compares the tables of the jobs with their baselines
.SH EXAMPLES
.EX
shearwake check jobs/quickstart.toml
mpirun \-n 2 shearwake run jobs/quickstart.toml
shearwake reduce out/quickstart
shearwake report out/quickstart
.EE
)";

/// The extension of the files that a positional argument names; "/" is any folder.
std::string_view completed_files(const CLI::Option& option) {
    const std::string name = option.get_name(true);
    if (name == "JOB") return "toml";
    if (name == "CASE") return "h5";
    if (name == "DIR") return "/";
    return "";
}

} // namespace

std::string man_page(const CLI::App& app) {
    const std::string description = app.get_description();
    const std::string what = description.substr(description.find(": ") + 2);
    std::string text = fmt::format(".TH SHEARWAKE 1 \"\" \"shearwake {}\" \"User Commands\"\n"
                                   ".SH NAME\nshearwake \\- {}\n.SH SYNOPSIS\n"
                                   ".B shearwake\n.I command\n.RI [ argument ...]\n.PP\n"
                                   ".B mpirun \\-n\n.I N\n.B shearwake run\n.I JOB\n"
                                   ".SH COMMANDS\n",
                                   pipeline::program_version(), roff(what));
    for (const CLI::App* command : app.get_subcommands({}))
        text += describe(*command);
    text += ".SH EXIT STATUS\n";
    for (const auto& [code, meaning] : exit_codes)
        text += fmt::format(".TP\n.B {}\n{}\n", static_cast<int>(code), roff(meaning));
    return text + std::string(closing);
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options_of(command)) {
        const auto more = names_of(*option);
        names.insert(names.end(), more.begin(), more.end());
    }
    return names;
}

std::string exit_code_list() {
    std::string text = "Exit codes:\n";
    for (const auto& [code, meaning] : exit_codes)
        text += fmt::format("  {:<2}  {}\n", static_cast<int>(code), meaning);
    return text;
}

std::string bash_completion(const CLI::App& app) {
    std::vector<std::string> commands;
    std::string cases;
    for (const CLI::App* command : app.get_subcommands({})) {
        commands.push_back(command->get_name());
        const std::vector<std::string> options = option_names(*command);
        std::vector<std::string> choices;
        std::string_view files;
        for (const CLI::Option* option : options_of(*command)) {
            if (!is_positional(*option)) continue;
            const auto more = choices_of(*option);
            choices.insert(choices.end(), more.begin(), more.end());
            if (files.empty()) files = completed_files(*option);
        }
        cases +=
            fmt::format("    {}) options='{}' choices='{}' files='{}' ;;\n", command->get_name(),
                        fmt::join(options, " "), fmt::join(choices, " "), files);
    }
    return fmt::format(R"(# bash completion of shearwake
_shearwake() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} command= word options= choices= files=
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        if [[ $word != -* ]]; then command=$word; break; fi
    done
    COMPREPLY=()
    case $command in
    "") choices='{}' options='--help --version' ;;
{}    esac
    if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
    elif [[ $choices ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$current")
    elif [[ $files == / ]]; then
        mapfile -t COMPREPLY < <(compgen -d -- "$current")
    elif [[ $files ]]; then
        mapfile -t COMPREPLY < <(compgen -d -- "$current"; compgen -f -X "!*.$files" -- "$current")
    else
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
    fi
}}
complete -o filenames -F _shearwake shearwake
)",
                       fmt::join(commands, " "), cases);
}

} // namespace shearwake::app
