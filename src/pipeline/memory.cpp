// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/memory.hpp"

#include "measures/sensation.hpp"
#include "measures/spectrum.hpp"
#include "measures/window.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/surface_recorder.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <limits>
#include <sys/resource.h>
#include <unistd.h>

namespace shearwake::pipeline {

namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

double number_in(const std::filesystem::path& path) {
    std::ifstream file(path);
    double value = 0.0;
    return file >> value ? value : unknown; // "max", or no such file
}

/// MemAvailable of the machine.
double available_B() {
    std::ifstream info("/proc/meminfo");
    for (std::string key; info >> key;) {
        double kB = 0.0;
        std::string unit;
        if (!(info >> kB)) break;
        std::getline(info, unit);
        if (key == "MemAvailable:") return 1024.0 * kB;
    }
    return unknown;
}

/// The memory that Slurm grants to all ranks on this machine, in MiB in its variables; 0 grants
/// all.
double granted_by_slurm_B() {
    const auto value = [](const char* name) {
        const char* text = std::getenv(name);
        const double number = text ? std::strtod(text, nullptr) : 0.0;
        return number > 0.0 ? number : unknown;
    };
    return 1048576.0 * std::min(value("SLURM_MEM_PER_NODE"),
                                value("SLURM_MEM_PER_CPU") * value("SLURM_CPUS_ON_NODE"));
}

/// The memory that `ulimit -v` leaves to this program.
double left_of_own_limit_B() {
    struct rlimit limit {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
    const double pages = number_in("/proc/self/statm"); // the first number is the mapped memory
    const double used = pages < unknown ? pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) : 0;
    return std::max(static_cast<double>(limit.rlim_cur) - used, 0.0);
}

} // namespace

double left_in_group_B(std::istream& groups, const std::filesystem::path& root) {
    double left = unknown;
    for (std::string line; std::getline(groups, line);) { // number:controllers:path
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const bool has_version_2 = controllers == ",,";
        if (!has_version_2 && controllers.find(",memory,") == std::string::npos) continue;
        const std::filesystem::path top = has_version_2 ? root : root / "memory";
        std::filesystem::path group = (top / line.substr(second + 2)).lexically_normal();
        for (int depth = 0; depth < 32 && group.string().starts_with(top.string()); ++depth) {
            const double limit =
                number_in(group / (has_version_2 ? "memory.max" : "memory.limit_in_bytes"));
            if (limit < unknown) {
                const double used =
                    number_in(group / (has_version_2 ? "memory.current" : "memory.usage_in_bytes"));
                left = std::min(left, limit - (used < unknown ? used : 0.0));
            }
            group = group.parent_path();
        }
    }
    return std::max(left, 0.0);
}

double memory_per_rank_B(const Comm& world) {
    const Comm machine = world.split_by_machine();
    std::ifstream groups("/proc/self/cgroup");
    const double shared =
        std::min({available_B(), left_in_group_B(groups, "/sys/fs/cgroup"), granted_by_slurm_B()}) /
        machine.size();
    return world.min(std::min(shared, left_of_own_limit_B()));
}

double peak_memory_B() {
    struct rusage usage {};
    return ::getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * static_cast<double>(usage.ru_maxrss)
                                                 : 0.0;
}

