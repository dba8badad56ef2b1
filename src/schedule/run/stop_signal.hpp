// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shearwake::schedule {

/// Installs handlers by which SIGINT, SIGTERM and SIGUSR1 request an orderly stop: running cases
/// write a checkpoint, or are abandoned after 10 s if their engine has none, and no further cases
/// are started. A second signal ends the program immediately, except for a SIGUSR1 within two
/// seconds of the first.
void watch_for_stop_signals();

/// Whether this rank has received such a signal.
bool stop_requested();

} // namespace shearwake::schedule
