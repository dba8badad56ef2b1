// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/comm.hpp"

#include "base/error.hpp"

#include <atomic>
#include <ctime>
#include <limits>
#include <numeric>

namespace shearwake {

namespace {

void checked(int code) {
    if (code == MPI_SUCCESS) return;
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(code, text, &length);
    throw Error("MPI: " + std::string(text, static_cast<std::size_t>(length)));
}

template <class T>
MPI_Datatype type_of() {
    if constexpr (std::same_as<T, double>) return MPI_DOUBLE;
    if constexpr (std::same_as<T, float>) return MPI_FLOAT;
    if constexpr (std::same_as<T, std::complex<double>>) return MPI_CXX_DOUBLE_COMPLEX;
    if constexpr (std::same_as<T, long>) return MPI_LONG;
    if constexpr (std::same_as<T, int>) return MPI_INT;
    if constexpr (std::same_as<T, char>) return MPI_CHAR;
}

/// Converts to MPI's type of counts.
int count_of(std::size_t values) {
    if (values > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error("MPI cannot send " + std::to_string(values) +
                    " values in one call (limit 2147483647)");
    return static_cast<int>(values);
}

/// Offsets of the contributions of the ranks in a common buffer.
struct Layout {
    std::vector<int> counts, offsets;
    std::size_t total = 0;
    template <class Counts>
    explicit Layout(const Counts& of_ranks) {
        for (const auto count : of_ranks) {
            counts.push_back(count_of(static_cast<std::size_t>(count)));
            offsets.push_back(count_of(total));
            total += static_cast<std::size_t>(count);
        }
    }
};

/// Throws on all ranks if the contribution of any rank is too large.
Layout layout_of(std::size_t mine, const Comm& comm) {
    const long count = static_cast<long>(mine);
    std::vector<long> counts(static_cast<std::size_t>(comm.size()));
    counts[0] = count;
    comm.before_collective();
    if (comm.size() > 1)
        checked(MPI_Allgather(&count, 1, MPI_LONG, counts.data(), 1, MPI_LONG, comm.raw()));
    count_of(static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0L)));
    return Layout(counts);
}

void reduce(std::span<double> values, MPI_Op operation, const Comm& comm) {
    const int count = count_of(values.size());
    comm.before_collective();
    if (comm.size() > 1)
        checked(
            MPI_Allreduce(MPI_IN_PLACE, values.data(), count, MPI_DOUBLE, operation, comm.raw()));
}

double reduced(double value, MPI_Op operation, const Comm& comm) {
    reduce(std::span<double>(&value, 1), operation, comm);
    return value;
}

int reduced(int value, MPI_Op operation, const Comm& comm) {
    comm.before_collective();
    if (comm.size() > 1)
        checked(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, operation, comm.raw()));
    return value;
}

} // namespace

Comm::Comm(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {
    if (shared_->handle == MPI_COMM_NULL) return;
    checked(MPI_Comm_rank(shared_->handle, &rank_));
    checked(MPI_Comm_size(shared_->handle, &size_));
}

Comm Comm::world() {
    int has_mpi = 0;
    MPI_Initialized(&has_mpi);
    return Comm(std::make_shared<Shared>(Shared{has_mpi != 0 ? MPI_COMM_WORLD : MPI_COMM_NULL}));
}

int Comm::agree(int failed) const {
    // The largest value must be that of the smallest depth.
    const auto turned = [](int depth) {
        return depth == 0 ? 0 : std::numeric_limits<int>::max() - depth;
    };
    int worst = turned(failed);
    if (size_ > 1)
        checked(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, shared_->handle));
    return worst == 0 ? 0 : std::numeric_limits<int>::max() - worst;
}

