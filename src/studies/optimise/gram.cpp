// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"
#include "studies/optimise/forms.hpp"

#include "base/units.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/spectrum.hpp"
#include "measures/surface_sums.hpp"
#include "measures/window.hpp"
#include "problem/load/footprint.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/checksum/checksum.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace shearwake::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The fields of all knots in one frame.
class KnotFields {
public:
    KnotFields(const Case& c, const std::vector<std::filesystem::path>& files)
        : domain_(c.domain), values_(c.domain.nx * c.domain.ny, std::ssize(files)) {
        for (const auto& file : files)
            readers_.emplace_back(file);
    }

    void read(std::size_t frame) {
        for (std::size_t knot = 0; knot < readers_.size(); ++knot)
            readers_[knot].read(frame, 0,
                                {values_.col(static_cast<Index>(knot)).data(),
                                 static_cast<std::size_t>(values_.rows())});
    }
    auto sample(std::ptrdiff_t i, std::ptrdiff_t j) const {
        return values_.row(i * domain_.ny + j);
    }
    auto samples(std::ptrdiff_t i, std::ptrdiff_t first, std::ptrdiff_t end) const {
        return values_.middleRows(i * domain_.ny + first, end - first);
    }

private:
    const Domain& domain_;
    std::vector<storage::SurfaceReader> readers_;
    MatrixXd values_; // (x, y), knot
};

/// Adds weight times the products of the rows to the lower triangle.
void add_products(MatrixXd& sum, const MatrixXd& rows, double weight) {
    sum.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose(), weight);
}

MatrixXd both_triangles(const MatrixXd& lower) {
    return lower.selfadjointView<Eigen::Lower>();
}

/// Forms summed over the frames of the window: of u^2 over the measured region (all) and over the
/// part of it that a quotient counts (counted), and of the mean of u^2 over the focal disc (focal).
class FrameForms {
public:
    FrameForms(const Case& c, const Quotient& quotient, bool with_path, Index knots)
        : c_(c), region_(measures::measured_region(c.domain, c.measure)), kind_(quotient.kind),
          focal_(MatrixXd::Zero(knots, knots)), counted_(focal_), all_(focal_),
          measured_(region_.samples(), knots) {
        if (kind_ == Quotient::Kind::sharpness) find_roots();
        if (with_path) points_ = samples_along_path(c);
        path_.assign(points_.size(), focal_);
    }

    void add(const KnotFields& fields, double t_s, double weight) {
        const FocalSamples disc = focal_samples(fields, t_s);
        if (disc.weight > 0.0) add_products(focal_, disc.rows, weight / disc.weight);
        for (std::size_t p = 0; p < points_.size(); ++p)
            for (const WeightedSample& of : points_[p])
                add_products(path_[p], fields.sample(of.i, of.j), weight * of.weight);
        if (kind_ == Quotient::Kind::efficiency) add_products(counted_, disc.rows, weight);
        if (kind_ != Quotient::Kind::efficiency && kind_ != Quotient::Kind::sharpness) return;
        Index filled = 0;
        for (std::ptrdiff_t i = region_.x0; i < region_.x1; ++i)
            region_.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double w) {
                measured_.middleRows(filled, end - first) =
                    std::sqrt(w) * fields.samples(i, first, end);
                filled += end - first;
            });
        add_products(all_, measured_, weight);
        if (kind_ == Quotient::Kind::sharpness)
            add_products(counted_, roots_.asDiagonal() * measured_, weight);
    }

    MatrixXd focal() const { return both_triangles(focal_); }
    MatrixXd counted() const { return both_triangles(counted_); }
    MatrixXd symmetric() const { return both_triangles(all_); }
    std::vector<MatrixXd> path() const {
        std::vector<MatrixXd> forms;
        std::ranges::transform(path_, std::back_inserter(forms), both_triangles);
        return forms;
    }

