// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace shearwake {

/// Exit codes of the program. The numbers are part of the documented interface.
enum class ExitCode : int {
    done = 0,
    internal = 1,
    usage = 2,
    bad_job = 3,
    some_cases_failed = 4,
    environment = 6,
    stopped_early =
        75, // results are saved; rerun the command to resume (EX_TEMPFAIL of sysexits.h)
};

/// Of a message about a job or a case.
enum class Severity { warning, error };

/// An error caused neither by the user nor by a single case. It ends the whole run.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Whether a retry may succeed shortly (passing: a network file system that recovers) or only after
/// an intervention (lasting: a full disk).
enum class Persistence : int { lasting, passing };

/// An error that the user can correct. All ranks throw it with identical contents. It carries the
/// exit code of the program.
class UsageError : public Error {
public:
    explicit UsageError(const std::string& what, ExitCode code = ExitCode::usage,
                        Persistence persistence = Persistence::lasting)
        : Error(what), code_(code), persistence_(persistence) {}
    ExitCode code() const { return code_; }
    Persistence persistence() const { return persistence_; }

private:
    ExitCode code_;
    Persistence persistence_;
};

/// One case cannot be computed or written. All ranks of its team throw it together. The sweep
/// records the reason and continues with the next case.
class CaseFailure : public Error {
public:
    using Error::Error;
};

/// A file or a disk fails; the case itself is not at fault. Inside together() a single rank may
/// throw it.
class FileFailure : public CaseFailure {
public:
    FileFailure(const std::string& what, Persistence persistence)
        : CaseFailure(what), persistence_(persistence) {}
    Persistence persistence() const { return persistence_; }

private:
    Persistence persistence_;
};

/// The field has grown beyond all bounds. The checkpoints of the case are unusable.
class FieldDiverges : public CaseFailure {
public:
    using CaseFailure::CaseFailure;
};

} // namespace shearwake
