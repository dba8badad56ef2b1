#include "parallel/session.hpp"

#include <cstdio>
#include <exception>
#include <string>
#include <fmt/format.h>

namespace shearwake {
namespace {

std::string with_causes(const std::exception& error) {
    std::string text = error.what();
    try {
        std::rethrow_if_nested(error);
    } catch (const std::exception& cause) {
        text += "\n  because: " + with_causes(cause);
    } catch (...) {
        text += "\n  because of something that is no exception";
    }
    return text;
}

[[noreturn]] void abort_all(int rank, const std::string& what) {
    abort_all_ranks(fmt::format("internal error on rank {}: {}", rank, what), ExitCode::internal);
}

} // namespace

int guarded_main(int argc, char** argv, const std::function<ExitCode(const Comm&)>& program) {
    if (MPI_Init(&argc, &argv) != MPI_SUCCESS) {
        fmt::print(stderr, "shearwake: MPI does not start\n");
        return static_cast<int>(ExitCode::environment);
    }
    const Comm world = Comm::world();
    int code = static_cast<int>(ExitCode::internal);
    try {
        code = static_cast<int>(program(world));
    } catch (const UsageError& error) {
        // The same on every rank: one of them speaks.
        if (world.is_root()) fmt::print(stderr, "{}\n", error.what());
        code = static_cast<int>(error.code());
    } catch (const std::exception& error) {
        abort_all(world.rank(), with_causes(error));
    } catch (...) {
        abort_all(world.rank(), "something that is no exception");
    }
    code = world.max(code);
    std::fflush(stdout);
    MPI_Finalize();
    return code;
}

void abort_all_ranks(const std::string& reason, ExitCode code) {
    fmt::print(stderr, "shearwake: {}\n", reason);
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(code));
    std::abort();
}

std::string mpi_version() {
    char text[MPI_MAX_LIBRARY_VERSION_STRING] = {};
    int length = 0;
    MPI_Get_library_version(text, &length);
    const std::string whole(text);
    return whole.substr(0, whole.find(','));
}

} // namespace shearwake
