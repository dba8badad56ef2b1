#include "fft/wisdom.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "parallel/agree.hpp"

#include <cstdlib>
#include <fftw3.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <unistd.h>

namespace shearwake {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::optional<fs::path> cache_folder() {
    const std::string own = variable("SHEARWAKE_CACHE");
    if (own == "off") return std::nullopt;
    if (!own.empty()) return own;
    if (const std::string xdg = variable("XDG_CACHE_HOME"); !xdg.empty())
        return fs::path(xdg) / "shearwake";
    if (const std::string home = variable("HOME"); !home.empty())
        return fs::path(home) / ".cache" / "shearwake";
    return std::nullopt;
}

std::string content(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Model and abilities of the first processor; empty where the system does not tell.
std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    std::string told;
    for (std::string line; std::getline(in, line) && !line.empty();)
        if (line.starts_with("model name") || line.starts_with("flags") ||
            line.starts_with("Features") || line.starts_with("CPU "))
            told += line + "\n";
    return told;
}

/// The wisdom of one of FFTW's libraries.
struct Wisdom {
    void (*forget)();
    int (*import_from)(const char*);
    char* (*export_to_text)();
    void (*release)(void*);

    std::string exported() const {
        const std::unique_ptr<char, void (*)(void*)> text(export_to_text(), release);
        return text ? std::string(text.get()) : "";
    }
};

Wisdom wisdom_of(Precision precision) {
    if (precision == Precision::in_single)
        return {fftwf_forget_wisdom, fftwf_import_wisdom_from_string, fftwf_export_wisdom_to_string,
                fftwf_free};
    return {fftw_forget_wisdom, fftw_import_wisdom_from_string, fftw_export_wisdom_to_string,
            fftw_free};
}

// FFTW knows damaged words itself, so that a file needs no checksum: of 831 copies with one
// character altered it refused 814 and made the same plan from 17.
bool make_from(const std::string& words, const MakePlans& make, const Wisdom& wisdom) {
    wisdom.forget();
    return !words.empty() && wisdom.import_from(words.c_str()) != 0 &&
           make(FFTW_MEASURE | FFTW_WISDOM_ONLY);
}

/// A new empty file beside `path`; empty when the folder does not take one.
fs::path file_beside(const fs::path& path) {
    std::error_code ignored;
    fs::create_directories(path.parent_path(), ignored);
    std::string name = path.string() + ".XXXXXX";
    const int file = ::mkstemp(name.data());
    if (file < 0) return {};
    ::close(file);
    return name;
}

/// Gives `part` its final name unless there is a good file of that name already.
void publish_first(const fs::path& part, const fs::path& path, bool replace) {
    std::error_code failed;
    // mkstemp's files are for their owner alone; a folder may serve several users.
    fs::permissions(part, fs::perms(0644), failed);
    if (!replace) {
        fs::create_hard_link(part, path, failed); // fails where the name is taken
        std::error_code ignored;
        if (failed && !fs::exists(path, ignored)) replace = true; // a file system without links
    }
    if (replace) fs::rename(part, path, failed);
    fs::remove(part, failed);
}

/// The words of the file, learnt now if there are none that lead to plans; empty when no file can
/// be kept. On rank 0 alone.
std::string recall_or_learn(const fs::path& path, const MakePlans& make, const Wisdom& wisdom) {
    std::error_code ignored;
    // Files appear whole, so what was there before reading and is of no use is damaged; what
    // another program brings from now on is not.
    const bool damaged = fs::exists(path, ignored);
    std::string words = content(path);
    if (make_from(words, make, wisdom)) return words;
    const fs::path part = file_beside(path); // first: measuring is in vain if it cannot be kept
    if (part.empty()) return "";
    wisdom.forget();
    const bool made = make(FFTW_MEASURE);
    std::ofstream out(part, std::ios::binary);
    out << wisdom.exported();
    out.close();
    if (made && out)
        publish_first(part, path, damaged);
    else
        fs::remove(part, ignored);
    words = content(path);
    return make_from(words, make, wisdom) ? words : "";
}

} // namespace

std::optional<fs::path> wisdom_file(const std::string& shape) {
    const auto folder = cache_folder();
    if (!folder) return std::nullopt;
    return *folder /
           (std::string(fftw_version) + "-" + hex(stable_hash(processor())) + "-" + shape);
}

void plan_estimated(const MakePlans& make, Precision precision) {
    const Wisdom wisdom = wisdom_of(precision);
    // FFTW_ESTIMATE, too, follows wisdom where there is any.
    wisdom.forget();
    if (!make(FFTW_ESTIMATE)) throw Error("FFTW refused to make a plan");
    wisdom.forget();
}

void plan_measured(const Comm& team, const std::string& shape, const MakePlans& make,
                   Precision precision) {
    const Wisdom wisdom = wisdom_of(precision);
    std::string words;
    on_root(team, [&] {
        if (const auto path = wisdom_file(shape)) words = recall_or_learn(*path, make, wisdom);
    });
    words = team.broadcast(words);
    const bool made = team.is_root() ? !words.empty() : make_from(words, make, wisdom);
    if (team.max(made ? 0 : 1) == 1) return plan_estimated(make, precision);
    wisdom.forget();
}

} // namespace shearwake