private:
    /// The samples of the focal discs, multiplied by the roots of their weights.
    struct FocalSamples {
        MatrixXd rows;
        double weight = 0.0; // sum
    };
    FocalSamples focal_samples(const KnotFields& fields, double t_s) const {
        const std::vector<Vec2> places = foci(c_.scene.load.modulation, t_s);
        const measures::FocalRegion disc(c_.domain, region_, places, c_.measure.focal_radius_m);
        std::vector<Eigen::RowVectorXd> rows;
        FocalSamples samples;
        for (std::ptrdiff_t i = disc.x_first; i < disc.x_end; ++i)
            disc.row(i, [&](std::ptrdiff_t j, double w) {
                rows.emplace_back(std::sqrt(w) * fields.sample(i, j));
                samples.weight += w;
            });
        samples.rows.resize(std::ssize(rows), focal_.rows());
        for (std::size_t r = 0; r < rows.size(); ++r)
            samples.rows.row(static_cast<Index>(r)) = rows[r];
        return samples;
    }

    void find_roots() {
        const std::vector<double> shares =
            measures::shares_near(drawn_shape(c_.scene.load.modulation, 0.25 * c_.domain.spacing_m),
                                  fwhm_m(c_.scene.load.footprint), c_.domain);
        roots_.resize(region_.samples());
        Index filled = 0;
        for (std::ptrdiff_t i = region_.x0; i < region_.x1; ++i)
            region_.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double) {
                for (std::ptrdiff_t j = first; j < end; ++j)
                    roots_(filled++) =
                        std::sqrt(shares[static_cast<std::size_t>(i * c_.domain.ny + j)]);
            });
    }

    const Case& c_;
    measures::Region region_;
    Quotient::Kind kind_;
    MatrixXd focal_, counted_, all_, measured_;
    Eigen::VectorXd roots_; // of the weights of the drawn shape
    std::vector<std::array<WeightedSample, 4>> points_;
    std::vector<MatrixXd> path_;
};

/// Where a coordinate is between two neighbouring samples. A path may pass the last sample by up to
/// half a spacing and has its value there.
struct CellPlace {
    std::ptrdiff_t low;
    double share;
};
CellPlace place_in(std::ptrdiff_t count, double spacing_m, double at_m) {
    const double at = std::min(std::max(at_m / spacing_m + static_cast<double>(count / 2), 0.0),
                               static_cast<double>(count - 1));
    const std::ptrdiff_t low = std::min(static_cast<std::ptrdiff_t>(at), count - 2);
    return {low, at - static_cast<double>(low)};
}

/// The form of the energy of the traces of all knots in a band, by polarisation.
MatrixXd band_form(const TimeAxis& time, const MatrixXd& traces, const FrequencyBand& band) {
    const auto energy = [&](const Eigen::VectorXd& trace) {
        return std::pow(measures::rms_between(
                            time, {trace.data(), static_cast<std::size_t>(trace.size())}, band),
                        2);
    };
    MatrixXd form(traces.cols(), traces.cols());
    for (Index i = 0; i < form.rows(); ++i)
        for (Index j = 0; j <= i; ++j)
            form(i, j) = form(j, i) = 0.25 * (energy(traces.col(i) + traces.col(j)) -
                                              energy(traces.col(i) - traces.col(j)));
    return form;
}

/// The traces of all knots, or their differences: one column per knot.
MatrixXd traces_of(const TimeAxis& time, const Quotient& quotient,
                   const std::vector<std::filesystem::path>& knot_files) {
    MatrixXd traces(time.frames, std::ssize(knot_files));
    for (std::size_t knot = 0; knot < knot_files.size(); ++knot) {
        std::vector<double> trace = storage::read_first_trace(knot_files[knot]);
        if (quotient.kind == Quotient::Kind::velocity_share)
            trace = measures::differences(time, trace);
        traces.col(static_cast<Index>(knot)) =
            Eigen::Map<const Eigen::VectorXd>(trace.data(), std::ssize(trace));
    }
    return traces;
}

} // namespace

std::vector<std::array<WeightedSample, 4>> samples_along_path(const Case& c) {
    const Domain& d = c.domain;
    std::vector<std::array<WeightedSample, 4>> points;
    for (const std::vector<Vec2>& line : drawn_shape(c.scene.load.modulation, d.spacing_m)) {
        if (line.size() < 2) continue; // a focus at rest
        for (const Vec2 point : line) {
            const CellPlace x = place_in(d.nx, d.spacing_m, point.x),
                            y = place_in(d.ny, d.spacing_m, point.y);
            points.push_back({{{x.low, y.low, (1.0 - x.share) * (1.0 - y.share)},
                               {x.low + 1, y.low, x.share * (1.0 - y.share)},
                               {x.low, y.low + 1, (1.0 - x.share) * y.share},
                               {x.low + 1, y.low + 1, x.share * y.share}}});
        }
    }
    return points;
}

