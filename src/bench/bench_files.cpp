// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "bench/bench.hpp"

#include "parallel/agree.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/checksum/file_checksum.hpp"
#include "storage/files.hpp"

#include <array>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <vector>

namespace shearwake::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t plane_side = 512, planes = 477; // 1.0 GB

/// Removes the bytes of a file from the page cache, so that they are read from the disk.
void forget_cached(const fs::path& path) {
    storage::flush_to_disk(path);
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    ::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
    ::close(fd);
}

/// Reads the file without processing its bytes.
void read_all(const fs::path& path) {
    std::vector<char> piece(std::size_t{1} << 18);
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) throw Error("cannot read " + path.string());
    ::posix_fadvise(fd, 0, 0, POSIX_FADV_SEQUENTIAL);
    while (::read(fd, piece.data(), piece.size()) > 0) {
    }
    ::close(fd);
}

/// Writes a case file with 1 GB of frames and returns the seconds of all frames and of the commit.
std::array<double, 2> write_frames(const fs::path& path, const Comm& world) {
    storage::SurfaceLayout layout{
        .domain = {plane_side, plane_side, 1e-3, 0.0}, .times_s = {}, .depths_m = {0.0}};
    for (std::ptrdiff_t n = 0; n < planes; ++n)
        layout.times_s.push_back(1e-3 * static_cast<double>(n));
    const std::ptrdiff_t begin = plane_side * world.rank() / world.size();
    const std::ptrdiff_t rows = plane_side * (world.rank() + 1) / world.size() - begin;
    const std::vector<double> plane(static_cast<std::size_t>(rows * plane_side), 1.5);
    const View2<const double> values(plane.data(), rows, plane_side);
    storage::CaseFileWriter writer(path, world, layout);
    const double frames_s = seconds_of(world, [&] {
        for (std::size_t n = 0; n < layout.times_s.size(); ++n)
            writer.write_surface(n, 0, values, begin);
        writer.flush();
    });
    return {frames_s, seconds_of(world, [&] { writer.commit({}, {}); })};
}

} // namespace

ExitCode bench_files(const Comm& world, Output& out) {
    const fs::path path = fs::path(".") / ".shearwake-bench.h5";
    const auto [frames_s, commit_s] = write_frames(path, world);
    double cached_s = 0.0, verify_s = 0.0, read_s = 0.0, bytes = 0.0;
    on_root(world, [&] {
        const auto seconds = [](const auto& work) {
            const auto began = Clock::now();
            work();
            return seconds_since(began);
        };
        const auto verify = [&] { storage::check_integrity(path); };
        cached_s = best_of(3, [&] { return seconds(verify); });
        read_s = best_of(3, [&] {
            forget_cached(path);
            return seconds([&] { read_all(path); });
        });
        verify_s = best_of(3, [&] {
            forget_cached(path);
            return seconds(verify);
        });
        bytes = static_cast<double>(fs::file_size(path));
        fs::remove(path);
    });
    if (!world.is_root()) return ExitCode::done;
    out.add("frames", bytes, "B");
    out.add("writing the frames", frames_s, "s");
    out.add("completing the file", commit_s, "s");
    out.add("checksum, cached file", cached_s, "s");
    out.add("verify from the disk", verify_s, "s");
    out.print("a case file with {:.2f} GB of frames, {} ranks, in this folder\n", bytes / 1e9,
              world.size());
    out.print("  writing the frames     {:8.2f} s   {:6.2f} GB/s\n", frames_s,
              bytes / frames_s / 1e9);
    out.print("  completing the file    {:8.2f} s   of which {:.2f} s for the checksum\n", commit_s,
              cached_s);
    out.print("  checksum, cached file  {:8.2f} s   {:6.2f} GB/s\n", cached_s,
              bytes / cached_s / 1e9);
    out.print("  verify from the disk   {:8.2f} s   {:6.2f} GB/s, {:.0f} % of reading it\n",
              verify_s, bytes / verify_s / 1e9, 100.0 * read_s / verify_s);
    return ExitCode::done;
}

} // namespace shearwake::bench
