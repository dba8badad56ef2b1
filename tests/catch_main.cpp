#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <algorithm>
#include <mpi.h>

/// Runs the same tests on every rank; only rank 0 reports, and the worst verdict is everybody's.
int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    Catch::Session session;
    int verdict = session.applyCommandLine(argc, argv);
    if (verdict == 0) {
        if (rank != 0) session.configData().outputFilename = "/dev/null";
        verdict = session.run();
    }
    verdict = std::clamp(verdict, 0, 255);
    int worst = 0;
    MPI_Allreduce(&verdict, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return worst;
}
