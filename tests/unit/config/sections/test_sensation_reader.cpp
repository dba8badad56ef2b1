// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_sensation_reader {

using namespace shearwake;
using namespace shearwake::test;

TEST_CASE("a threshold is read from a file", "[config][sensation]") {
    const std::string csv = "# of a finger\nfrequency_Hz,acceleration_m_s2\n80,0.05\n100,0.04\n";
    const std::string job =
        plain_and("[measure]\nsensation = true\n[sensation]\nthreshold = \"t.csv\"\n");
    CHECK_FALSE(any_contains(diagnostics_with_file(job, csv), "error"));
    const std::string head = "frequency_Hz,acceleration_m_s2\n";
    const auto [text, said] = GENERATE(table<std::string, std::string>({
        {"f,a\n80,1\n", "line 1: must be the header"},
        {"H80,0\n", "line 2: must be two numbers above 0"},
        {"H80\n", "line 2: must be two numbers above 0"},
        {"H80,nan\n", "line 2: must be two numbers above 0"},
        {"H90,1\n", "line 2: 90 Hz is not the centre of a third octave"},
        {"H80,1\n125,1\n", "line 3: 125 Hz does not follow 80 Hz"},
        {"H80,1\n80,1\n", "line 3: 80 Hz does not follow 80 Hz"},
        {"H", "must be followed by at least one third octave"},
    }));
    CHECK(any_contains(
        diagnostics_with_file(job, text.front() == 'H' ? head + text.substr(1) : text), said));
}

TEST_CASE("the level of sensation is computed by default in the periodic regime",
          "[config][sensation]") {
    CHECK_FALSE(computes_sensation(only_case(plain_and(""))));
    CHECK(computes_sensation(only_case(plain_and("[measure]\nsensation = true\n"))));
    CHECK(case_id(only_case(plain_and("[measure]\nsensation = false\n"))) ==
          case_id(only_case(plain_and(""))));
    CHECK(any_contains(diagnostics_of(plain_and("[sensation]\nline_mm = [[0, 0], [1, 0]]\n")),
                       "applies only with measure.sensation = true"));
    CHECK(any_contains(diagnostics_of(plain_and("[measure]\nsensation = true\n[sensation]\n"
                                                "line_mm = [[0, 0], [0, 0]]\n")),
                       "must be two different points"));
}

} // namespace test_sensation_reader
