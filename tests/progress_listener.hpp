// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <catch2/catch.hpp>

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <mpi.h>
#include <string>
#include <unistd.h>

/// Reports the progress of the tests to the file that SHEARWAKE_TEST_PROGRESS names, for
/// scripts/test_runner/progress.py, which describes the lines. Reports nothing without that
/// variable. Needs MPI to be initialised; every rank writes a file of its own. Collective: no.
class ProgressListener : public Catch::TestEventListenerBase {
    using Base = Catch::TestEventListenerBase;

public:
    using Base::Base;

    // The base class keeps account of what is running and needs every call.
    void testRunStarting(const Catch::TestRunInfo& info) override {
        Base::testRunStarting(info);
        const char* stem = std::getenv("SHEARWAKE_TEST_PROGRESS");
        if (stem == nullptr) return;
        int rank = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        const std::string path = rank == 0 ? stem : std::string(stem) + "." + std::to_string(rank);
        file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
        report("total " + std::to_string(count_tests()));
    }
    void testCaseStarting(const Catch::TestCaseInfo& info) override {
        Base::testCaseStarting(info);
        name_ = info.name;
        report("begin " + name_);
    }
    void testCaseEnded(const Catch::TestCaseStats& stats) override {
        report("end " + name_);
        Base::testCaseEnded(stats);
    }
    void sectionStarting(const Catch::SectionInfo& info) override {
        Base::sectionStarting(info);
        report_life();
    }
    /// Before every assertion, and also when it passes: assertionEnded is left out then.
    void assertionStarting(const Catch::AssertionInfo&) override { report_life(); }

private:
    using Clock = std::chrono::steady_clock;

    std::size_t count_tests() const {
        const auto& all = Catch::getAllTestCasesSorted(*m_config);
        if (m_config->hasTestFilters())
            return Catch::filterTests(all, m_config->testSpec(), *m_config).size();
        std::size_t shown = 0;
        for (const Catch::TestCase& test : all)
            shown += test.getTestCaseInfo().isHidden() ? 0 : 1;
        return shown;
    }

    void report_life() {
        if (Clock::now() - reported_ > std::chrono::seconds(1)) report("alive");
    }

    /// A failed write costs the line; the runner then sees no progress and ends the group.
    void report(const std::string& line) {
        if (file_ < 0) return;
        const std::string text = line + "\n";
        [[maybe_unused]] const ssize_t written = ::write(file_, text.data(), text.size());
        reported_ = Clock::now();
    }

    std::string name_; // of the running test case
    int file_ = -1;    // open to the end of the process
    Clock::time_point reported_;
};
