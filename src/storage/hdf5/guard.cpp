// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/guard.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <initializer_list>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace shearwake::storage {
namespace {

void limit(__rlimit_resource resource, rlim_t most) {
    struct rlimit now {};
    if (::getrlimit(resource, &now) != 0) return;
    now.rlim_cur = std::min(now.rlim_max, most);
    ::setrlimit(resource, &now);
}

[[noreturn]] void try_out(const std::function<void()>& work, double seconds) {
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGUSR1})
        std::signal(signal, SIG_DFL);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(seconds) + 1);
    // A damaged file can also cause an infinite loop; the limit allows for busy machines.
    std::signal(SIGALRM, SIG_DFL);
    ::alarm(static_cast<unsigned>(10.0 * seconds));
    // Suppress error output of the child, which is of no use.
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    try {
        work();
    } catch (...) { // an exception is the expected result
    }
    ::_exit(0);
}

} // namespace

bool survives(const std::function<void()>& work, double seconds) {
    // Buffered output would otherwise be written by both processes.
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) return true;
    if (child == 0) try_out(work, seconds);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return true;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void must_survive(const std::filesystem::path& file, const std::function<void()>& read) {
    if (!survives(read))
        throw Error(file.string() + " is damaged in a way that crashes the HDF5 library");
}

} // namespace shearwake::storage
