// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace shearwake {

/// Velocities and stresses at a node of a staggered grid, in the order of numbers in files.
inline constexpr std::array<const char*, 9> grid_fields = {"ux",  "uy",  "uz",  "sxx", "syy",
                                                           "szz", "sxy", "sxz", "syz"};

/// A record of a sensor, a name of sensor.record of k-Wave or a field of the grid, and the number
/// of time series that it requires.
struct SensorRecordName {
    const char* name;
    int series;
};
inline constexpr std::array<SensorRecordName, 27> sensor_records = {{{"ux", 1},
                                                                     {"uy", 1},
                                                                     {"uz", 1},
                                                                     {"sxx", 1},
                                                                     {"syy", 1},
                                                                     {"szz", 1},
                                                                     {"sxy", 1},
                                                                     {"sxz", 1},
                                                                     {"syz", 1},
                                                                     {"p", 1},
                                                                     {"u", 3},
                                                                     {"u_non_staggered", 3},
                                                                     {"u_split_field", 6},
                                                                     {"I", 7},
                                                                     {"I_avg", 7},
                                                                     {"p_max", 0},
                                                                     {"p_min", 0},
                                                                     {"p_rms", 0},
                                                                     {"p_max_all", 0},
                                                                     {"p_min_all", 0},
                                                                     {"p_final", 0},
                                                                     {"u_max", 0},
                                                                     {"u_min", 0},
                                                                     {"u_rms", 0},
                                                                     {"u_max_all", 0},
                                                                     {"u_min_all", 0},
                                                                     {"u_final", 0}}};

/// The points of a sensor: nodes, or weighted sums of nodes. With weights, those of point p belong
/// to the nodes p m to (p + 1) m - 1, where m is `nodes_of_a_point`.
struct SensorPoints {
    std::vector<std::array<std::ptrdiff_t, 3>> nodes;
    std::vector<double> weights; // of each node; none: each node is a point
    std::size_t nodes_of_a_point = 1;
    std::size_t size() const { return nodes.size() / nodes_of_a_point; }
};

/// A source at some nodes of a field: node n receives weights[n] times the sample of its row.
/// Additive values are added to the field in each step, Dirichlet values replace it (for
/// velocities: the part split along their own direction). The source has no effect after the last
/// sample.
struct NodeSource {
    std::size_t field = 0; // index in grid_fields
    bool dirichlet = false;
    std::vector<std::array<std::ptrdiff_t, 3>>
        nodes;                     // indices along x, y, z, from 0; without duplicates
    std::vector<double> weights;   // m/s or Pa for each unit of the series
    std::vector<std::size_t> rows; // row of each node
    std::vector<double> series;    // [row][sample]
    std::ptrdiff_t samples = 0;
    bool operator==(const NodeSource&) const = default;
};

/// A simulation of the k-Wave toolbox that is defined node by node: the complete grid including its
/// absorbing layer, the medium, the sources and the sensor. scripts/import-kwave writes the file.
struct StudyData {
    std::string file;
    std::string content_hash; // 16 hex digits of everything but the file's name
    std::array<std::ptrdiff_t, 3> points = {};
    std::array<double, 3> spacing_m = {};
    double time_step_s = 0.0;
    std::ptrdiff_t steps = 0;
    std::array<std::ptrdiff_t, 3> layer_points =
        {};                                    // thickness of the absorbing layer on each side
    std::array<double, 3> layer_strength = {}; // Np per point at its outer edge
    double layer_ratio = 0.1;                  // ratio of the multi-axial layer
    double layer_speed_m_s = 0.0;              // its design speed; 0: the largest c_p
    // One value for all nodes, or one per node: [x][y][z]. Empty chi and eta: lossless.
    std::vector<double> density_kg_m3, c_p_m_s, c_s_m_s, chi_Pa_s, eta_Pa_s;
    std::vector<NodeSource> sources;
    SensorPoints sensor;
    std::vector<std::size_t> sensor_fields; // index in sensor_records
    std::ptrdiff_t sensor_start = 1;        // first step that is recorded

    std::size_t size() const { return static_cast<std::size_t>(points[0] * points[1] * points[2]); }
    bool lossy() const { return !eta_Pa_s.empty(); }
    bool operator==(const StudyData& other) const { return content_hash == other.content_hash; }
};

/// Converts a study to a list of numbers and back, for transfer between ranks and for its hash. Not
/// collective.
std::vector<double> packed(const StudyData& study);
StudyData unpacked(const std::vector<double>& numbers);
std::string hash_of(const StudyData& study);

} // namespace shearwake
