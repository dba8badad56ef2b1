#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <algorithm>
#include <mpi.h>
#include <string>

namespace {

/// Rank 0 reports where it is asked to; the others say nothing, or write `<file>.<rank>` beside it.
std::string report_of(int rank, const std::string& file) {
    if (rank == 0) return file;
    return file.empty() ? "/dev/null" : file + "." + std::to_string(rank);
}

} // namespace

/// Runs the same tests on every rank; the worst verdict is everybody's.
int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    Catch::Session session;
    int verdict = session.applyCommandLine(argc, argv);
    if (verdict == 0) {
        std::string& file = session.configData().outputFilename;
        file = report_of(rank, file);
        verdict = session.run();
    }
    verdict = std::clamp(verdict, 0, 255);
    int worst = 0;
    MPI_Allreduce(&verdict, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return worst;
}
