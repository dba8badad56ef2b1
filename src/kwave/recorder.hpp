// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kwave/input.hpp"
#include "parallel/comm.hpp"
#include "parallel/state.hpp"
#include "storage/hdf5/h5.hpp"

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace shearwake::kwave {

/// An output file that rank 0 writes.
struct OutputFile {
    hid_t file = -1;
    bool doubles = false; // real numbers of 64 bits instead of 32
    int gzip_level = 0;
};

/// Creates a dataset of real numbers, or of unsigned integers of 64 bits, with k-Wave's attributes.
/// Not collective.
enum class Numbers { real, integer };
h5::Id create_dataset(const OutputFile& output, const std::string& name,
                      std::span<const hsize_t> shape, Numbers numbers);

class SplitFields;

/// Records fields of the scheme at the nodes of a sensor, and extremes of the entire grid, in every
/// step from a first one on. The names of records are the options of the program: p_raw, u_raw,
/// u_non_staggered_raw, u_split_field_raw; with the prefix p_ or u_: max, min, rms, max_all,
/// min_all, final.
class Recorder {
public:
    /// `steps`: of the run. Not collective.
    Recorder(const Input& input, const pstd::Slabs& slabs, const std::set<std::string>& records,
             std::ptrdiff_t first_step, std::ptrdiff_t steps);
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Bytes on a rank of `ranks`. Not collective.
    static double memory_B(const Input& input, const std::set<std::string>& records,
                           std::ptrdiff_t samples, int ranks);
    /// After every step. Collective.
    template <class Real>
    void add(const pstd::Stepper<Real>& stepper, const Comm& team);
    /// Writes all records after the last step. `output` is that of rank 0. Collective.
    template <class Real>
    void write(const OutputFile& output, const pstd::Stepper<Real>& stepper,
               const Comm& team) const;
    void save(StateWriter& state) const;    // collective
    void restore(const StateReader& state); // collective

private:
    enum class Statistic { series, max, min, rms, max_all, min_all, final };
    struct Record {
        std::string name; // of the dataset
        std::size_t quantity;
        Statistic statistic;
        /// [node of this rank][sample], [node of this rank], or the slab of the grid.
        std::vector<double> values;
    };
    static std::vector<Record> records_of(const std::set<std::string>& names);
    DistributedRows rows(const Record& record) const;
    template <class Real>
    void find_values(const pstd::Stepper<Real>& stepper, const Comm& team);
    template <class Real>
    void move_to_nodes(const pstd::Stepper<Real>& stepper, std::size_t axis, const Comm& team);
    void write_nodes(const OutputFile& output, const Record& record, const Comm& team) const;
    void write_grid(const OutputFile& output, const std::string& name,
                    const std::vector<double>& slab, const Comm& team) const;
    bool needs(std::size_t quantity) const;

    const Input& input_;
    pstd::Slabs slabs_;
    std::ptrdiff_t first_step_, samples_;
    std::vector<Record> records_;
    std::vector<std::size_t> order_;          // the nodes sorted by x: contiguous for each rank
    std::size_t first_ = 0, count_ = 0;       // those of this rank
    std::vector<std::ptrdiff_t> offsets_;     // of this rank's nodes in its slab
    std::array<std::vector<double>, 3> move_; // weights that move a velocity by half a cell
    std::vector<std::vector<double>> now_;    // [quantity][node of this rank]
    std::unique_ptr<SplitFields> split_;
};

} // namespace shearwake::kwave
