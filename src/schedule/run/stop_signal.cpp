// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/stop_signal.hpp"

#include <csignal>
#include <ctime>
#include <initializer_list>

namespace shearwake::schedule {
namespace {

// Global, since a signal handler can access nothing else.
volatile std::sig_atomic_t stop = 0;

volatile std::sig_atomic_t second = 0; // time of the last signal

/// Seconds of a monotonic clock, which a signal handler may read.
std::sig_atomic_t now_s() {
    struct timespec now {};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::sig_atomic_t>(now.tv_sec);
}

void on_signal(int signal) {
    // The batch system, its script and mpirun may all forward the same SIGUSR1.
    const bool repeated = signal == SIGUSR1 && now_s() - second <= 2;
    if (stop != 0 && !repeated) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    stop = 1;
    second = now_s();
}

} // namespace

void watch_for_stop_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1})
        std::signal(signal, on_signal);
}

bool stop_requested() {
    return stop != 0;
}

} // namespace shearwake::schedule
