#pragma once

#include <stdexcept>
#include <string>

namespace shearwake {

/// What the program says to the shell when it ends; the numbers are part of the user's contract.
enum class ExitCode : int {
    done = 0,
    internal = 1,
    usage = 2,
    bad_job = 3,
    some_cases_failed = 4,
    differs_from_baseline = 5,
    environment = 6,
    stopped_early = 75, // saved: start the same command again (EX_TEMPFAIL of sysexits.h)
};

/// Anything that is neither the user's nor a case's fault. Ends the whole run.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Whether the same attempt may go better a moment later (a network file system that recovers), or
/// not before somebody has mended something (a full disk).
enum class Trouble : int { lasting, passing };

/// The user can mend it; thrown identically on all ranks. Carries the exit code it deserves.
class UsageError : public Error {
public:
    explicit UsageError(const std::string& what, ExitCode code = ExitCode::usage,
                        Trouble trouble = Trouble::lasting)
        : Error(what), code_(code), trouble_(trouble) {}
    ExitCode code() const { return code_; }
    Trouble trouble() const { return trouble_; }

private:
    ExitCode code_;
    Trouble trouble_;
};

/// One case cannot be computed or written; thrown by all ranks of its team together.
/// The sweep records the reason and goes on.
class CaseFailure : public Error {
public:
    using Error::Error;
};

/// A file or a disk does not do what it should: no case's own fault. Within one rank's work it may
/// be thrown by that rank alone, see together().
class FileFailure : public CaseFailure {
public:
    FileFailure(const std::string& what, Trouble trouble) : CaseFailure(what), trouble_(trouble) {}
    Trouble trouble() const { return trouble_; }

private:
    Trouble trouble_;
};

/// A field that has grown beyond all bounds: what has been saved of the case is worth nothing.
class FieldDiverges : public CaseFailure {
public:
    using CaseFailure::CaseFailure;
};

} // namespace shearwake
