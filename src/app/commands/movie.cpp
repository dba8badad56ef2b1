// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/python_command.hpp"

namespace shearwake::app {

void add_movie(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(app, action, "movie",
                                           "write a movie of the surface of a case (MP4, GIF)",
                                           {.module = "shearwake.report.movie",
                                            .rejection = "the movie was not written",
                                            .failure = "the movie was not written"});
    pass_option(command, "CASE", "case file with several surfaces")->required();
    pass_option(command, "--out",
                "path of the movies without extension (default: that of the case file)", "NAME");
    pass_option(command, "--slow-down",
                "how many times slower than the motion (default: the run takes about 6 s)", "FLOAT")
        ->check(CLI::Range(1e-3, 1e9));
    pass_option(command, "--width", "width of the MP4 in pixels (default 960)", "INT")
        ->check(CLI::Range(160, 3840));
}

} // namespace shearwake::app
