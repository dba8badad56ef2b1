// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <hdf5.h>
#include <limits>

namespace shearwake::storage {
namespace {

using Cells = std::vector<std::string>;

constexpr std::size_t most_values = 8'000'000; // of a CSV file

double number(std::string_view text, std::size_t line) {
    const auto value = number_in(text);
    if (!value) throw UsageError(fmt::format("line {}: \"{:.40}\" is not a number", line, text));
    return *value;
}

/// The SI factor of the unit at the end of the name of a column.
double unit(std::string_view name, std::string_view quantity, std::string_view example,
            std::size_t line) {
    const auto found = unit_of(name);
    if (!found || found->quantity != quantity)
        throw UsageError(fmt::format("line {}: \"{:.40}\" must end in a unit of {}, as in {}", line,
                                     name, quantity, example));
    return found->to_SI;
}

/// The number of significant digits of a printed number.
std::ptrdiff_t digits_of(std::string_view text) {
    text = text.substr(0, text.find_first_of("eE"));
    text = text.substr(std::min(text.find_first_of("123456789"), text.size()));
    return std::ranges::count_if(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// The largest error of numbers that are printed with this number of digits. Numbers of fewer than
/// four digits are not taken as rounded.
double rounding_of(const std::vector<double>& values, std::ptrdiff_t digits) {
    double largest = 0.0;
    for (const double value : values)
        largest = std::max(largest, std::abs(value));
    if (digits < 4 || largest == 0.0 || !std::isfinite(largest)) return 0.0;
    return 0.5 *
           std::pow(10.0, std::floor(std::log10(largest)) + 1.0 - static_cast<double>(digits));
}

/// Sampling rate of uniform times, which are rounded by up to `rounding_s`.
double rate_Hz_of(const std::vector<double>& times_s, double rounding_s = 0.0) {
    if (times_s.size() < 2) throw UsageError("a motion requires at least 2 times");
    const double span_s = times_s.back() - times_s.front();
    const double step_s = span_s / static_cast<double>(times_s.size() - 1);
    if (!std::isfinite(step_s) || !(step_s > 0.0))
        throw UsageError("its times must be in ascending order");
    const double tolerance_s = 1e-3 * step_s + std::min(2.0 * rounding_s, 0.2 * step_s);
    for (std::size_t k = 0; k < times_s.size(); ++k) {
        const double regular_s = times_s.front() + static_cast<double>(k) * step_s;
        if (!(std::abs(times_s[k] - regular_s) <= tolerance_s))
            throw UsageError(fmt::format(
                "its times must be uniformly spaced: number {} is {:.9g} s, expected {:.9g} s", k,
                times_s[k], regular_s));
    }
    const double rate_Hz = 1.0 / step_s, rounded = std::round(rate_Hz);
    const double allowed = 1e-6 + 2.0 * rounding_s / span_s;
    return std::abs(rate_Hz - rounded) <= allowed * rate_Hz ? rounded : rate_Hz;
}

/// Reads the lines of a CSV file in sequence.
class CsvTraces {
public:
    /// For columns of one quantity; the example shows the header.
    CsvTraces(std::string_view quantity, std::string_view example)
        : quantity_(quantity), example_(example) {}
    void add(const Cells& cells, std::size_t line) {
        if (units_.empty()) return heading(cells, line);
        if (cells.size() != units_.size())
            throw UsageError(fmt::format("line {}: it has {} cells, but the header has {}", line,
                                         cells.size(), units_.size()));
        if (std::isalpha(static_cast<unsigned char>(cells[0].empty() ? '0' : cells[0].front())))
            return places(cells, line);
        if (times_s_.size() > most_values / cells.size())
            throw UsageError(fmt::format("line {}: more than {} numbers; longer motions are read "
                                         "from HDF5 files",
                                         line, most_values));
        times_s_.push_back(number(cells[0], line) * units_[0]);
        digits_ = std::max(digits_, digits_of(cells[0]));
        for (std::size_t p = 1; p < cells.size(); ++p)
            lines_[p - 1].push_back(number(cells[p], line) * units_[p]);
    }

    PointMotion motion() {
        check_heading();
        if (xs_m_.empty() != ys_m_.empty())
            throw UsageError("positions require both lines, x_mm,... and y_mm,...");
        if (xs_m_.empty() && lines_.size() > 1)
            throw UsageError(fmt::format("it has {} points but not their positions: add the lines "
                                         "x_mm,... and y_mm,... below the header",
                                         lines_.size()));
        PointMotion motion{.rate_Hz = rate_Hz_of(times_s_, rounding_of(times_s_, digits_)),
                           .u_m = std::move(lines_)};
        for (std::size_t p = 0; p < xs_m_.size(); ++p)
            motion.at_m.push_back({xs_m_[p], ys_m_[p]});
        return motion;
    }

    PointStress stress() {
        check_heading();
        if (!xs_m_.empty() || !ys_m_.empty())
            throw UsageError("the positions of receptors are given by [afferents], not by lines "
                             "x_mm,... or y_mm,...");
        return {rate_Hz_of(times_s_, rounding_of(times_s_, digits_)), std::move(lines_)};
    }

private:
    void check_heading() const {
        if (units_.empty()) throw UsageError("it is empty");
    }

    void heading(const Cells& cells, std::size_t line) {
        if (cells.size() < 2)
            throw UsageError(fmt::format(
                "line {}: it must name the time and at least one point, as in {}", line, example_));
        units_.push_back(unit(cells[0], "time", example_, line));
        for (std::size_t p = 1; p < cells.size(); ++p)
            units_.push_back(unit(cells[p], quantity_, example_, line));
        lines_.resize(cells.size() - 1);
    }

    void places(const Cells& cells, std::size_t line) {
        const std::string_view name = without_unit(cells[0]);
        if ((name != "x" && name != "y") || !times_s_.empty())
            throw UsageError(fmt::format(
                "line {}: \"{:.40}\" must be a time, or x_mm or y_mm directly below the header",
                line, cells[0]));
        std::vector<double>& to = name == "x" ? xs_m_ : ys_m_;
        const double to_m = unit(cells[0], "length", "x_mm,0,5", line);
        to.clear();
        for (std::size_t p = 1; p < cells.size(); ++p)
            to.push_back(number(cells[p], line) * to_m);
    }

    std::string_view quantity_, example_;
    std::vector<double> units_; // of all columns; empty: the header has not been read
    std::vector<double> times_s_, xs_m_, ys_m_;
    std::ptrdiff_t digits_ = 0;              // of the printed times
    std::vector<std::vector<double>> lines_; // one per column except the times
};

void read_lines(std::string_view csv, CsvTraces& traces) {
    try {
        for (CsvReader reader(csv); reader.next();)
            traces.add(reader.cells(), reader.line());
    } catch (const CsvError& error) {
        throw UsageError(fmt::format("line {}: it has {}", error.line, error.what()));
    }
}

std::vector<std::vector<double>> rows(const NumberBlock& block, const std::string& name,
                                      double to_m) {
    if (block.shape.size() != 2)
        throw UsageError(fmt::format("{} must have two dimensions, points and samples", name));
    std::vector<std::vector<double>> lines(block.shape[0]);
    for (std::size_t p = 0; p < lines.size(); ++p) {
        const auto first = block.values.begin() + static_cast<std::ptrdiff_t>(p * block.shape[1]);
        for (auto at = first; at != first + static_cast<std::ptrdiff_t>(block.shape[1]); ++at)
            lines[p].push_back(*at * to_m);
    }
    return lines;
}

void check_places(const PointMotion& motion) {
    if (motion.at_m.size() != motion.u_m.size())
        throw UsageError(fmt::format("it has {} points but {} positions", motion.u_m.size(),
                                     motion.at_m.size()));
}

PointMotion read_case_motion(hid_t file, const std::string& prefix) {
    PointMotion motion;
    motion.u_m = rows(read_numbers(file, prefix + "u_z", "_m"), "u_z", 1.0);
    const NumberBlock times = read_numbers(file, prefix + "time", "_s"),
                      x = read_numbers(file, prefix + "x", "_m"),
                      y = read_numbers(file, prefix + "y", "_m");
    if (x.values.size() != y.values.size()) throw UsageError("x and y must have the same length");
    for (std::size_t p = 0; p < x.values.size(); ++p)
        motion.at_m.push_back({x.values[p], y.values[p]});
    check_places(motion);
    // The times may have been stored in single precision.
    constexpr double rounding_1 = 0.5 * std::numeric_limits<float>::epsilon();
    motion.rate_Hz = rate_Hz_of(
        times.values, times.values.empty() ? 0.0 : rounding_1 * std::abs(times.values.back()));
    for (std::vector<double>& line : motion.u_m) {
        if (line.size() != times.values.size())
            throw UsageError("u_z and time must have the same number of times");
        if (std::abs(times.values.front() * motion.rate_Hz - 1.0) < 1e-3)
            line.insert(line.begin(),
                        0.0); // the first frame is one interval after the start of the load
    }
    return motion;
}

double rate_Hz_of(const h5::Id& group) {
    if (!h5::has_attribute(group.raw(), "fs_hz"))
        throw UsageError("the attribute fs_hz, the number of samples per second, is missing");
    return h5::number_attribute(group.raw(), "fs_hz");
}

PointMotion read_traces(hid_t file, const std::string& group) {
    constexpr double mm = 1e-3;
    const std::string prefix = group.empty() ? "" : group + "/";
    PointMotion motion;
    motion.u_m = rows(read_numbers(file, prefix + "trace_mm", "_mm"), "trace_mm", mm);
    const NumberBlock at = read_numbers(file, prefix + "pin_xy_mm", "_mm");
    if (at.shape.size() != 2 || at.shape[1] != 2)
        throw UsageError("pin_xy_mm must have two columns, x and y");
    for (std::size_t p = 0; p < at.shape[0]; ++p)
        motion.at_m.push_back({mm * at.values[2 * p], mm * at.values[2 * p + 1]});
    check_places(motion);
    const h5::Id opened = h5::open_group(file, group.empty() ? "/" : group);
    motion.rate_Hz = rate_Hz_of(opened);
    if (h5::has_attribute(opened.raw(), "pin_radius_mm"))
        motion.radius_m = mm * h5::number_attribute(opened.raw(), "pin_radius_mm");
    return motion;
}

PointMotion motion_of(hid_t file, std::string group) {
    const auto contains = [&](const std::string& name) {
        for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
            if (H5Lexists(file, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
            if (slash == std::string::npos) return true;
        }
    };
    if (group.empty() && contains("traces/u_z")) group = "traces";
    const std::string prefix = group.empty() ? "" : group + "/";
    if (contains(prefix + "trace_mm")) return read_traces(file, group);
    if (contains(prefix + "u_z")) return read_case_motion(file, prefix);
    throw UsageError(fmt::format("{} contains neither u_z nor trace_mm; use --group to select the "
                                 "group that contains one of them",
                                 group.empty() ? "its root" : "the group " + group));
}

PointStress stress_of(hid_t file, const std::string& group) {
    const h5::Id opened = h5::open_group(file, group.empty() ? "/" : group);
    const std::string name = "compression_Pa";
    if (H5Lexists(opened.raw(), name.c_str(), H5P_DEFAULT) <= 0)
        throw UsageError(fmt::format(
            "{} does not contain compression_Pa; use --group to select the group that contains it",
            group.empty() ? "its root" : "the group " + group));
    return {rate_Hz_of(opened), rows(read_numbers(opened.raw(), name, "_Pa"), name, 1.0)};
}

template <class ParseCsv>
auto read_csv_file(const std::filesystem::path& path, ParseCsv parse_csv) {
    try {
        return parse_csv(read_file(path, largest_user_text_B));
    } catch (const UsageError& error) {
        if (error.code() != ExitCode::usage)
            throw; // messages of the file system already name the file
        throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace

PointMotion motion_of_csv(std::string_view csv) {
    CsvTraces traces("length", "t_ms,u_um,u_um");
    read_lines(csv, traces);
    return traces.motion();
}

PointStress stress_of_csv(std::string_view csv) {
    CsvTraces traces("pressure", "t_ms,p_Pa,p_Pa");
    read_lines(csv, traces);
    return traces.stress();
}

PointMotion read_motion(const std::filesystem::path& path, const std::string& group) {
    if (is_csv(path)) return read_csv_file(path, motion_of_csv);
    return read_user_file(path, [&](hid_t file) { return motion_of(file, group); });
}

PointStress read_stress(const std::filesystem::path& path, const std::string& group) {
    if (is_csv(path)) return read_csv_file(path, stress_of_csv);
    return read_user_file(path, [&](hid_t file) { return stress_of(file, group); });
}

} // namespace shearwake::storage
