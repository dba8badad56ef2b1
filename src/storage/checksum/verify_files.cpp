// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/checksum.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <system_error>
#include <thread>

namespace shearwake::storage {

namespace {

/// More threads would make disks seek.
constexpr unsigned most_threads = 4;

double size_of(const std::filesystem::path& path) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(path, error);
    return error ? 0.0 : static_cast<double>(bytes);
}

VerifiedFile verify(const std::filesystem::path& path) {
    try {
        return {check_integrity(path), ""};
    } catch (const std::exception& error) { // including failed allocations
        return {{}, error.what()};
    }
}

} // namespace

std::vector<VerifiedFile> verify_files(const std::vector<std::filesystem::path>& files,
                                       const std::function<void(const VerifyProgress&)>& report) {
    std::vector<VerifiedFile> verified(files.size());
    VerifyProgress progress{.all_files = files.size()};
    for (const auto& file : files)
        progress.all_bytes += size_of(file);
    std::atomic<std::size_t> next{0};
    std::mutex report_mutex;
    const auto work = [&] {
        for (std::size_t i = next++; i < files.size(); i = next++) {
            verified[i] = verify(files[i]);
            const std::scoped_lock lock(report_mutex);
            ++progress.files;
            progress.bytes += static_cast<double>(verified[i].check.bytes);
            if (report) report(progress);
        }
    };
    const std::size_t threads = std::min<std::size_t>(
        files.size(), std::clamp(std::thread::hardware_concurrency(), 1U, most_threads));
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < threads; ++i) {
        try {
            others.emplace_back(work);
        } catch (const std::system_error&) { // no more threads can be created
            break;
        }
    }
    work();
    others.clear(); // joins the threads
    return verified;
}

} // namespace shearwake::storage