namespace {

std::atomic<double> last_progress_s = 0.0, longest_gap_s = 0.0;
std::atomic<int> unwatched = 0;
static_assert(std::atomic<double>::is_always_lock_free, "read by a signal handler");

double monotonic_s() {
    struct timespec now {};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

} // namespace

void Comm::mark_progress() {
    const double now_s = monotonic_s(), before_s = last_progress_s.exchange(now_s);
    if (before_s > 0.0) longest_gap_s = std::max(longest_gap_s.load(), now_s - before_s);
}

Comm::Unwatched::Unwatched() {
    ++unwatched;
}
Comm::Unwatched::~Unwatched() {
    mark_progress();
    --unwatched;
}

double Comm::overdue_s() {
    if (unwatched > 0) return 0.0;
    return monotonic_s() - last_progress_s - longest_gap_s;
}

void Comm::before_collective() const {
    mark_progress();
    if (shared_->depth == 0) return;
    if (const int depth = agree(0); depth != 0) throw PeerFailed(depth);
}

Comm Comm::split(int color) const {
    if (raw() == MPI_COMM_NULL) return *this;
    MPI_Comm part = MPI_COMM_NULL;
    before_collective();
    checked(MPI_Comm_split(raw(), color, rank_, &part));
    return owned(part);
}

namespace {
int machine_rank = 0;
} // namespace

Comm Comm::split_by_machine() const {
    if (raw() == MPI_COMM_NULL) return *this;
    MPI_Comm part = MPI_COMM_NULL;
    before_collective();
    checked(MPI_Comm_split_type(raw(), MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &part));
    checked(MPI_Comm_rank(part, &machine_rank));
    return owned(part);
}

int Comm::rank_on_machine() {
    return machine_rank;
}

Comm Comm::owned(MPI_Comm part) {
    const auto free_it = [](Shared* shared) {
        int finalized = 0;
        MPI_Finalized(&finalized);
        // Freeing is collective. After an exception other ranks may not reach this point, so the
        // communicator is left to the end of the program.
        if (!finalized && std::uncaught_exceptions() == 0) MPI_Comm_free(&shared->handle);
        delete shared;
    };
    return Comm(std::shared_ptr<Shared>(new Shared{part}, free_it));
}

void Comm::barrier() const {
    before_collective();
    if (size_ > 1) checked(MPI_Barrier(raw()));
}

double Comm::sum(double value) const {
    return reduced(value, MPI_SUM, *this);
}

double Comm::max(double value) const {
    return reduced(value, MPI_MAX, *this);
}

double Comm::min(double value) const {
    return reduced(value, MPI_MIN, *this);
}

int Comm::max(int value) const {
    return reduced(value, MPI_MAX, *this);
}

int Comm::min(int value) const {
    return reduced(value, MPI_MIN, *this);
}

void Comm::sum(std::span<double> values) const {
    reduce(values, MPI_SUM, *this);
}

void Comm::max(std::span<double> values) const {
    reduce(values, MPI_MAX, *this);
}

template <Sendable T>
void Comm::broadcast_in_place(std::span<T> values, int from) const {
    constexpr std::size_t piece = std::size_t{1} << 24; // MPI counts are of type int
    for (std::size_t start = 0; start < values.size(); start += piece) {
        const auto part = values.subspan(start, std::min(piece, values.size() - start));
        const int count = count_of(part.size());
        before_collective();
        if (size_ > 1) checked(MPI_Bcast(part.data(), count, type_of<T>(), from, raw()));
    }
}

std::string Comm::broadcast(std::string text, int from) const {
    text.resize(static_cast<std::size_t>(broadcast(static_cast<long>(text.size()), from)));
    broadcast_in_place(std::span<char>(text), from);
    return text;
}

template <Sendable T>
std::vector<T> Comm::all_gather(std::span<const T> mine) const {
    const Layout layout = layout_of(mine.size(), *this);
    if (size_ == 1) return {mine.begin(), mine.end()};
    std::vector<T> all(layout.total);
    const int count = count_of(mine.size());
    before_collective();
    checked(MPI_Allgatherv(mine.data(), count, type_of<T>(), all.data(), layout.counts.data(),
                           layout.offsets.data(), type_of<T>(), raw()));
    return all;
}

template <Sendable T>
std::vector<T> Comm::gather(std::span<const T> mine) const {
    const Layout layout = layout_of(mine.size(), *this);
    if (size_ == 1) return {mine.begin(), mine.end()};
    std::vector<T> all(is_root() ? layout.total : 0);
    const int count = count_of(mine.size());
    before_collective();
    checked(MPI_Gatherv(mine.data(), count, type_of<T>(), all.data(), layout.counts.data(),
                        layout.offsets.data(), type_of<T>(), 0, raw()));
    return all;
}

template <Sendable T>
void Comm::all_to_all(std::span<const T> sent, std::span<const std::ptrdiff_t> sent_counts,
                      std::span<T> received,
                      std::span<const std::ptrdiff_t> received_counts) const {
    const Layout out(sent_counts), in(received_counts);
    if (out.total > sent.size() || in.total > received.size())
        throw Error("all-to-all: the counts exceed the size of a buffer");
    before_collective();
    if (size_ == 1 && out.total == in.total) {
        std::ranges::copy(sent.first(out.total), received.begin());
        return;
    }
    checked(MPI_Alltoallv(sent.data(), out.counts.data(), out.offsets.data(), type_of<T>(),
                          received.data(), in.counts.data(), in.offsets.data(), type_of<T>(),
                          raw()));
}

// Explicit instantiations for all types that are sent.
template void Comm::broadcast_in_place(std::span<double>, int) const;
template void Comm::broadcast_in_place(std::span<long>, int) const;
template void Comm::broadcast_in_place(std::span<int>, int) const;
template std::vector<double> Comm::all_gather(std::span<const double>) const;
template std::vector<long> Comm::all_gather(std::span<const long>) const;
template std::vector<std::complex<double>>
    Comm::all_gather(std::span<const std::complex<double>>) const;
template std::vector<double> Comm::gather(std::span<const double>) const;
template std::vector<float> Comm::gather(std::span<const float>) const;
template std::vector<long> Comm::gather(std::span<const long>) const;
template void Comm::all_to_all(std::span<const double>, std::span<const std::ptrdiff_t>,
                               std::span<double>, std::span<const std::ptrdiff_t>) const;
template void Comm::all_to_all(std::span<const float>, std::span<const std::ptrdiff_t>,
                               std::span<float>, std::span<const std::ptrdiff_t>) const;
template void Comm::all_to_all(std::span<const std::complex<double>>,
                               std::span<const std::ptrdiff_t>, std::span<std::complex<double>>,
                               std::span<const std::ptrdiff_t>) const;

double RowSums::mine() const {
    return std::accumulate(rows_.begin(), rows_.end(), 0.0);
}

double RowSums::team_sum(const Comm& team) const {
    RowSums all = *this;
    team.sum(std::span<double>(all.rows_)); // exact: all ranks but one add 0
    return all.mine();
}

} // namespace shearwake
