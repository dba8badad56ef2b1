// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/sleeping_barrier.hpp"

#include "base/error.hpp"

#include <chrono>
#include <thread>

namespace shearwake {

void sleeping_barrier(const Comm& comm) {
    comm.before_collective();
    MPI_Request request = MPI_REQUEST_NULL;
    int code = MPI_Ibarrier(comm.raw(), &request);
    for (int done = 0; code == MPI_SUCCESS;) {
        code = MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    throw Error("MPI: a barrier cannot be completed");
}

} // namespace shearwake
