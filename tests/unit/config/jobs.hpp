// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/job.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::test {

/// A job without remarks, of one case that is quick to think about. Line numbers are part of the
/// tests below: add at the end.
constexpr std::string_view plain_job = R"(schema = 1
[job]
name = "plain"
[medium]
base = "rigid"
[[medium.layer]]
name = "tissue"
thickness_mm = 20.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 1.0
[load]
peak_Pa = 100.0
footprint = { shape = "gaussian", fwhm_mm = 3.0 }
[load.modulation]
kind = "AM-STM"
path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }
speed_m_s = 7.0
am_frequency_Hz = 500.0
[domain]
extent_mm = [96.0, 64.0]
spacing_mm = 0.75
[time]
duration_ms = 4.0
output_interval_us = 50.0
)";

/// `text` with the first `old` replaced; the test fails if it is not there.
inline std::string replaced(std::string_view text, std::string_view old, std::string_view by) {
    std::string out(text);
    const std::size_t at = out.find(old);
    REQUIRE(at != std::string::npos);
    return out.replace(at, old.size(), by);
}

inline std::string plain_with(std::string_view old, std::string_view by) {
    return replaced(plain_job, old, by);
}

inline std::string plain_and(std::string_view more) {
    return std::string(plain_job) + std::string(more);
}

/// The plain job with other text from `first` up to `last`.
inline std::string plain_from_to(std::string_view first, std::string_view last,
                                 std::string_view text) {
    const std::size_t begin = plain_job.find(first), end = plain_job.find(last);
    return std::string(plain_job.substr(0, begin)) + std::string(text) +
           std::string(plain_job.substr(end));
}

/// The plain job with another [medium].
inline std::string with_medium(std::string_view medium) {
    return plain_from_to("[medium]", "[load]", medium);
}

/// The plain job with another [load.modulation].
inline std::string with_modulation(std::string_view modulation) {
    return plain_from_to("kind =", "[domain]", fmt::format("{}\n", modulation));
}

/// Everything found in a job, good or bad, one text each.
inline std::vector<std::string> diagnostics_of(std::string_view job_text,
                                               std::vector<config::Override> overrides = {},
                                               const config::MapLoader& maps = nullptr,
                                               const config::TextLoader& files = nullptr) {
    std::vector<config::Diagnostic> diagnostics;
    try {
        diagnostics = config::read_job(job_text, "job.toml", overrides, maps, files).diagnostics;
    } catch (const config::BadJob& bad) {
        diagnostics = bad.diagnostics();
    }
    std::vector<std::string> texts;
    for (const config::Diagnostic& diagnostic : diagnostics)
        texts.push_back(config::text(diagnostic));
    return texts;
}

using Texts = std::vector<std::string>;

/// What is found in a job that names a file with this text.
inline Texts diagnostics_with_file(std::string_view job_text, const std::string& file) {
    return diagnostics_of(job_text, {}, nullptr, [&](const std::string&) { return file; });
}

/// "8:16 text" as the error at line 8, column 16, about a key that begins with `key`.
inline std::string error_at(const std::string& place_and_text, std::string_view key = "") {
    return "job.toml:" + replaced(place_and_text, " ", ": error: " + std::string(key));
}

inline bool any_contains(const Texts& texts, std::string_view part) {
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
        return text.find(part) != std::string::npos;
    });
}

/// A job has one diagnostic, which contains this text.
inline void check_only(const Texts& found, std::string_view part) {
    CAPTURE(found, part);
    REQUIRE(found.size() == 1);
    CHECK(any_contains(found, part));
}

/// The one case of a job.
inline Case only_case(std::string_view job_text, std::vector<config::Override> overrides = {}) {
    const config::Job job = config::read_job(job_text, "job.toml", overrides);
    REQUIRE(job.plan.cases.size() == 1);
    return job.plan.cases.front().physics;
}

} // namespace shearwake::test
