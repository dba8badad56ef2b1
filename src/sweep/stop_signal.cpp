#include "sweep/stop_signal.hpp"

#include <csignal>
#include <ctime>
#include <initializer_list>

namespace shearwake {
namespace {

// The one global: a signal handler can reach nothing else.
volatile std::sig_atomic_t stop = 0;

volatile std::sig_atomic_t second = 0; // when the last one came

/// Seconds of a clock that nobody sets; it may be asked in a handler.
std::sig_atomic_t now_s() {
    struct timespec now {};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::sig_atomic_t>(now.tv_sec);
}

void on_signal(int signal) {
    // A batch system, its script and mpirun may all pass on one and the same SIGUSR1.
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

} // namespace shearwake
