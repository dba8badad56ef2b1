// SPDX-License-Identifier: BSD-3-Clause
#include "app/optional_commands.hpp"

#include "base/error.hpp"
#include "pipeline/provenance.hpp"
#include "studies/laboratory/least_squares.hpp"
#include "studies/optimise/search/best_envelope.hpp"

#include <array>
#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct Library {
    std::string_view command, name, debian;
    bool exists;
};

/// In the order of OptionalCommand.
std::array<Library, 2> libraries() {
    return {{{"fit", "Ceres Solver", "libceres-dev", laboratory::can_fit},
             {"optimise", "NLopt", "libnlopt-dev", optimise::can_search}}};
}

} // namespace

void require_library(OptionalCommand command) {
    const Library library = libraries()[static_cast<std::size_t>(command)];
    if (!library.exists)
        throw UsageError(
            fmt::format("this shearwake was built without {0}, which {1} needs; install {0} "
                        "(Debian: {2}), configure with -D{3}_ROOT=FOLDER if it is in a folder of "
                        "its own, and build again",
                        library.name, library.command, library.debian,
                        command == OptionalCommand::fit ? "Ceres" : "NLopt"),
            ExitCode::environment);
}

std::string full_version_text() {
    std::string text = pipeline::version_text();
    for (const Library& library : libraries())
        if (!library.exists)
            text += fmt::format("\nmissing   {}: built without {}", library.command, library.name);
    return text;
}

} // namespace shearwake::app
