// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/session.hpp"

#include "base/text.hpp"
#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "simd/instruction_set.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <sys/stat.h>
#include <thread>
#include <poll.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace shearwake {

namespace {

std::string with_causes(const std::exception& error) {
    std::string text = error.what();
    try {
        std::rethrow_if_nested(error);
    } catch (const std::exception& cause) {
        text += "\n  because: " + with_causes(cause);
    } catch (...) {
        text += "\n  because: an exception of unknown type";
    }
    return text;
}

/// Replaces closed standard streams by /dev/null or /dev/full, so that no file opened later reuses
/// their descriptors. Ignores SIGPIPE, so that writing to a closed pipe fails instead of ending the
/// program. Ignores SIGXFSZ as well, so that a file above a limit of its size is an error of the
/// file.
void secure_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) {
            const char* instead = stream == STDOUT_FILENO ? "/dev/full" : "/dev/null";
            const int opened = ::open(instead, stream == STDIN_FILENO ? O_RDONLY : O_WRONLY);
            if (opened >= 0 && opened != stream) {
                ::dup2(opened, stream);
                ::close(opened);
            }
        }
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

/// The text of an error; on a terminal "error:" precedes it, unless it marks its errors itself.
std::string error_text(const std::string& text) {
    const bool is_marked = ::isatty(STDERR_FILENO) == 0 || text.find("error:") != std::string::npos;
    return coloured(is_marked ? text : "error: " + text, stderr);
}

/// True if mpirun or srun has started this process.
bool has_launcher() {
    constexpr std::array variables{"OMPI_COMM_WORLD_SIZE", "PMIX_NAMESPACE", "PMI_RANK"};
    return std::ranges::any_of(variables,
                               [](const char* name) { return std::getenv(name) != nullptr; });
}

/// How to start a separate run inside another MPI program. All variables have to go: Open MPI
/// refuses a nested mpirun, and a part of them makes MPI_Init fail.
constexpr const char* remedy =
    "Start each run without the variables of the other program: env -u OMPI_COMM_WORLD_SIZE $(env "
    "| sed -nE 's/^((OMPI|PMIX|PMI)_[^=]*)=.*/-u \\1/p') shearwake ..., as shearwake.Job does in "
    "Python";

