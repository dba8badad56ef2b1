// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/error.hpp"
#include "config/files/files.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/acoustics/hologram.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// Each point takes about 10 kB in a case of a thousand frames.
constexpr double most_scan_points = 20000.0;
constexpr double micro = 1e-6, percent = 0.01;
constexpr std::array scans = {"grid_mm", "polygon_mm", "line_mm", "file", "points_mm"};

/// Points of a lattice that fill a rectangle, symmetric about its centre; y fastest.
std::vector<Vec2> lattice_points(Vec2 low_m, Vec2 high_m, double spacing_m) {
    const Vec2 extent = high_m - low_m, centre = 0.5 * (low_m + high_m);
    const double along_x = std::floor(extent.x / spacing_m + 1e-9),
                 along_y = std::floor(extent.y / spacing_m + 1e-9);
    std::vector<Vec2> points;
    for (double i = 0.0; i <= along_x; ++i)
        for (double j = 0.0; j <= along_y; ++j)
            points.push_back(centre + spacing_m * Vec2{i - 0.5 * along_x, j - 0.5 * along_y});
    return points;
}

/// Whether the lattice of such a rectangle has more points than a scan may have, which is reported.
bool is_too_fine(const Reader& reader, Vec2 extent_m, double spacing_m) {
    const double count = (std::floor(extent_m.x / spacing_m + 1e-9) + 1.0) *
                         (std::floor(extent_m.y / spacing_m + 1e-9) + 1.0);
    if (count <= most_scan_points) return false;
    reader.error("spacing_mm", fmt::format("results in {:.0f} points; at most {:.0f} are supported",
                                           count, most_scan_points));
    return true;
}

std::vector<Vec2> read_area(Reader& reader, double spacing_m) {
    const std::vector<Vec2> corners =
        reader.find_points("polygon_mm").value_or(std::vector<Vec2>());
    if (corners.size() < 3) {
        reader.error("polygon_mm", "must have at least three corners");
        return {};
    }
    Vec2 low = corners.front(), high = low;
    for (const Vec2& corner : corners) {
        low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
        high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
    }
    if (is_too_fine(reader, high - low, spacing_m)) return {};
    std::vector<Vec2> points = lattice_points(low, high, spacing_m);
    std::erase_if(points, [&](Vec2 point) { return !is_inside(corners, point); });
    if (points.empty()) reader.error("polygon_mm", "contains none of the points of the scan");
    return points;
}

std::vector<Vec2> read_line(Reader& reader, double spacing_m) {
    const std::vector<Vec2> ends = reader.find_points("line_mm").value_or(std::vector<Vec2>());
    if (ends.size() != 2 || ends.front() == ends.back()) {
        reader.error("line_mm", "must contain two different points, the start and the end");
        return {};
    }
    const Vec2 along = ends.back() - ends.front();
    if (is_too_fine(reader, {norm(along), 0.0}, spacing_m)) return {};
    const double steps = std::floor(norm(along) / spacing_m + 1e-9);
    std::vector<Vec2> points;
    for (double n = 0.0; n <= steps; ++n)
        points.push_back(ends.front() + (n * spacing_m / norm(along)) * along);
    return points;
}

std::vector<Vec2> read_file(Reader& reader, const TextLoader& load_text) {
    const auto text = load_named(reader, "file", load_text);
    if (!text) return {};
    PointsFile file = read_points(*text);
    if (!file.problem.empty())
        reader.error("file",
                     fmt::format("cannot be used: {}: {}", reader.word("file"), file.problem));
    return std::move(file.points_m);
}

std::vector<Vec2> read_scan(Reader& reader, const TextLoader& load_text) {
    const auto given =
        std::count_if(scans.begin(), scans.end(), [&](const char* key) { return reader.has(key); });
    const auto spacing_m =
        reader.find_number("spacing_mm", range_of<VibrometerOptions>("spacing_mm"));
    const Vec2 centre = reader.point_or("center_mm", {});
    if (given != 1) {
        reader.error("points_mm", "or one of grid_mm, polygon_mm, line_mm and file is required, "
                                  "and only one of them");
        return {};
    }
    if (reader.has("center_mm") && !reader.has("grid_mm"))
        reader.error("center_mm", "applies only with grid_mm");
    const bool is_listed = reader.has("file") || reader.has("points_mm");
    if (is_listed && spacing_m)
        reader.error("spacing_mm", "does not apply to points that are listed");
    if (reader.has("points_mm"))
        return reader.find_points("points_mm").value_or(std::vector<Vec2>());
    if (is_listed) return read_file(reader, load_text);
    if (!reader.has("spacing_mm")) reader.missing("spacing_mm");
    if (!spacing_m) return {};
    if (reader.has("polygon_mm")) return read_area(reader, *spacing_m);
    if (reader.has("line_mm")) return read_line(reader, *spacing_m);
    const Vec2 extent = reader.point("grid_mm", range_of<VibrometerOptions>("grid_mm"));
    if (is_too_fine(reader, extent, *spacing_m)) return {};
    return lattice_points(centre - 0.5 * extent, centre + 0.5 * extent, *spacing_m);
}

void check_points(const Reader& reader, const VibrometerOptions& options, const Domain& domain) {
    if (static_cast<double>(options.points_m.size()) > most_scan_points)
        reader.error("points_mm", fmt::format("has {} points; at most {:.0f} are supported",
                                              options.points_m.size(), most_scan_points));
    const Vec2 offset_m = {options.offset_x_m, options.offset_y_m};
    for (const Vec2 nominal : options.points_m)
        if (const Vec2 point = nominal + offset_m; domain.nx > 0 && !domain.contains(point)) {
            reader.error("points_mm",
                         fmt::format("has a point at [{:.6g}, {:.6g}] mm outside of the "
                                     "domain, which ends at {:.6g} and {:.6g} mm",
                                     1e3 * point.x, 1e3 * point.y, 500.0 * domain.extent_x_m(),
                                     500.0 * domain.extent_y_m()));
            return;
        }
}

} // namespace

std::optional<VibrometerOptions> read_vibrometer(Reader& reader, const Case& c,
                                                 const TextLoader& load_text) {
    if (reader.keys().empty()) return std::nullopt;
    VibrometerOptions options;
    const std::size_t before = reader.diagnostics().errors();
    options.points_m = read_scan(reader, load_text);
    if (options.points_m.empty() && reader.diagnostics().errors() == before)
        reader.error("points_mm", "must contain at least one point");
    read_fields(reader, options);
    options.noise_m_s_rtHz =
        micro * read_optional_number(reader, field_of<VibrometerOptions>("noise_um_s_rtHz"));
    options.missing_share =
        percent * read_optional_number(reader, field_of<VibrometerOptions>("missing_percent"));
    reader.finish();
    check_points(reader, options, c.domain);
    if (c.measure.depths_m.empty() || c.measure.depths_m.front() != 0.0)
        reader.error("points_mm", "requires the surface: measure.depths_mm must begin with 0");
    const double rate_Hz = options.rate_Hz > 0.0     ? options.rate_Hz
                           : c.time.interval_s > 0.0 ? 1.0 / c.time.interval_s
                                                     : 0.0;
    for (const auto& [key, cutoff_Hz] : {std::pair{"high_pass_Hz", options.high_pass_Hz},
                                         std::pair{"low_pass_Hz", options.low_pass_Hz}})
        if (rate_Hz > 0.0 && cutoff_Hz >= 0.5 * rate_Hz)
            reader.error(key, fmt::format("must be below half of the sampling rate, {:.6g} Hz",
                                          0.5 * rate_Hz));
    return options;
}

} // namespace shearwake::config
