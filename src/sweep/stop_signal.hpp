#pragma once

namespace shearwake {

/// From now on SIGINT, SIGTERM and SIGUSR1 ask for an orderly stop: the running cases are saved
/// where they are, or finished where their engine cannot; no further ones are started. A second
/// one ends the program at once, but a SIGUSR1 within two seconds counts as the first one again.
void watch_for_stop_signals();

/// Whether one has come to this rank.
bool stop_requested();

} // namespace shearwake
