#include "sweep/stop_signal.hpp"

#include <csignal>
#include <initializer_list>

namespace shearwake {
namespace {

// The one global: a signal handler can reach nothing else.
volatile std::sig_atomic_t stop = 0;

void on_signal(int signal) {
    if (stop != 0 && signal != SIGUSR1) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    stop = 1;
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
