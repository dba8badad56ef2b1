// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace shearwake {

/// Files with data that is measured once per machine (FFTW plans, rates). The cache is
/// optional: none of these functions throws when the file system refuses an operation. Not
/// collective.

/// Path ${SHEARWAKE_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/shearwake}/<name>, or nothing if caching
/// is disabled (SHEARWAKE_CACHE=off) or no home folder is set.
std::optional<std::filesystem::path> cache_file(const std::string& name);

/// Uses `folder` for the rest of the program if the usual folder of the cache cannot be written,
/// and returns a sentence that says so; otherwise empty. No effect if caching is disabled.
std::string fall_back_to_cache(const std::filesystem::path& folder);

/// Contents of the file; empty if it does not exist.
std::string cached_text(const std::filesystem::path& path);

/// Creates an empty file with a unique name in the same folder as `path`, and the folder if
/// necessary. Returns an empty path on failure.
std::filesystem::path new_file_beside(const std::filesystem::path& path);

/// Writes a temporary file next to `path` and renames it, so that concurrent readers see either the
/// old or the new text. Returns whether this succeeded.
bool replace_cached(const std::filesystem::path& path, const std::string& text);

/// Hash of the CPU's model name and instruction sets: 16 hexadecimal digits.
std::string processor_key();

} // namespace shearwake
