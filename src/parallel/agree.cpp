// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/agree.hpp"

#include "base/error.hpp"

#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace shearwake {
namespace {

struct Outcome {
    enum Kind : long { fine, case_failure, usage_error, file_failure };
    long kind = fine;
    long code = 0;    // of a usage error
    long trouble = 0; // of a usage error or a file failure
    std::string message;
};

Outcome outcome_of(const std::function<void()>& work) {
    try {
        work();
        return {};
    } catch (const UsageError& error) {
        return {Outcome::usage_error, static_cast<long>(error.code()),
                static_cast<long>(error.trouble()), error.what()};
    } catch (const FileFailure& error) {
        return {Outcome::file_failure, 0, static_cast<long>(error.trouble()), error.what()};
    } catch (const std::filesystem::filesystem_error& error) {
        return {Outcome::usage_error, static_cast<long>(ExitCode::environment), 0,
                fmt::format("{}: {}", error.path1().string(), error.code().message())};
    } catch (const std::bad_alloc&) {
        return {Outcome::case_failure, 0, 0, "out of memory"};
    } catch (const std::exception& error) {
        if (std::ferror(stdout)) // a failure of the output is not a failure of the case
            return {Outcome::usage_error, static_cast<long>(ExitCode::environment), 0,
                    fmt::format("standard output: {}", error.what())};
        return {Outcome::case_failure, 0, 0, error.what()};
    }
}

} // namespace

void together(const Comm& comm, const std::function<void()>& work) {
    Outcome mine = outcome_of(work);
    // The lowest failed rank provides the error; comm.size() if no rank failed.
    const int failed =
        comm.size() - 1 - comm.max(mine.kind != 0 ? comm.size() - 1 - comm.rank() : -1);
    if (failed == comm.size()) return;
    const long kind = comm.broadcast(mine.kind, failed);
    const long code = comm.broadcast(mine.code, failed);
    const std::string message = comm.broadcast(mine.message, failed);
    const auto trouble = static_cast<Trouble>(comm.broadcast(mine.trouble, failed));
    if (kind == Outcome::usage_error)
        throw UsageError(message, static_cast<ExitCode>(code), trouble);
    if (kind == Outcome::file_failure) throw FileFailure(message, trouble);
    throw CaseFailure(message);
}

void on_root(const Comm& comm, const std::function<void()>& work) {
    together(comm, [&] {
        if (comm.is_root()) work();
    });
}

} // namespace shearwake