std::string content_of(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Whether a process that is itself the rank that this process would become uses MPI, such as a
/// driver with mpi4py, and has started this one. MPI_Init would then fail or block. False where
/// there is no /proc.
bool is_inside_of_rank() {
    std::vector<std::string> own; // what makes this process a rank, as in /proc/PID/environ
    for (const char* name : {"PMIX_NAMESPACE", "PMIX_RANK", "PMI_FD", "PMI_RANK"})
        if (const char* value = std::getenv(name))
            own.push_back(std::string(1, '\0') + name + '=' + value + '\0');
    for (std::string pid = std::to_string(::getppid()); !own.empty();) {
        const std::string folder = "/proc/" + pid + "/";
        const std::string variables = '\0' + content_of(folder + "environ");
        if (!std::ranges::all_of(
                own, [&](const auto& text) { return variables.find(text) != std::string::npos; }))
            return false;
        if (content_of(folder + "maps").find("/libmpi") != std::string::npos) return true;
        const std::string status = content_of(folder + "status"), before = "PPid:\t";
        const auto at = status.find(before);
        if (at == std::string::npos) return false;
        pid = std::to_string(std::atol(status.c_str() + at + before.size()));
    }
    return false;
}

/// Calls MPI_Init after selecting components of Open MPI. Values set by the user have priority.
/// * `lockedfile` writes names of files into a buffer of fixed length and ends the program for long
///   paths. It provides shared file pointers, which are not used.
/// * A process without a launcher has nobody to communicate with. Without a daemon (orted) and
///   without a search for networks it starts in 0.03 s instead of 0.37 s. All such processes would
///   share one session folder, which the first to end removes: of 400 programs that started eight
///   at a time, ten failed. They have no such folder, and therefore no shared file pointers (sm).
///   It needs no devices either: where OpenCL is installed, their search takes half of the start.
int initialise_mpi(int& argc, char**& argv) {
    const bool alone = !has_launcher();
    // Read by the first MPI_File_open.
    ::setenv("OMPI_MCA_sharedfp", alone ? "^lockedfile,sm" : "^lockedfile", 0);
    std::vector<std::pair<const char*, const char*>> choices;
    if (alone)
        choices = {{"OMPI_MCA_ess_singleton_isolated", "1"},
                   {"OMPI_MCA_orte_create_session_dirs", "0"},
                   {"OMPI_MCA_pml", "ob1"},
                   {"OMPI_MCA_btl", "self"}};
    std::erase_if(choices, [](const auto& choice) { return std::getenv(choice.first) != nullptr; });
    for (const auto& [name, value] : choices)
        ::setenv(name, value, 1);
    const char* given = std::getenv("HWLOC_COMPONENTS");
    const std::string components = given ? given : "";
    if (alone)
        ::setenv("HWLOC_COMPONENTS",
                 (components + (components.empty() ? "" : ",") + "-opencl,-pci").c_str(), 1);
    const int result = MPI_Init(&argc, &argv);
    for (const auto& [name, value] : choices)
        ::unsetenv(name); // a child may have a launcher
    if (alone && given)
        ::setenv("HWLOC_COMPONENTS", components.c_str(), 1);
    else if (alone)
        ::unsetenv("HWLOC_COMPONENTS");
    return result;
}

/// The exit code, raised to ExitCode::environment if the output could not be written.
int with_output_written(int code) {
    errno = 0;
    const bool failed_before = std::ferror(stdout) != 0;
    if (std::fflush(stdout) == 0 && !failed_before) return code;
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    if (::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0)
        // The reader of a pipe, for example head, has ended; a print may have thrown.
        return code == static_cast<int>(ExitCode::internal) ? 0 : code;
    fmt::print(stderr, "shearwake: the output cannot be written{}\n",
               errno != 0 ? fmt::format(": {}", std::strerror(errno)) : "");
    return std::max(code, static_cast<int>(ExitCode::environment));
}

[[noreturn]] void abort_all(int rank, const std::string& what) {
    fmt::print(stderr, "shearwake: internal error on rank {}: {}\n", rank, what);
    std::fflush(stderr);
    int has_mpi = 0;
    MPI_Initialized(&has_mpi);
    if (has_mpi == 0) std::_Exit(static_cast<int>(ExitCode::internal));
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitCode::internal));
    std::abort();
}

/// Selects the best instruction set that all ranks support, or the one that SHEARWAKE_SIMD requests
/// on rank 0. All ranks use the same set, so that they compute the same bits. Collective.
void choose_instruction_set(const Comm& world) {
    using simd::InstructionSet;
    const int best = world.min(static_cast<int>(simd::best_instruction_set()));
    int requested = -1;
    on_root(world, [&] {
        if (const auto set = simd::requested_instruction_set()) requested = static_cast<int>(*set);
    });
    requested = world.broadcast(requested);
    together(world, [&] {
        simd::use_instruction_set(static_cast<InstructionSet>(requested < 0 ? best : requested));
    });
}

/// Two runs that a program with MPI has started may have joined one world. Collective.
void require_one_run(const Comm& world, int argc, char** argv) {
    std::string arguments;
    for (int i = 1; i < argc; ++i)
        arguments += std::string(argv[i]) + '\0';
    std::error_code ignored;
    const std::string folder = std::filesystem::current_path(ignored).string();
    struct stat info {};
    const long node = ::stat(".", &info) == 0 ? static_cast<long>(info.st_ino) : 0;
    const bool other_arguments = world.broadcast(std::string(arguments)) != arguments;
    const bool other_name = world.broadcast(std::string(folder)) != folder,
               other_node = world.broadcast(node) != node; // nodes may have other names for it
    const bool other_folder = other_name && other_node;
    if (world.max(other_arguments || other_folder ? 1 : 0) != 0)
        throw UsageError(fmt::format(
            "the {} ranks of this MPI program have different {}: separate runs have joined one "
            "world, since they were started inside another MPI program. {}",
            world.size(), world.max(other_arguments ? 1 : 0) != 0 ? "arguments" : "working folders",
            remedy));
}

