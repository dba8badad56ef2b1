#include "parallel/agree.hpp"

#include "base/error.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace shearwake {
namespace {

struct Outcome {
    long kind = 0; // 0 fine, 1 case failure, 2 usage error
    long code = 0; // of a usage error
    std::string message;
};

Outcome outcome_of(const std::function<void()>& work) {
    try {
        work();
        return {};
    } catch (const UsageError& error) {
        return {2, static_cast<long>(error.code()), error.what()};
    } catch (const std::filesystem::filesystem_error& error) {
        return {2, static_cast<long>(ExitCode::environment),
                fmt::format("{}: {}", error.path1().string(), error.code().message())};
    } catch (const std::bad_alloc&) {
        return {1, 0, "out of memory"};
    } catch (const std::exception& error) {
        return {1, 0, error.what()};
    }
}

} // namespace

void together(const Comm& comm, const std::function<void()>& work) {
    Outcome mine = outcome_of(work);
    // The lowest rank that failed speaks; -1 while nobody did.
    const int speaker =
        comm.size() - 1 - comm.max(mine.kind != 0 ? comm.size() - 1 - comm.rank() : -1);
    if (speaker == comm.size()) return;
    const long kind = comm.broadcast(mine.kind, speaker);
    const long code = comm.broadcast(mine.code, speaker);
    const std::string message = comm.broadcast(mine.message, speaker);
    if (kind == 2) throw UsageError(message, static_cast<ExitCode>(code));
    throw CaseFailure(message);
}

void on_root(const Comm& comm, const std::function<void()>& work) {
    together(comm, [&] {
        if (comm.is_root()) work();
    });
}

} // namespace shearwake
