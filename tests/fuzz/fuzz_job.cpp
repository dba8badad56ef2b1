// SPDX-License-Identifier: BSD-3-Clause
// For arbitrary bytes, the reader of job files must return a job or throw BadJob.
#include "config/job.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        (void)shearwake::config::read_job(text, "fuzz.toml");
    } catch (const shearwake::UsageError&) {
    }
    return 0;
}
