// SPDX-License-Identifier: BSD-3-Clause
#include "base/cache.hpp"

#include "base/text.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace shearwake {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// That of fall_back_to_cache(), or empty.
fs::path& fallback() {
    static fs::path folder;
    return folder;
}

std::optional<fs::path> cache_folder() {
    if (!fallback().empty()) return fallback();
    const std::string own = variable("SHEARWAKE_CACHE");
    if (own == "off") return std::nullopt;
    if (!own.empty()) return own;
    if (const std::string xdg = variable("XDG_CACHE_HOME"); !xdg.empty())
        return fs::path(xdg) / "shearwake";
    if (const std::string home = variable("HOME"); !home.empty())
        return fs::path(home) / ".cache" / "shearwake";
    return std::nullopt;
}

/// Model name and CPU features from the first entry of /proc/cpuinfo; empty if it is not available.
std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    std::string description;
    for (std::string line; next_line(in, line) && !line.empty();)
        if (line.starts_with("model name") || line.starts_with("flags") ||
            line.starts_with("Features") || line.starts_with("CPU "))
            description += line + "\n";
    return description;
}

} // namespace

std::optional<fs::path> cache_file(const std::string& name) {
    const auto folder = cache_folder();
    if (!folder) return std::nullopt;
    return *folder / name;
}

std::string fall_back_to_cache(const fs::path& folder) {
    if (variable("SHEARWAKE_CACHE") == "off") return "";
    const std::optional<fs::path> usual = cache_folder();
    if (usual) {
        const fs::path trial = new_file_beside(*usual / "trial");
        std::error_code ignored;
        if (!trial.empty() && fs::remove(trial, ignored)) return "";
    }
    fallback() = folder;
    return (usual ? "the cache " + usual->string() + " cannot be written: "
                  : std::string("HOME is not set, so that the cache has no folder: ")) +
           folder.string() + " is used instead";
}

bool replace_cached(const fs::path& path, const std::string& text) {
    const fs::path part = new_file_beside(path);
    if (part.empty()) return false;
    std::ofstream out(part, std::ios::binary);
    out << text;
    out.close();
    std::error_code ignored;
    if (!out) {
        fs::remove(part, ignored);
        return false;
    }
    // mkstemp creates files with mode 0600; the cache folder may be shared by several users.
    fs::permissions(part, fs::perms(0644), ignored);
    std::error_code failed;
    fs::rename(part, path, failed);
    if (failed) fs::remove(part, ignored);
    return !failed;
}

std::string processor_key() {
    return hex(stable_hash(processor()));
}

std::string cached_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

fs::path new_file_beside(const fs::path& path) {
    std::error_code ignored;
    fs::create_directories(path.parent_path(), ignored);
    std::string name = path.string() + ".XXXXXX";
    const int file = ::mkstemp(name.data());
    if (file < 0) return {};
    ::close(file);
    return name;
}

} // namespace shearwake
