// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace shearwake {

/// What a group of modules needs.
struct PythonPackages {
    std::string purpose; // for messages: "figures"
    std::vector<std::string> modules;
    std::string debian; // the packages that contain them
};
extern const PythonPackages table_packages, figure_packages, explorer_packages, scan_packages,
    study_packages, device_packages;

/// Begins the name of a file of load.modulation.kind = "file" in requests to the loader of texts.
inline const std::string played_file = "played:";

/// Throws UsageError if no Python has the packages. Not collective.
void require_python(const PythonPackages& packages);

/// Runs `python3 -m module`, such as "shearwake.report", with the first Python that has the
/// packages, and returns its exit code (-1: it could not be started). `errors`: receives the
/// standard error of the module, which is printed otherwise. Throws UsageError if this Python
/// or the package is missing. Not collective: rank 0 calls it.
int run_python_module(const std::string& module, const std::vector<std::string>& arguments,
                      const PythonPackages& packages = figure_packages,
                      std::string* errors = nullptr);

/// A module that runs beside this process and requests work from it over a socket. It ends with
/// this object, and starts with SIGINT blocked. One at a time. Not collective: rank 0 owns it.
class PythonClient {
public:
    /// The last argument of the module is --engine=N, the descriptor of its end of the socket.
    /// Throws UsageError (environment) if Python, its packages or the module are missing.
    PythonClient(const std::string& module, const std::vector<std::string>& arguments,
                 const PythonPackages& packages);
    ~PythonClient();
    PythonClient(const PythonClient&) = delete;
    PythonClient& operator=(const PythonClient&) = delete;

    /// The descriptor of requests, and a stream for answers that the caller closes.
    int requests() const { return socket_; }
    std::FILE* open_answers() const;
    /// Waits for the next line; none when the module has ended, or `stops` returns true.
    std::optional<std::string> request(const std::function<bool()>& stops);
    void answer(const std::string& line) const;
    /// Waits for its end; -1 if it was killed.
    int exit_code();
    /// The first signal that requests a stop of this process interrupts its client, if it has one.
    static void interrupt_by_signals();

private:
    pid_t child_ = -1;
    int socket_ = -1;
    std::string received_;
};

} // namespace shearwake
