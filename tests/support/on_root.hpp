// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <map>
#include <thread>
#include <vector>
#include <mpi.h>

namespace shearwake::test {

/// This rank alone.
inline Comm alone() {
    return Comm::world().split(Comm::world().rank());
}

/// Calls f(team of one rank) on the root, while the other ranks sleep. Tests run more ranks than
/// the machine has cores: the same computation on every rank would take longer by the number of
/// ranks per core. Collective; rethrows on the root what f throws.
template <class F>
void on_root_alone(const Comm& world, F&& f) {
    const Comm alone = world.split(world.rank());
    std::exception_ptr error;
    if (world.is_root()) try {
            f(alone);
        } catch (...) {
            error = std::current_exception();
        }
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(world.raw(), &request);
    for (int done = 0; done == 0;) {
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (error) std::rethrow_exception(error);
}

/// Copies a map from the root to all ranks. Collective.
template <std::size_t size>
void broadcast(std::map<std::array<long, size>, std::vector<double>>& values, const Comm& world) {
    std::vector<long> keys;
    for (const auto& [key, value] : values)
        keys.insert(keys.end(), key.begin(), key.end());
    world.broadcast(keys);
    for (std::size_t n = 0; n < keys.size(); n += size) {
        std::array<long, size> key;
        std::copy_n(keys.data() + n, size, key.begin());
        world.broadcast(values[key]);
    }
}

} // namespace shearwake::test