double uniformity_of(const Case& c, const std::filesystem::path& file) {
    const auto points = samples_along_path(c);
    if (points.empty()) return not_a_number;
    const std::vector<double> mean_u2 = storage::read_mean_square(file);
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(std::ssize(points));
    for (std::size_t p = 0; p < points.size(); ++p)
        for (const WeightedSample& of : points[p])
            squares(static_cast<Index>(p)) +=
                of.weight * mean_u2.at(static_cast<std::size_t>(of.i * c.domain.ny + of.j));
    const Eigen::VectorXd rms = squares.cwiseSqrt();
    return rms.minCoeff() / rms.mean();
}

Forms gram_forms(const Case& c, const Quotient& quotient, PathForms path,
                 const std::vector<std::filesystem::path>& knot_files) {
    const Modulation& modulation = c.scene.load.modulation;
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    const std::vector<double> weights =
        measures::window_weights(c.time, window.from_s, window.to_s);
    KnotFields fields(c, knot_files);
    FrameForms frames(c, quotient, path == PathForms::included, std::ssize(knot_files));
    for (std::size_t n = 0; n < weights.size(); ++n) {
        if (weights[n] == 0.0) continue;
        fields.read(n);
        frames.add(fields, c.time.frame_s(static_cast<std::ptrdiff_t>(n)), weights[n]);
    }
    const MatrixXd focal = frames.focal();
    if (quotient.kind == Quotient::Kind::efficiency || quotient.kind == Quotient::Kind::sharpness)
        return {.numerator = frames.counted(),
                .denominator = frames.symmetric(),
                .focal = focal,
                .path = frames.path()};
    const MatrixXd traces = traces_of(c.time, quotient, knot_files);
    const measures::ShareBands bands = measures::share_bands(c.time, quotient.band);
    return {.numerator = band_form(c.time, traces, bands.part),
            .denominator = band_form(c.time, traces, bands.total),
            .focal = focal,
            .path = frames.path()};
}

namespace {

std::vector<std::pair<std::string, Quotient>> named_quotients(const Case& c) {
    std::vector<std::pair<std::string, Quotient>> found = {
        {"eta_period_1", {.kind = Quotient::Kind::efficiency, .band = {}}},
        {"sharpness_1", {.kind = Quotient::Kind::sharpness, .band = {}}}};
    for (const FrequencyBand& band : c.measure.bands) {
        const std::string name = fmt::format("share_{:g}_{:g}_1", band.low_Hz, band.high_Hz);
        found.emplace_back(name, Quotient{.kind = Quotient::Kind::share, .band = band});
        found.emplace_back("velocity_" + name,
                           Quotient{.kind = Quotient::Kind::velocity_share, .band = band});
    }
    return found;
}

} // namespace

std::vector<std::string> quotients_of(const Case& c) {
    std::vector<std::string> names;
    for (const auto& named : named_quotients(c))
        names.push_back(named.first);
    return names;
}

std::optional<Quotient> find_quotient(const Case& c, const std::string& column) {
    for (const auto& named : named_quotients(c))
        if (named.first == column) return named.second;
    return std::nullopt;
}

Vec2 trace_m(const Case& c) {
    const std::vector<Vec2>& traces = c.record.traces_m;
    const bool has_centre = std::ranges::find(traces, Vec2{}) != traces.end();
    return traces.empty() || has_centre ? Vec2{} : traces.front();
}

namespace {

Json json_of(const MatrixXd& matrix) {
    Json rows = Json::array();
    for (Index i = 0; i < matrix.rows(); ++i) {
        const Eigen::VectorXd row = matrix.row(i);
        rows.push_back(std::vector<double>(row.begin(), row.end()));
    }
    return rows;
}

} // namespace

std::string forms_text(const std::string& id, const Knots& knots, const Forms& forms) {
    Json path = Json::array();
    for (const MatrixXd& form : forms.path)
        path.push_back(json_of(form));
    return storage::seal(
        Json(
            {{"schema", 1},
             {"case", id},
             {"knots",
              {{"count", knots.count}, {"interval_s", knots.interval_s}, {"repeat", knots.repeat}}},
             {"numerator", json_of(forms.numerator)},
             {"denominator", json_of(forms.denominator)},
             {"focal", json_of(forms.focal)},
             {"path", std::move(path)}})
            .dump() +
        "\n");
}

} // namespace shearwake::optimise
