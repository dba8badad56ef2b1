#include "io/motion_file.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "io/files.hpp"
#include "io/guard.hpp"
#include "io/h5.hpp"
#include "io/number_block.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake {
namespace {

using Cells = std::vector<std::string_view>;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

Cells cells_of(std::string_view line) {
    Cells cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

double number(std::string_view text, std::size_t line) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        throw UsageError(fmt::format("line {}: \"{:.40}\" is no number", line, text));
    return value;
}

/// What one of a column is in SI, from the unit at the end of its name.
double unit(std::string_view name, std::string_view quantity, std::string_view example,
            std::size_t line) {
    const auto found = unit_of(name);
    if (!found || found->quantity != quantity)
        throw UsageError(fmt::format("line {}: \"{:.40}\" must end in a unit of {}, as in {}", line,
                                     name, quantity, example));
    return found->to_SI;
}

/// Samples a second of regular times. Rounding of what was printed is forgiven.
double rate_Hz_of(const std::vector<double>& times_s) {
    if (times_s.size() < 2) throw UsageError("a motion needs 2 times at least");
    const double span_s = times_s.back() - times_s.front();
    const double step_s = span_s / static_cast<double>(times_s.size() - 1);
    if (!std::isfinite(step_s) || !(step_s > 0.0)) throw UsageError("its times must ascend");
    for (std::size_t k = 0; k < times_s.size(); ++k) {
        const double regular_s = times_s.front() + static_cast<double>(k) * step_s;
        if (!(std::abs(times_s[k] - regular_s) <= 1e-3 * step_s))
            throw UsageError(fmt::format("its times must be regular: number {} is {:.9g} s, and "
                                         "{:.9g} follows from the first and the last one",
                                         k, times_s[k], regular_s));
    }
    const double rate_Hz = 1.0 / step_s, whole = std::round(rate_Hz);
    return std::abs(rate_Hz - whole) <= 1e-6 * rate_Hz ? whole : rate_Hz;
}

/// Lines of a CSV file one after the other, as they come.
class CsvTraces {
public:
    /// Of a quantity, whose heading is as in the example.
    CsvTraces(std::string_view quantity, std::string_view example)
        : quantity_(quantity), example_(example) {}
    void take(const Cells& cells, std::size_t line) {
        if (units_.empty()) return heading(cells, line);
        if (cells.size() != units_.size())
            throw UsageError(fmt::format("line {}: it has {} cells, and the heading {}", line,
                                         cells.size(), units_.size()));
        if (std::isalpha(static_cast<unsigned char>(cells[0].empty() ? '0' : cells[0].front())))
            return places(cells, line);
        times_s_.push_back(number(cells[0], line) * units_[0]);
        for (std::size_t p = 1; p < cells.size(); ++p)
            lines_[p - 1].push_back(number(cells[p], line) * units_[p]);
    }

    PointMotion motion() {
        check_heading();
        if (xs_m_.empty() != ys_m_.empty())
            throw UsageError("places need both lines, x_mm,... and y_mm,...");
        if (xs_m_.empty() && lines_.size() > 1)
            throw UsageError(fmt::format("it has {} points and not their places: lines x_mm,... "
                                         "and y_mm,... below the heading",
                                         lines_.size()));
        PointMotion motion{.rate_Hz = rate_Hz_of(times_s_), .u_m = std::move(lines_)};
        for (std::size_t p = 0; p < xs_m_.size(); ++p)
            motion.at_m.push_back({xs_m_[p], ys_m_[p]});
        return motion;
    }

    PointStress stress() {
        check_heading();
        if (!xs_m_.empty() || !ys_m_.empty())
            throw UsageError("the places of receptors are those of [afferents], not lines x_mm,... "
                             "or y_mm,...");
        return {rate_Hz_of(times_s_), std::move(lines_)};
    }

private:
    void check_heading() const {
        if (units_.empty()) throw UsageError("it is empty");
    }

    void heading(const Cells& cells, std::size_t line) {
        if (cells.size() < 2)
            throw UsageError(fmt::format("line {}: it must name the time and a point at least, as "
                                         "in {}",
                                         line, example_));
        units_.push_back(unit(cells[0], "time", example_, line));
        for (std::size_t p = 1; p < cells.size(); ++p)
            units_.push_back(unit(cells[p], quantity_, example_, line));
        lines_.resize(cells.size() - 1);
    }

    void places(const Cells& cells, std::size_t line) {
        const std::string_view name = without_unit(cells[0]);
        if ((name != "x" && name != "y") || !times_s_.empty())
            throw UsageError(fmt::format("line {}: \"{:.40}\" is neither a time nor x_mm or y_mm "
                                         "below the heading",
                                         line, cells[0]));
        std::vector<double>& to = name == "x" ? xs_m_ : ys_m_;
        const double to_m = unit(cells[0], "length", "x_mm,0,5", line);
        to.clear();
        for (std::size_t p = 1; p < cells.size(); ++p)
            to.push_back(number(cells[p], line) * to_m);
    }

