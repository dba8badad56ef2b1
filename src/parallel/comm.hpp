// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <complex>
#include <concepts>
#include <cstddef>
#include <exception>
#include <memory>
#include <mpi.h>
#include <span>
#include <string>
#include <vector>

namespace shearwake {

/// Types that can be sent between ranks without conversion.
template <class T>
concept Sendable =
    std::same_as<T, double> || std::same_as<T, float> || std::same_as<T, std::complex<double>> ||
    std::same_as<T, long> || std::same_as<T, int> || std::same_as<T, char>;

/// Thrown by collective calls inside fail_together() when another rank has failed. Not an Error, so
/// that only fail_together() catches it.
class PeerFailed : public std::exception {
public:
    explicit PeerFailed(int depth) : depth_(depth) {}
    const char* what() const noexcept override { return "another rank has failed"; }
    int depth() const { return depth_; }

private:
    int depth_;
};

/// A group of ranks; owns an MPI communicator. Copies share the communicator. Every member function
/// is collective unless stated otherwise. All throw Error when MPI reports an error, and, before
/// anything is sent, when the number of values exceeds the range of MPI's counts. Inside
/// fail_together() (parallel/agree.hpp) all throw PeerFailed when another rank has failed.
class Comm {
public:
    /// All ranks of the program. Not collective.
    static Comm world();
    /// Groups the ranks of equal colour, ordered by their rank in this group.
    Comm split(int color) const;
    /// Groups the ranks that share memory with this rank.
    Comm split_by_machine() const;
    /// The rank in the last group of split_by_machine(), which runs call at their start; 0 before.
    /// Not collective.
    static int rank_on_machine();

    int rank() const { return rank_; }               // not collective
    int size() const { return size_; }               // not collective
    bool is_root() const { return rank_ == 0; }      // not collective
    MPI_Comm raw() const { return shared_->handle; } // not collective

    /// Call immediately before a collective call that another library (FFTW, HDF5) makes over
    /// raw(): throws PeerFailed inside fail_together() if another rank has failed. Nothing between
    /// this call and the collective one may throw.
    void before_collective() const;

    /// Records that this process has made progress.
    static void mark_progress();
    /// Seconds since the last progress of this process, minus the longest time without progress
    /// until then. A signal handler may call it.
    static double overdue_s();
    /// While one exists, the time that passes is not overdue: large files are written.
    class Unwatched {
    public:
        Unwatched();
        ~Unwatched();
        Unwatched(const Unwatched&) = delete;
        Unwatched& operator=(const Unwatched&) = delete;
    };

    void barrier() const;
    /// Reductions return the same result on every rank.
    double sum(double value) const;
    double max(double value) const;
    double min(double value) const;
    int max(int value) const;
    int min(int value) const;
    /// Whether it is true on any rank, and on all ranks.
    bool any(bool value) const { return max(value ? 1 : 0) != 0; }
    bool all(bool value) const { return min(value ? 1 : 0) != 0; }
    void sum(std::span<double> values) const; // element by element, in place
    void max(std::span<double> values) const;

    /// Returns the value of rank `from` on every rank.
    template <Sendable T>
    T broadcast(T value, int from = 0) const {
        broadcast_in_place(std::span<T>(&value, 1), from);
        return value;
    }
    /// Replaces `values` on every rank by those of rank `from`, including their number.
    template <Sendable T>
    void broadcast(std::vector<T>& values, int from = 0) const {
        values.resize(static_cast<std::size_t>(broadcast(static_cast<long>(values.size()), from)));
        broadcast_in_place(std::span<T>(values), from);
    }
    template <std::same_as<bool> Bool>
    bool broadcast(Bool value, int from = 0) const {
        return broadcast(value ? 1 : 0, from) != 0;
    }
    std::string broadcast(std::string text, int from = 0) const;

    /// Concatenates the values of all ranks in rank order, on every rank.
    template <Sendable T>
    std::vector<T> all_gather(std::span<const T> mine) const;
    template <Sendable T>
    std::vector<T> all_gather(const std::vector<T>& mine) const {
        return all_gather(std::span<const T>(mine));
    }
    /// Concatenates the values of all ranks in rank order on the root; returns an empty vector on
    /// the other ranks.
    template <Sendable T>
    std::vector<T> gather(std::span<const T> mine) const;
    template <Sendable T>
    std::vector<T> gather(const std::vector<T>& mine) const {
        return gather(std::span<const T>(mine));
    }
    /// Sends consecutive parts of `sent` to the ranks in rank order, and stores what arrives from
    /// them consecutively in `received`. The counts are numbers of values, one entry per rank.
    /// Throws Error if they exceed the size of the buffers.
    template <Sendable T>
    void all_to_all(std::span<const T> sent, std::span<const std::ptrdiff_t> sent_counts,
                    std::span<T> received, std::span<const std::ptrdiff_t> received_counts) const;

private:
    friend class FailTogether;
    struct Shared { // by all copies
        MPI_Comm handle;
        int depth = 0; // number of calls of fail_together() that are active
    };
    explicit Comm(std::shared_ptr<Shared> shared);
    static Comm owned(MPI_Comm part); // freed with its last copy
    /// Returns the smallest depth at which any rank has failed; 0 if none has. `failed`: the depth
    /// at which this rank has failed, or 0.
    int agree(int failed) const;
    template <Sendable T>
    void broadcast_in_place(std::span<T> values, int from) const;
    std::shared_ptr<Shared> shared_;
    int rank_ = 0;
    int size_ = 1;
};

/// A sum over rows, each of which belongs to one rank. It is accumulated in the order of the rows,
/// so that the result has the same bits on any number of ranks.
class RowSums {
public:
    explicit RowSums(std::ptrdiff_t rows = 0) : rows_(static_cast<std::size_t>(rows), 0.0) {}

    void clear() { std::fill(rows_.begin(), rows_.end(), 0.0); }
    void add(std::ptrdiff_t row, double value) { rows_[static_cast<std::size_t>(row)] += value; }
    /// Sum over the rows of this rank. Not collective.
    double mine() const;
    /// Sum over the rows of all ranks. Collective.
    double team_sum(const Comm& team) const;

private:
    std::vector<double> rows_;
};

} // namespace shearwake