/// Warns of srun without PMI, which starts independent copies of the program.
void warn_of_lone_tasks(const Comm& world, int argc, char** argv) {
    constexpr std::array parallel{"run", "optimise", "optimize", "converge", "fit"};
    const char* tasks = std::getenv("SLURM_NTASKS");
    if (world.size() > 1 || !tasks || std::atoi(tasks) < 2 || argc < 2 ||
        std::ranges::none_of(parallel,
                             [&](const char* name) { return argv[1] == std::string(name); }))
        return;
    fmt::print(stderr,
               "warning: Slurm has {} tasks, but this run has one rank: start it with mpirun -n "
               "{}, or with srun --mpi=pmix\n",
               tasks, tasks);
}

} // namespace

double seconds_since_start() {
    static const Clock::time_point began = Clock::now(); // guarded_main() makes the first call
    return seconds_since(began);
}

int guarded_main(int argc, char** argv, MpiUse use,
                 const std::function<ExitCode(const Comm&)>& program) {
    seconds_since_start();
    secure_streams();
    // The ranks of a launcher are one program, of which rank 0 prints.
    const bool has_mpi = use == MpiUse::always || has_launcher();
    if (has_mpi && is_inside_of_rank()) {
        fmt::print(stderr,
                   "a rank of another MPI program has started this run, which cannot join it. {}\n",
                   remedy);
        return static_cast<int>(ExitCode::usage);
    }
    if (has_mpi && initialise_mpi(argc, argv) != MPI_SUCCESS) {
        fmt::print(stderr, "shearwake: MPI cannot be initialised\n");
        return static_cast<int>(ExitCode::environment);
    }
    const Comm world = Comm::world();
    int code = static_cast<int>(ExitCode::internal);
    try {
        require_one_run(world, argc, argv);
        warn_of_lone_tasks(world, argc, argv);
        choose_instruction_set(world);
        code = static_cast<int>(program(world));
    } catch (const UsageError& error) {
        // All ranks throw the same error; only the root prints it.
        if (world.is_root()) fmt::print(stderr, "{}\n", error_text(error.what()));
        code = static_cast<int>(error.code());
    } catch (const std::exception& error) {
        // The error occurred on this rank alone; other ranks may be waiting in a collective call.
        if (!std::ferror(stdout)) abort_all(world.rank(), with_causes(error));
    } catch (...) {
        abort_all(world.rank(), "an exception of unknown type");
    }
    code = world.max(with_output_written(code));
    if (has_mpi) MPI_Finalize();
    return code;
}

std::string mpi_version() {
    char text[MPI_MAX_LIBRARY_VERSION_STRING] = {};
    int length = 0;
    MPI_Get_library_version(text, &length);
    // Open MPI adds its package after a comma, MPICH "Version:", blanks, and its configuration in
    // further lines.
    std::istringstream words(std::string(text, std::strcspn(text, ",\n")));
    std::string version;
    for (std::string word; words >> word;)
        if (word != "Version:") version += (version.empty() ? "" : " ") + word;
    return version;
}

void sleeping_barrier(const Comm& comm) {
    comm.before_collective();
    if (comm.size() == 1) return;
    MPI_Request request = MPI_REQUEST_NULL;
    int code = MPI_Ibarrier(comm.raw(), &request);
    for (int done = 0; code == MPI_SUCCESS;) {
        code = MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done) return;
        Comm::mark_progress(); // waits on purpose
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    throw Error("MPI: a barrier cannot be completed");
}

} // namespace shearwake
