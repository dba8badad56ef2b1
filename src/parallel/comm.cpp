#include "parallel/comm.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <numeric>

namespace shearwake {
namespace {

void checked(int code) {
    if (code != MPI_SUCCESS) throw Error("MPI reports error " + std::to_string(code));
}

struct Layout {
    std::vector<int> counts;
    std::vector<int> offsets;
    std::size_t total = 0;
};

Layout layout_of(std::size_t mine, const Comm& comm) {
    Layout layout;
    layout.counts.resize(static_cast<std::size_t>(comm.size()));
    const int count = static_cast<int>(mine);
    checked(MPI_Allgather(&count, 1, MPI_INT, layout.counts.data(), 1, MPI_INT, comm.raw()));
    layout.offsets.resize(layout.counts.size());
    std::exclusive_scan(layout.counts.begin(), layout.counts.end(), layout.offsets.begin(), 0);
    layout.total = static_cast<std::size_t>(layout.offsets.back() + layout.counts.back());
    return layout;
}

template <class T>
std::vector<T> all_gather_as(std::span<const T> mine, MPI_Datatype type, const Comm& comm) {
    const Layout layout = layout_of(mine.size(), comm);
    std::vector<T> all(layout.total);
    checked(MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), type, all.data(),
                           layout.counts.data(), layout.offsets.data(), type, comm.raw()));
    return all;
}

} // namespace

Comm::Comm(std::shared_ptr<const MPI_Comm> handle) : handle_(std::move(handle)) {
    checked(MPI_Comm_rank(*handle_, &rank_));
    checked(MPI_Comm_size(*handle_, &size_));
}

Comm Comm::world() {
    return Comm(std::make_shared<const MPI_Comm>(MPI_COMM_WORLD));
}

Comm Comm::split(int color) const {
    MPI_Comm part = MPI_COMM_NULL;
    checked(MPI_Comm_split(raw(), color, rank_, &part));
    return owned(part);
}

Comm Comm::split_by_machine() const {
    MPI_Comm part = MPI_COMM_NULL;
    checked(MPI_Comm_split_type(raw(), MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &part));
    return owned(part);
}

Comm Comm::owned(MPI_Comm part) {
    const auto free_it = [](const MPI_Comm* handle) {
        int finalized = 0;
        MPI_Finalized(&finalized);
        MPI_Comm copy = *handle;
        // Freeing is collective: after an exception only the end of the program frees.
        if (!finalized && std::uncaught_exceptions() == 0) MPI_Comm_free(&copy);
        delete handle;
    };
    return Comm(std::shared_ptr<const MPI_Comm>(new MPI_Comm(part), free_it));
}

void Comm::barrier() const {
    checked(MPI_Barrier(raw()));
}

double Comm::sum(double value) const {
    sum(std::span<double>(&value, 1));
    return value;
}

double Comm::max(double value) const {
    max(std::span<double>(&value, 1));
    return value;
}

int Comm::max(int value) const {
    checked(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_MAX, raw()));
    return value;
}

void Comm::sum(std::span<double> values) const {
    checked(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE,
                          MPI_SUM, raw()));
}

void Comm::max(std::span<double> values) const {
    checked(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE,
                          MPI_MAX, raw()));
}

std::string Comm::broadcast(std::string text, int from) const {
    text.resize(static_cast<std::size_t>(broadcast(static_cast<long>(text.size()), from)));
    checked(MPI_Bcast(text.data(), static_cast<int>(text.size()), MPI_CHAR, from, raw()));
    return text;
}

long Comm::broadcast(long value, int from) const {
    checked(MPI_Bcast(&value, 1, MPI_LONG, from, raw()));
    return value;
}

void Comm::broadcast(std::vector<double>& values, int from) const {
    constexpr std::size_t piece = std::size_t{1} << 24; // MPI counts with int
    values.resize(static_cast<std::size_t>(broadcast(static_cast<long>(values.size()), from)));
    for (std::size_t start = 0; start < values.size(); start += piece)
        checked(MPI_Bcast(values.data() + start,
                          static_cast<int>(std::min(piece, values.size() - start)), MPI_DOUBLE,
                          from, raw()));
}

std::vector<double> Comm::all_gather(std::span<const double> mine) const {
    return all_gather_as<double>(mine, MPI_DOUBLE, *this);
}

std::vector<std::complex<double>>
Comm::all_gather(std::span<const std::complex<double>> mine) const {
    return all_gather_as<std::complex<double>>(mine, MPI_CXX_DOUBLE_COMPLEX, *this);
}

std::vector<double> Comm::gather(std::span<const double> mine) const {
    const Layout layout = layout_of(mine.size(), *this);
    std::vector<double> all(is_root() ? layout.total : 0);
    checked(MPI_Gatherv(mine.data(), static_cast<int>(mine.size()), MPI_DOUBLE, all.data(),
                        layout.counts.data(), layout.offsets.data(), MPI_DOUBLE, 0, raw()));
    return all;
}

void Comm::all_to_all(const std::complex<double>* sent, std::span<const int> sent_counts,
                      std::complex<double>* received, std::span<const int> received_counts) const {
    const auto offsets_of = [](std::span<const int> counts) {
        std::vector<int> offsets(counts.size());
        std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
        return offsets;
    };
    checked(MPI_Alltoallv(sent, sent_counts.data(), offsets_of(sent_counts).data(),
                          MPI_CXX_DOUBLE_COMPLEX, received, received_counts.data(),
                          offsets_of(received_counts).data(), MPI_CXX_DOUBLE_COMPLEX, raw()));
}

} // namespace shearwake
