#pragma once

#include "model/check.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace shearwake {

/// Something about a job that its author should know, and where it stands. Line 0: nowhere in
/// particular.
struct Finding {
    Severity severity = Severity::error;
    std::string file;
    int line = 0;
    int column = 0;
    std::string message;
    bool operator==(const Finding&) const = default;
};

/// "job.toml:31:5: error: ..."
std::string text(const Finding& finding);

/// A place in a job file or in an override.
struct Place {
    std::shared_ptr<const std::string> file;
    int line = 0;
    int column = 0;
};

/// `text` with everything unprintable replaced, cut to `limit` characters: fit to be quoted.
std::string excerpt(std::string_view text, std::size_t limit = 60);

/// Collects findings. The same one, met again in another case of a sweep, is kept once.
class Diagnostics {
public:
    void error(const Place& at, std::string message);
    void warning(const Place& at, std::string message);

    /// Errors reported so far, repeated ones included: it grows whenever something is wrong.
    std::size_t errors() const { return errors_; }
    /// There are so many that more are only counted: what costs time to word can be left out.
    bool full() const { return findings_.size() >= most; }
    /// In the order of the file.
    std::vector<Finding> sorted() const;

private:
    static constexpr std::size_t most = 1000;
    void add(Severity severity, const Place& at, std::string message);

    std::vector<Finding> findings_;
    std::unordered_set<std::string> seen_;
    std::size_t errors_ = 0;
};

} // namespace shearwake