    std::string_view quantity_, example_;
    std::vector<double> units_; // of every column; none: the heading is still to come
    std::vector<double> times_s_, xs_m_, ys_m_;
    std::vector<std::vector<double>> lines_; // a column each but the times
};

void read_lines(std::string_view csv, CsvTraces& traces) {
    for (std::size_t line = 1; !csv.empty(); ++line) {
        const std::size_t end = std::min(csv.find('\n'), csv.size());
        const std::string_view text = trimmed(csv.substr(0, end));
        csv.remove_prefix(std::min(end + 1, csv.size()));
        if (!text.empty() && text.front() != '#') traces.take(cells_of(text), line);
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
        throw UsageError(
            fmt::format("it has {} points and {} places", motion.u_m.size(), motion.at_m.size()));
}

PointMotion of_case_file(hid_t file, const std::string& prefix) {
    PointMotion motion;
    motion.u_m = rows(read_numbers(file, prefix + "u_z"), "u_z", 1.0);
    const NumberBlock times = read_numbers(file, prefix + "time"),
                      x = read_numbers(file, prefix + "x"), y = read_numbers(file, prefix + "y");
    if (x.values.size() != y.values.size()) throw UsageError("x and y must be of one length");
    for (std::size_t p = 0; p < x.values.size(); ++p)
        motion.at_m.push_back({x.values[p], y.values[p]});
    check_places(motion);
    motion.rate_Hz = rate_Hz_of(times.values);
    for (std::vector<double>& line : motion.u_m) {
        if (line.size() != times.values.size())
            throw UsageError("u_z and time must have equally many times");
        if (std::abs(times.values.front() * motion.rate_Hz - 1.0) < 1e-3)
            line.insert(line.begin(), 0.0); // frames begin one interval after the load
    }
    return motion;
}

double rate_Hz_of(const h5::Id& group) {
    if (!h5::has_attribute(group.raw(), "fs_hz"))
        throw UsageError("the attribute fs_hz, samples a second, is missing");
    return h5::number_attribute(group.raw(), "fs_hz");
}

PointMotion of_traces(hid_t file, const std::string& group) {
    constexpr double mm = 1e-3;
    const std::string prefix = group.empty() ? "" : group + "/";
    PointMotion motion;
    motion.u_m = rows(read_numbers(file, prefix + "trace_mm"), "trace_mm", mm);
    const NumberBlock at = read_numbers(file, prefix + "pin_xy_mm");
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

PointMotion motion_of_hdf5(const std::filesystem::path& path, std::string group) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    const auto holds = [&](const std::string& name) {
        for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
            if (H5Lexists(file.raw(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0)
                return false;
            if (slash == std::string::npos) return true;
        }
    };
    if (group.empty() && holds("traces/u_z")) group = "traces";
    const std::string prefix = group.empty() ? "" : group + "/";
    if (holds(prefix + "trace_mm")) return of_traces(file.raw(), group);
    if (holds(prefix + "u_z")) return of_case_file(file.raw(), prefix);
    throw UsageError(fmt::format("{} holds neither u_z nor trace_mm; name the group that does with "
                                 "--group",
                                 group.empty() ? "its root" : "the group " + group));
}

PointStress stress_of_hdf5(const std::filesystem::path& path, const std::string& group) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    const h5::Id opened = h5::open_group(file.raw(), group.empty() ? "/" : group);
    const std::string name = "compression_Pa";
    if (H5Lexists(opened.raw(), name.c_str(), H5P_DEFAULT) <= 0)
        throw UsageError(fmt::format("{} holds no compression_Pa; name the group that does with "
                                     "--group",
                                     group.empty() ? "its root" : "the group " + group));
    return {rate_Hz_of(opened), rows(read_numbers(opened.raw(), name), name, 1.0)};
}

namespace {

/// What is wrong with a file, with its name before it.
template <class OfCsv, class OfHdf5>
auto read_traces(const std::filesystem::path& path, OfCsv of_csv, OfHdf5 of_hdf5) {
    try {
        if (path.extension() == ".csv") return of_csv(read_file(path));
        if (!std::filesystem::exists(path)) throw UsageError("there is no such file");
        must_survive(path, [&] { of_hdf5(); });
        return of_hdf5();
    } catch (const UsageError& error) {
        if (error.code() != ExitCode::usage) throw; // the file system's own words name the file
        throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
    } catch (const Error& error) {
        throw UsageError(
            fmt::format("{}: it cannot be read as HDF5: {}", path.string(), error.what()));
    }
}

} // namespace

PointMotion read_motion(const std::filesystem::path& path, const std::string& group) {
    return read_traces(path, motion_of_csv, [&] { return motion_of_hdf5(path, group); });
}

PointStress read_stress(const std::filesystem::path& path, const std::string& group) {
    return read_traces(path, stress_of_csv, [&] { return stress_of_hdf5(path, group); });
}

} // namespace shearwake
