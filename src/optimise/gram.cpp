// SPDX-License-Identifier: BSD-3-Clause
#include "optimise/gram.hpp"

#include "measures/surface_sums.hpp"
#include "measures/window.hpp"
#include "storage/case_file/surface_reader.hpp"

#include <cmath>

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

} // namespace

Forms gram_forms(const Case& c, const std::vector<std::filesystem::path>& knot_files) {
    const auto knots = static_cast<Index>(knot_files.size());
    const Modulation& modulation = c.scene().load.modulation;
    const measures::Region region = measures::measured_region(c.domain, c.measure);
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    const std::vector<double> weights =
        measures::window_weights(c.time, window.from_s, window.to_s);
    KnotFields fields(c, knot_files);
    MatrixXd focal = MatrixXd::Zero(knots, knots), all = focal;
    MatrixXd measured(region.samples(), knots);
    for (std::size_t n = 0; n < weights.size(); ++n) {
        if (weights[n] == 0.0) continue;
        fields.read(n);
        Index filled = 0;
        for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
            region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end) {
                measured.middleRows(filled, end - first) = fields.samples(i, first, end);
                filled += end - first;
            });
        add_products(all, measured, weights[n]);
        const std::vector<Vec2> places =
            foci(modulation, c.time.frame_s(static_cast<std::ptrdiff_t>(n)));
        const measures::FocalRegion disc(c.domain, region, places, c.measure.focal_radius_m);
        std::vector<Eigen::RowVectorXd> rows;
        for (std::ptrdiff_t i = disc.x_first; i < disc.x_end; ++i)
            disc.row(i, [&](std::ptrdiff_t j, double w) {
                rows.emplace_back(std::sqrt(w) * fields.sample(i, j));
            });
        MatrixXd of_disc(std::ssize(rows), knots);
        for (std::size_t r = 0; r < rows.size(); ++r)
            of_disc.row(static_cast<Index>(r)) = rows[r];
        add_products(focal, of_disc, weights[n]);
    }
    const MatrixXd numerator = both_triangles(focal);
    return {.numerator = numerator, .denominator = both_triangles(all), .focal = numerator};
}

} // namespace shearwake::optimise
