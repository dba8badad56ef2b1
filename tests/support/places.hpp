// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace shearwake::test {

// The only file that contains these paths is catch_main.cpp: all others have the same object in
// every folder, so that ccache finds it.
extern const std::filesystem::path data_folder; // tests/data
extern const std::filesystem::path jobs_folder; // jobs

} // namespace shearwake::test
