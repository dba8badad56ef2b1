// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/scheme.hpp"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace shearwake::pstd {

class SplitFields;

/// The points of a sensor: nodes, or weighted sums of nodes. With weights, those of point p belong
/// to the nodes p m to (p + 1) m - 1, where m is `nodes_of_a_point`.
struct SensorPoints {
    std::vector<Node> nodes;
    std::vector<double> weights; // of each node; none: each node is a point
    std::size_t nodes_of_a_point = 1;
    std::size_t size() const { return nodes.size() / nodes_of_a_point; }
};

/// Records fields of the scheme at the points of a sensor, and extremes of the entire grid, in
/// every step from a first one on. The names of records are those of sensor.record of k-Wave; in a
/// plane the axes are those of k-Wave as well, the pressure is -(sxx + syy)/2 with these axes, and
/// without motion along z there are no records of z.
class Recorder {
public:
    /// Indices of quantities: pressure, velocities at their staggered points and at the nodes,
    /// their compressional and shear parts, and intensities.
    static constexpr std::size_t pressure = 0, velocity = 1, moved = 4, split_p = 7, split_s = 10,
                                 intensity = 13, quantity_count = 16;
    enum class Statistic { series, max, min, rms, mean, max_all, min_all, final };
    struct Record {
        std::string name; // of the dataset: ux_max
        std::size_t quantity;
        Statistic statistic;
        bool is_output; // otherwise only another record is computed from it
        /// [point of this rank][sample], or [point of this rank].
        std::vector<double> values;
        std::unique_ptr<Tally> tally; // of an extreme of the grid
        bool is_series() const { return statistic == Statistic::series; }
        bool is_grid() const { return statistic >= Statistic::max_all; }
    };

    /// `points` and `scheme` must exist as long as the recorder. `steps`: of the run. Not
    /// collective.
    Recorder(const SensorPoints& points, const Scheme& scheme, const std::set<std::string>& records,
             std::ptrdiff_t first_step, std::ptrdiff_t steps);
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Bytes on a rank of `ranks`. Not collective.
    static double memory_B(const SensorPoints& points, const Grid& grid,
                           const std::set<std::string>& records, std::ptrdiff_t samples, int ranks);
    /// After every step. The values are added to the records during the next step, with which
    /// another device may be occupied. Collective.
    void add(const Comm& team);
    /// Completes the records and computes those that follow from complete series, before the
    /// output. Not collective.
    void finish();

    const std::vector<Record>& records() const { return records_; }
    std::ptrdiff_t samples() const { return samples_; }
    /// On rank 0: samples first to first + count - 1 of a record of points, [sample][point]. A
    /// statistic has one sample. Collective.
    std::vector<double> samples_of(const Record& record, std::size_t first, std::size_t count,
                                   const Comm& team) const;
    /// On rank 0: a record of the grid, [x][y][z]. Collective.
    std::vector<double> grid_of(const Record& record, const Comm& team) const;

    void save(StateWriter& state);          // collective
    void restore(const StateReader& state); // collective

private:
    static std::vector<Record> records_of(const std::set<std::string>& names, const Grid& grid);
    DistributedRows rows(const Record& record) const;
    void make_moves();
    void add_found();
    void find_values(const Comm& team);
    void move_to_nodes(std::size_t axis, const Comm& team);
    void split_velocities(const Comm& team);
    void interpolate(const Comm& team);
    bool needs(std::size_t first, std::size_t count) const;

    const SensorPoints& points_;
    const Scheme& scheme_;
    Slabs slabs_;
    std::ptrdiff_t first_step_, samples_;
    std::vector<Record> records_;
    std::vector<std::size_t> order_;       // the nodes sorted by x: contiguous for each rank
    std::size_t first_ = 0, count_ = 0;    // those of this rank
    std::unique_ptr<Sensor> sensor_;       // of these nodes
    std::vector<std::size_t> point_order_; // the points, contiguous for each rank
    std::size_t first_point_ = 0, count_points_ = 0;
    std::array<std::vector<double>, 3> move_; // weights that move a velocity by half a cell
    std::vector<std::vector<double>> now_;    // [quantity][node, then point of this rank]
    std::optional<std::ptrdiff_t> found_;     // the sample of now_, if it is not yet in the records
    std::unique_ptr<SplitFields> split_;
};

} // namespace shearwake::pstd
