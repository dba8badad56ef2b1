// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace shearwake::app {

/// Reads the command line and calls the function of its command. Collective over the world.
ExitCode program(int argc, char** argv, const Comm& world);

/// The manual page of the program in the format of man(7), made from the commands and options that
/// `app` declares.
std::string man_page(const CLI::App& app);

/// The names of all options of a command with their hyphens, "-S" and "--out".
std::vector<std::string> option_names(const CLI::App& command);

/// One line for each exit code of the program.
std::string exit_code_list();

/// A script that bash sources to complete commands, options, their values and file names.
std::string bash_completion(const CLI::App& app);

} // namespace shearwake::app