namespace {

/// Superblock, groups, about seventy variables with names, units and notes, attributes with the
/// job.
constexpr double empty_file_B = 28e3;
constexpr double of_group_B = 6e3; // size of a further group

bool has_mean(const Case& c) {
    return measures::period_window(c.measure, c.time,
                                   modulation_frequency_Hz(c.scene.load.modulation),
                                   off_time_s(c.scene.load.modulation.trajectory))
        .fits();
}

/// Time in ns of one core: of the results, journal and file of a case, of a byte of the file, and
/// of an operation of receptors_work().
constexpr double case_ns = 8e7, byte_ns = 25.0, receptor_ns = 2.0;

/// Size of the case file in bytes, including the overhead of HDF5; `engine_B` of it is written by
/// the engine.
double case_file_B(const Case& c, const std::shared_ptr<const neural::Scene>& receptors,
                   double engine_B) {
    const double plane = static_cast<double>(c.domain.nx * c.domain.ny);
    const double depths = static_cast<double>(c.measure.depths_m.size());
    const double frames = static_cast<double>(c.time.frames);
    const double traces = static_cast<double>(c.record.traces_m.size());
    const double stored_frames = static_cast<double>(recorded_frames(c).size());
    double numbers = (4.0 + 12.0 * depths) * frames + depths * stored_frames * plane;
    double groups = 0.0;
    if (traces > 0.0) {
        const double spectrum = static_cast<double>(measures::trace_frequencies_Hz(c.time).size());
        numbers += (traces + 1.0) * (frames + spectrum);
        groups += 1.0;
    }
    if (has_mean(c)) {
        numbers += plane;
        groups += 1.0;
    }
    if (computes_sensation(c)) {
        const measures::Region region = measures::measured_region(c.domain, c.measure);
        numbers += 2.0 * static_cast<double>((region.x1 - region.x0) * (region.y1 - region.y0));
        groups += 1.0;
    }
    if (c.afferents) groups += 3.0;
    if (!c.record.volumes_s.empty()) groups += 1.0;
    return empty_file_B + groups * of_group_B + numbers * sizeof(double) + engine_B +
           (receptors ? afferents_file_B(c, *receptors) : 0.0);
}

/// The data of the recorder.
std::vector<engines::Allocation> arrays_of_recorder(const Case& c, int ranks) {
    const double plane =
        static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny) * sizeof(double);
    // Slabs of the surface at the instant and of its mean energy, the complete planes on rank 0,
    // and another plane for the sharpness.
    double planes = 2.0 * plane / ranks + 3.0 * plane;
    if (!c.record.volumes_s.empty()) planes += plane / ranks; // transposed for the file
    std::vector<engines::Allocation> arrays = {{"planes of the recorder", planes}};
    if (const double sensation_B = measures::sensation_memory_B(c, ranks); sensation_B > 0.0)
        arrays.push_back({"lines of the level of sensation", sensation_B});
    if (!c.vibrometer) return arrays;
    // Displacements on each rank, velocities on rank 0.
    const double rate_Hz = std::max(c.vibrometer->rate_Hz, 1.0 / c.time.interval_s);
    arrays.push_back(
        {"signals of the vibrometer",
         static_cast<double>(c.vibrometer->points_m.size()) * sizeof(double) *
             (static_cast<double>(c.time.frames) + 2.0 * rate_Hz * c.time.duration_s())});
    return arrays;
}

} // namespace

CasePlan plan_case(const Case& c, int ranks, const engines::FrameSource& engine) {
    CasePlan plan{.receptors = receptors_of(c), .needs = engine.resources(c, ranks)};
    engines::Resources& all = plan.needs;
    all.written_B = case_file_B(c, plan.receptors, all.written_B);
    for (const engines::Allocation& array : arrays_of_recorder(c, ranks))
        all.arrays.push_back(array);
    if (plan.receptors) {
        all.arrays.push_back({"receptors", afferents_memory_B(c, *plan.receptors, ranks)});
        all.work += receptor_ns * receptors_work(c, *plan.receptors);
    }
    all.work += case_ns + byte_ns * all.written_B;
    return plan;
}

std::string size_error(const std::string& job_text, const Case& c) {
    constexpr double largest_planes_B = 1e12; // beyond the memory of any machine
    // The names, positions and numbers of more traces would not fit into the text of a case.
    constexpr std::size_t most_traces = 10000;
    if (job_text.size() > h5::largest_text)
        return fmt::format("the job has {} kB, but case files can store at most {} kB of its text; "
                           "move points and traces to separate files",
                           job_text.size() / 1000, h5::largest_text / 1000);
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    const double numbers = points + static_cast<double>(c.time.frames) *
                                        (1.0 + static_cast<double>(c.record.traces_m.size()));
    if (8.0 * numbers > largest_planes_B)
        return fmt::format("domain and time: a plane of {} x {} points, {} frames and {} traces "
                           "require {:.3g} GB on one rank; at most {:.3g} GB are possible",
                           c.domain.nx, c.domain.ny, c.time.frames, c.record.traces_m.size(),
                           8e-9 * numbers, 1e-9 * largest_planes_B);
    if (c.record.traces_m.size() > most_traces)
        return fmt::format("record.traces_mm: has {} traces; at most {} are possible",
                           c.record.traces_m.size(), most_traces);
    if (const std::size_t length = canonical_text(c).size(); length > h5::largest_text)
        return fmt::format("the description of a case has {} kB, but case files can store at most "
                           "{} kB; use fewer layers, bodies, traces, bands, foci or points",
                           length / 1000, h5::largest_text / 1000);
    return {};
}

std::string memory_text(const engines::Resources& needs) {
    std::vector<engines::Allocation> all = needs.arrays;
    all.push_back({"program", engines::program_B});
    std::ranges::stable_sort(all, std::greater<>{}, &engines::Allocation::bytes);
    std::string text = fmt::format("memory per rank: {:.1f} MB", needs.memory_per_rank_B() / 1e6);
    const char* before = ": ";
    for (const engines::Allocation& array : all) {
        if (array.bytes < 5e4) break;
        text += fmt::format("{}{} {:.1f}", before, array.name, array.bytes / 1e6);
        before = ", ";
    }
    return text;
}

} // namespace shearwake::pipeline
