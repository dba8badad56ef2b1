// SPDX-License-Identifier: BSD-3-Clause
#include "base/python_module.hpp"

#include "base/error.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace shearwake {
namespace {

/// Replaces this process.
[[noreturn]] void replace_process(const std::vector<std::string>& command) {
    std::vector<char*> argv;
    for (const std::string& word : command)
        argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
}

/// Exit code of a child; -1 if it was killed.
int exit_code_of(pid_t child) {
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Makes the package importable by a child, if there is a folder. PYTHONSAFEPATH omits the working
/// folder, in which a file may have the name of a module.
void set_search_path(const std::filesystem::path& folder) {
    ::setenv("PYTHONSAFEPATH", "1", 1);
    if (folder.empty()) return;
    const char* own = std::getenv("PYTHONPATH");
    const std::string path = own && *own ? folder.string() + ":" + own : folder.string();
    ::setenv("PYTHONPATH", path.c_str(), 1);
}

/// Lets the kernel end this child when its parent ends, also by a signal.
void end_with_parent(pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127); // it had ended before
}

/// Exit code of a program run without a shell; -1 if it could not be started. The program receives
/// SIGTERM when this process ends.
int run_program(const std::vector<std::string>& command, const std::filesystem::path& modules,
                std::string* errors) {
    std::fflush(nullptr);
    std::array<int, 2> ends{-1, -1};
    if (errors && ::pipe(ends.data()) != 0) return -1;
    const pid_t self = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) {
        end_with_parent(self);
        if (errors) {
            ::dup2(ends[1], STDERR_FILENO);
            ::close(ends[0]);
            ::close(ends[1]);
        }
        set_search_path(modules);
        replace_process(command);
    }
    if (errors) {
        ::close(ends[1]);
        std::array<char, 4096> part{};
        for (ssize_t n = 0; child > 0 && (n = ::read(ends[0], part.data(), part.size())) > 0;)
            errors->append(part.data(), static_cast<std::size_t>(n));
        ::close(ends[0]);
    }
    return child < 0 ? -1 : exit_code_of(child);
}

/// "numpy, h5py and xxhash".
std::string all_of(const std::vector<std::string>& names) {
    return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

/// Why this Python cannot be used: the last line of its error; empty if it can.
std::string import_error(const std::string& python, const std::vector<std::string>& modules) {
    const std::string check = fmt::format(
        "import importlib.util, sys\n"
        "if sys.version_info < (3, 11): sys.exit('it is Python %d.%d, and 3.11 is needed' % "
        "sys.version_info[:2])\n"
        "for name in '{}'.split():\n"
        "    if importlib.util.find_spec(name) is None:\n" // an import takes ten times as long
        "        raise ModuleNotFoundError('No module named ' + repr(name))\n",
        fmt::join(modules, " "));
    std::string errors;
    if (run_program({python, "-c", check}, {}, &errors) == 0) return "";
    const auto end = errors.find_last_not_of(" \n");
    if (end == std::string::npos) return "it cannot be started";
    errors.resize(end + 1);
    return errors.substr(errors.rfind('\n') + 1);
}

/// The first Python that has the packages.
std::string find_python(const PythonPackages& packages) {
    std::vector<std::string> candidates = {"python3", "/usr/bin/python3"};
    if (const char* chosen = std::getenv("SHEARWAKE_PYTHON"))
        candidates.insert(candidates.begin(), chosen);
    std::vector<std::string> reasons;
    for (const std::string& python : candidates) {
        const std::string reason = import_error(python, packages.modules);
        if (reason.empty()) return python;
        reasons.push_back(python + ": " + reason);
    }
    throw UsageError(fmt::format("{} a Python with {} (Debian: {}); set SHEARWAKE_PYTHON to choose "
                                 "another Python\n  {}",
                                 packages.purpose, all_of(packages.modules), packages.debian,
                                 fmt::join(reasons, "\n  ")),
                     ExitCode::environment);
}

/// The folder analysis next to the build folder, or in share/shearwake next to the folder of an
/// installed program.
std::filesystem::path find_package() {
    const std::filesystem::path here =
        std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const std::filesystem::path folders[] = {here / "../analysis",
                                             here / "../share/shearwake/analysis"};
    for (const std::filesystem::path& candidate : folders)
        if (std::filesystem::exists(candidate / "shearwake"))
            return std::filesystem::canonical(candidate);
    throw UsageError(fmt::format("cannot find the Python package shearwake in {} or {}",
                                 folders[0].lexically_normal().string(),
                                 folders[1].lexically_normal().string()),
                     ExitCode::environment);
}

} // namespace

