// SPDX-License-Identifier: BSD-3-Clause
#include "app/movie.hpp"

#include "app/python_script.hpp"
#include "parallel/agree.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

namespace shearwake::app {
namespace {

struct MovieArguments {
    std::filesystem::path case_file;
    std::filesystem::path out; // without extension; empty: the path of the case file
    double slow_down = 0.0;    // 0: the run takes about six seconds
    int width_px = 960;        // of the MP4
};

ExitCode movie_command(const MovieArguments& arguments, const Comm& world) {
    on_root(world, [&] {
        std::vector<std::string> words = {arguments.case_file.string()};
        if (!arguments.out.empty()) words.insert(words.end(), {"--out", arguments.out.string()});
        if (arguments.slow_down > 0.0)
            words.insert(words.end(), {"--slow-down", fmt::format("{:.9g}", arguments.slow_down)});
        words.insert(words.end(), {"--width", fmt::format("{}", arguments.width_px)});
        const int status = run_python_script("report/movie.py", words);
        if (status != 0)
            throw UsageError(fmt::format("the movie was not written (exit {})", status),
                             ExitCode::environment);
    });
    return ExitCode::done;
}

} // namespace

void add_movie(CLI::App& app, std::function<ExitCode(const Comm&)>& action) {
    auto arguments = std::make_shared<MovieArguments>();
    CLI::App* command =
        app.add_subcommand("movie", "write a movie of the surface of a case (MP4, GIF)");
    command->add_option("CASE", arguments->case_file, "case file with several surfaces")
        ->required();
    command
        ->add_option("--out", arguments->out,
                     "path of the movies without extension (default: that of the case file)")
        ->type_name("NAME");
    command
        ->add_option("--slow-down", arguments->slow_down,
                     "how many times slower than the motion (default: the run takes about 6 s)")
        ->check(CLI::Range(1e-3, 1e9));
    command->add_option("--width", arguments->width_px, "width of the MP4 in pixels (default 960)")
        ->check(CLI::Range(160, 3840));
    command->callback([=, &action] {
        action = [=](const Comm& world) { return movie_command(*arguments, world); };
    });
}

} // namespace shearwake::app
