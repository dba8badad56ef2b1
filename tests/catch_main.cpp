// SPDX-License-Identifier: BSD-3-Clause
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "simd/instruction_set.hpp"
#include "support/places.hpp"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <mpi.h>
#include <string>

const std::filesystem::path shearwake::test::data_folder = TEST_DATA;
const std::filesystem::path shearwake::test::jobs_folder = JOBS_DIRECTORY;

namespace {

/// Prints the name of each test that begins, so that the output of a hanging group ends with it.
class NameListener : public Catch::TestEventListenerBase {
public:
    using Base = Catch::TestEventListenerBase;
    using Base::Base;

    void testCaseStarting(const Catch::TestCaseInfo& info) override {
        Base::testCaseStarting(info);
        int rank = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        if (std::getenv("SHEARWAKE_NAME_TESTS") != nullptr)
            std::cerr << "rank " + std::to_string(rank) + ": " + info.name + "\n";
    }
};
CATCH_REGISTER_LISTENER(NameListener)

/// Rank 0 reports where it is asked to; the others print nothing, or write `<file>.<rank>` next to
/// it.
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
    if (const auto set = shearwake::simd::requested_instruction_set())
        shearwake::simd::use_instruction_set(*set);
    int verdict = session.applyCommandLine(argc, argv);
    if (verdict == 0) {
#if CATCH_VERSION_MAJOR < 3
        std::string& file = session.configData().outputFilename;
#else
        std::string& file = session.configData().defaultOutputFilename;
#endif
        file = report_of(rank, file);
        verdict = session.run();
    }
    verdict = std::clamp(verdict, 0, 255);
    int worst = 0;
    MPI_Allreduce(&verdict, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return worst;
}
