#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <mpi.h>
#include <span>
#include <string>
#include <vector>

namespace shearwake {

/// A group of ranks: the only door to the other ones. Copies refer to the same communicator.
/// Every member function is collective unless it says otherwise.
class Comm {
public:
    /// All ranks of the program. Not collective.
    static Comm world();
    /// Ranks of equal colour, ordered by their rank here.
    Comm split(int color) const;
    /// Ranks that share this rank's memory.
    Comm split_by_machine() const;

    int rank() const { return rank_; } // not collective
    int size() const { return size_; } // not collective
    bool is_root() const { return rank_ == 0; }
    MPI_Comm raw() const { return *handle_; } // not collective

    void barrier() const;
    double sum(double value) const;
    double max(double value) const;
    int max(int value) const;
    void sum(std::span<double> values) const; // element by element, in place
    void max(std::span<double> values) const;
    std::string broadcast(std::string text, int from = 0) const;
    long broadcast(long value, int from = 0) const;
    /// However many there are on the root.
    void broadcast(std::vector<double>& values, int from = 0) const;
    /// Every rank's values, in rank order, on every rank.
    std::vector<double> all_gather(std::span<const double> mine) const;
    std::vector<std::complex<double>> all_gather(std::span<const std::complex<double>> mine) const;
    /// Every rank's values in rank order on the root; empty elsewhere.
    std::vector<double> gather(std::span<const double> mine) const;
    /// To each rank its part of `sent`, in rank order, and from each its part of `received`.
    void all_to_all(const std::complex<double>* sent, std::span<const int> sent_counts,
                    std::complex<double>* received, std::span<const int> received_counts) const;

private:
    explicit Comm(std::shared_ptr<const MPI_Comm> handle);
    static Comm owned(MPI_Comm part);        // freed with its last copy
    std::shared_ptr<const MPI_Comm> handle_; // shared: freed by the last copy
    int rank_ = 0;
    int size_ = 1;
};

} // namespace shearwake
