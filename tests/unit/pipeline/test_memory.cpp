// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/memory.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

namespace test_memory {

using namespace shearwake;
namespace fs = std::filesystem;

static void write(const fs::path& file, const char* text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

TEST_CASE("control groups of both versions limit the memory, as do their parents", "[memory]") {
    const test::TemporaryFolder folder;
    const fs::path root = folder / "groups";
    const auto left_B = [&](const char* groups) {
        std::istringstream text(groups);
        return pipeline::left_in_group_B(text, root);
    };
    CHECK(std::isinf(left_B("")));
    CHECK(std::isinf(left_B("0::/job/step\n9:memory:/slurm/job\nno group\n")));

    write(root / "job/step/memory.max", "max");
    write(root / "job/memory.max", "5000");
    write(root / "job/memory.current", "2000");
    CHECK(left_B("0::/job/step\n") == 3000.0);

    write(root / "memory/slurm/job/memory.limit_in_bytes", "4000");
    write(root / "memory/slurm/job/memory.usage_in_bytes", "1500");
    CHECK(left_B("12:pids:/slurm/job\n9:cpuset,memory:/slurm/job\n0::/job/step\n") == 2500.0);
    write(root / "memory/slurm/memory.limit_in_bytes", "1000");
    CHECK(left_B("9:memory:/slurm/job/step/with spaces\n") == 1000.0);
    write(root / "memory/slurm/memory.usage_in_bytes", "1001"); // a group may exceed its limit
    CHECK(left_B("9:memory:/slurm/job\n") == 0.0);
}

} // namespace test_memory