const PythonPackages table_packages = {
    "estimates of the error need", {"numpy", "h5py", "xxhash"}, "python3-h5py python3-xxhash"};
const PythonPackages figure_packages = {"figures need",
                                        {"numpy", "h5py", "matplotlib", "xxhash"},
                                        "python3-h5py python3-matplotlib python3-xxhash"};
const PythonPackages explorer_packages = {
    "explore needs",
    {"aiohttp", "numpy", "h5py", "xarray", "pandas", "tomli_w", "xxhash"},
    "python3-aiohttp python3-h5py python3-xarray "
    "python3-pandas python3-tomli-w python3-xxhash"};
const PythonPackages scan_packages = {"scans need",
                                      {"numpy", "h5py", "scipy", "matplotlib", "xxhash"},
                                      "python3-h5py python3-matplotlib python3-scipy "
                                      "python3-xxhash"};
const PythonPackages study_packages = {"optimise needs",
                                       {"numpy", "h5py", "scipy", "tomli_w", "xxhash"},
                                       "python3-h5py python3-scipy python3-tomli-w "
                                       "python3-xxhash"};
const PythonPackages device_packages = {"device files need", {"json", "numpy"}, "python3-numpy"};

void require_python(const PythonPackages& packages) {
    find_python(packages);
}

int run_python_module(const std::string& module, const std::vector<std::string>& arguments,
                      const PythonPackages& packages, std::string* errors) {
    std::vector<std::string> command = {find_python(packages), "-m", module};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run_program(command, find_package(), errors);
}

namespace {

volatile std::sig_atomic_t client_process = 0;

void interrupt_client(int) {
    if (client_process > 0) ::kill(client_process, SIGINT);
}

/// What a client changes before its module begins.
void prepare_client() {
    ::setpgid(0, 0); // a terminal interrupts this program only, which interrupts its client
    sigset_t blocked;
    ::sigemptyset(&blocked);
    ::sigaddset(&blocked, SIGINT);
    ::sigprocmask(SIG_BLOCK, &blocked, nullptr);
    std::signal(SIGINT, SIG_DFL);
    // Threads of small products of matrices would only compete with the ranks.
    for (const char* threads : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"})
        ::setenv(threads, "1", 0);
}

} // namespace

PythonClient::PythonClient(const std::string& module, const std::vector<std::string>& arguments,
                           const PythonPackages& packages) {
    std::vector<std::string> command = {find_python(packages), "-m", module};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const std::filesystem::path modules = find_package();
    std::array<int, 2> ends{-1, -1};
    std::fflush(nullptr);
    const pid_t self = ::getpid();
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0) child_ = ::fork();
    if (child_ < 0)
        throw UsageError(fmt::format("{} cannot be started: {}", module, std::strerror(errno)),
                         ExitCode::environment);
    if (child_ == 0) {
        end_with_parent(self);
        prepare_client();
        set_search_path(modules);
        command.push_back(fmt::format("--engine={}", ::dup(ends[1])));
        replace_process(command);
    }
    ::close(ends[1]);
    socket_ = ends[0];
    client_process = child_;
}

PythonClient::~PythonClient() {
    ::close(socket_);
    if (child_ <= 0) return;
    ::kill(child_, SIGTERM);
    exit_code();
}

std::optional<std::string> PythonClient::request(const std::function<bool()>& stops) {
    constexpr int patience_ms = 100;
    for (;;) {
        if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
            const std::string line = received_.substr(0, end);
            received_.erase(0, end + 1);
            return line;
        }
        if (stops()) return std::nullopt;
        pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
        if (::poll(&waiting, 1, patience_ms) <= 0) continue;
        std::array<char, 65536> block{};
        const ssize_t count = ::read(socket_, block.data(), block.size());
        if (count <= 0) return std::nullopt;
        received_.append(block.data(), static_cast<std::size_t>(count));
    }
}

void PythonClient::answer(const std::string& line) const {
    std::fflush(nullptr); // what the module prints next follows
    const std::string text = line + "\n";
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
        if (count <= 0) return; // it has ended, which request() reports
        sent += static_cast<std::size_t>(count);
    }
}

std::FILE* PythonClient::open_answers() const {
    return ::fdopen(::dup(socket_), "w");
}

void PythonClient::interrupt_by_signals() {
    struct sigaction action {};
    action.sa_handler = interrupt_client;
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU})
        ::sigaction(signal, &action, nullptr);
}

int PythonClient::exit_code() {
    const int code = child_ > 0 ? exit_code_of(child_) : -1;
    client_process = 0;
    child_ = -1;
    return code;
}

} // namespace shearwake
