// What the reader of job files makes of any bytes: a job or a BadJob, never anything else.
#include "config/job.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        (void)shearwake::read_job(text, "fuzz.toml");
    } catch (const shearwake::UsageError&) {
    }
    return 0;
}
