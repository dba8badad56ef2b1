// SPDX-License-Identifier: BSD-3-Clause
#include "fft/wisdom.hpp"

#include "base/cache.hpp"
#include "base/error.hpp"
#include "parallel/agree.hpp"

#include <fftw3-mpi.h>
#include <fstream>
#include <memory>

namespace shearwake::fft {
namespace {

namespace fs = std::filesystem;

/// Access to the wisdom of one of the two FFTW libraries.
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

// FFTW detects damaged wisdom itself, so the file needs no checksum: of 831 copies with one altered
// character it rejected 814 and created the same plan from the other 17.
bool make_from(const std::string& text, const MakePlans& make, const Wisdom& wisdom) {
    wisdom.forget();
    return !text.empty() && wisdom.import_from(text.c_str()) != 0 &&
           make(FFTW_MEASURE | FFTW_WISDOM_ONLY);
}

/// Renames `part` to `path`. Unless `replace` is set, an existing file is kept.
void publish_first(const fs::path& part, const fs::path& path, bool replace) {
    std::error_code failed;
    // mkstemp creates files with mode 0600; the cache folder may be shared by several users.
    fs::permissions(part, fs::perms(0644), failed);
    if (!replace) {
        fs::create_hard_link(part, path, failed); // fails if the file exists
        std::error_code ignored;
        // Fall back to renaming on file systems without links.
        if (failed && !fs::exists(path, ignored)) replace = true;
    }
    if (replace) fs::rename(part, path, failed);
    fs::remove(part, failed);
}

/// Loads wisdom from the file, or measures plans and writes the file. Returns the text of the file,
/// from which the plans were created, or an empty text if no file can be kept. Only called on rank
/// 0.
std::string load_or_measure(const fs::path& path, const MakePlans& make, const Wisdom& wisdom) {
    std::error_code ignored;
    // Files are created complete. A file that existed before reading and is unusable must therefore
    // be damaged; a file that another process creates from now on is valid.
    const bool damaged = fs::exists(path, ignored);
    std::string text = cached_text(path);
    if (make_from(text, make, wisdom)) return text;
    // Create the file first: without it the measurement would be discarded.
    const fs::path part = new_file_beside(path);
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
    text = cached_text(path);
    return make_from(text, make, wisdom) ? text : "";
}

} // namespace

std::optional<fs::path> wisdom_file(const std::string& shape) {
    return cache_file(std::string(fftw_version) + "-" + processor_key() + "-" + shape);
}

void plan_estimated(const MakePlans& make, Precision precision) {
    const Wisdom wisdom = wisdom_of(precision);
    // FFTW_ESTIMATE also uses wisdom if there is any.
    wisdom.forget();
    if (!make(FFTW_ESTIMATE)) throw Error("FFTW could not create a plan");
    wisdom.forget();
}

void plan_measured(const Comm& team, const std::string& shape, const MakePlans& make,
                   Precision precision) {
    // FFTW rejects wisdom of a process with other algorithms. The MPI part adds some; without it in
    // every process the plans would be measured again, and have other bits, after each change.
    fftw_mpi_init();
    const Wisdom wisdom = wisdom_of(precision);
    std::string text;
    on_root(team, [&] {
        if (const auto path = wisdom_file(shape)) text = load_or_measure(*path, make, wisdom);
    });
    text = team.broadcast(text);
    const bool made = team.is_root() ? !text.empty() : make_from(text, make, wisdom);
    if (!team.all(made)) return plan_estimated(make, precision);
    wisdom.forget();
}

} // namespace shearwake::fft
