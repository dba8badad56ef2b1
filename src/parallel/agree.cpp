// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/agree.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

namespace shearwake {
namespace {

/// How a rank has failed. Of fixed size, so that it is described and sent without an allocation.
struct Outcome {
    enum Kind : int { fine, peer_failed, case_failure, field_diverges, usage_error, file_failure };
    int kind = fine;
    int code = 0;        // of a usage error
    int persistence = 0; // of a usage error or a file failure
    int depth = 0;       // of the failure of another rank
    std::array<char, 4000> message{};

    Outcome() = default;
    Outcome(Kind failed, const char* what) : kind(failed) { append(what); }
    void append(const char* text) {
        const std::size_t used = std::strlen(message.data());
        const std::size_t more = std::min(std::strlen(text), message.size() - 1 - used);
        std::memcpy(message.data() + used, text, more);
    }
};

Outcome outcome_of(const UsageError& error) {
    Outcome outcome(Outcome::usage_error, error.what());
    outcome.code = static_cast<int>(error.code());
    outcome.persistence = static_cast<int>(error.persistence());
    return outcome;
}

/// Any other failure of the standard library or of a case.
Outcome outcome_of(const std::exception& error) {
    if (!std::ferror(stdout)) return {Outcome::case_failure, error.what()};
    // A failure of the output is not a failure of the case.
    Outcome outcome(Outcome::usage_error, "standard output: ");
    outcome.append(error.what());
    outcome.code = static_cast<int>(ExitCode::environment);
    return outcome;
}

Outcome outcome_of(const std::filesystem::filesystem_error& error) {
    Outcome outcome(Outcome::usage_error, error.path1().c_str());
    outcome.append(": ");
    outcome.append(std::strerror(error.code().value()));
    outcome.code = static_cast<int>(ExitCode::environment);
    return outcome;
}

Outcome outcome_of(const std::exception_ptr& thrown) {
    if (!thrown) return {};
    try {
        std::rethrow_exception(thrown);
    } catch (const PeerFailed& failure) {
        Outcome outcome(Outcome::peer_failed, "");
        outcome.depth = failure.depth();
        return outcome;
    } catch (const UsageError& error) {
        return outcome_of(error);
    } catch (const FileFailure& error) {
        Outcome outcome(Outcome::file_failure, error.what());
        outcome.persistence = static_cast<int>(error.persistence());
        return outcome;
    } catch (const FieldDiverges& error) {
        return {Outcome::field_diverges, error.what()};
    } catch (const std::filesystem::filesystem_error& error) {
        return outcome_of(error);
    } catch (const std::bad_alloc&) {
        return {Outcome::case_failure, "out of memory"};
    } catch (const std::exception& error) {
        return outcome_of(error);
    } catch (...) {
        return {Outcome::case_failure, "an exception of unknown type"};
    }
}

[[noreturn]] void rethrow(const Outcome& outcome) {
    const char* message = outcome.message.data();
    const auto persistence = static_cast<Persistence>(outcome.persistence);
    switch (outcome.kind) {
    case Outcome::usage_error:
        throw UsageError(message, static_cast<ExitCode>(outcome.code), persistence);
    case Outcome::file_failure:
        throw FileFailure(message, persistence);
    case Outcome::field_diverges:
        throw FieldDiverges(message);
    default:
        throw CaseFailure(message);
    }
}

/// Throws the error of the lowest rank that has one of its own, on all ranks. Collective.
[[noreturn]] void throw_first(Outcome outcome, const Comm& comm) {
    const bool own = outcome.kind > Outcome::peer_failed;
    int first = own ? comm.rank() : comm.size();
    if (comm.size() > 1) {
        MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm.raw());
        MPI_Bcast(&outcome, static_cast<int>(sizeof outcome), MPI_BYTE, first, comm.raw());
    }
    rethrow(outcome);
}

} // namespace

FailTogether::FailTogether(const Comm& comm) : comm_(comm), depth_(++comm.shared_->depth) {}

FailTogether::~FailTogether() {
    comm_.shared_->depth = depth_ - 1;
}

void FailTogether::settle(std::exception_ptr thrown) {
    const Outcome mine = outcome_of(thrown);
    thrown = nullptr; // frees what it holds before anything else is allocated
    // A rank that learned of the failure from others has already taken part in the agreement.
    const int depth = mine.kind == Outcome::peer_failed
                          ? mine.depth
                          : comm_.agree(mine.kind == Outcome::fine ? 0 : depth_);
    if (depth == 0) return;
    if (depth < depth_) throw PeerFailed(depth); // another rank failed outside this call
    throw_first(mine, comm_);
}

void together(const Comm& comm, const std::function<void()>& work) {
    std::exception_ptr thrown;
    try {
        work();
    } catch (...) {
        thrown = std::current_exception();
    }
    const Outcome mine = outcome_of(thrown);
    thrown = nullptr;
    if (comm.max(mine.kind) == Outcome::fine) return;
    comm.before_collective();
    throw_first(mine, comm);
}

void on_root(const Comm& comm, const std::function<void()>& work) {
    together(comm, [&] {
        if (comm.is_root()) work();
    });
}

} // namespace shearwake
