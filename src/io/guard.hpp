#pragma once

#include <filesystem>
#include <functional>

namespace shearwake {

/// Whether `work` comes to an end, with or without an exception: tried out in a copy of this
/// process that is thrown away. HDF5 1.10 breaks down on some damaged and hostile files, which no
/// check before it can tell. The copy has the same memory, so whatever it has survived this process
/// does as well, if it does the same next. `seconds`: of computing, after which it counts as not
/// surviving. Where no copy can be made everything survives. Not collective; `work` must not
/// communicate.
bool survives(const std::function<void()>& work, double seconds = 60.0);

/// Throws Error when `read` does not survive the file.
void must_survive(const std::filesystem::path& file, const std::function<void()>& read);

} // namespace shearwake
