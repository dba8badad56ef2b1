// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "problem/case/volume.hpp"
#include "storage/checksum/checksum.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace shearwake::storage {

/// A text of which the program keeps one copy, however often it occurs, until it ends: names of
/// columns and reasons for empty cells, which ten thousand cases have in common. Not for use by
/// several threads.
class SharedText {
public:
    SharedText(const std::string& text = {}) : text_(&*kept().insert(text).first) {}
    const std::string& text() const { return *text_; }
    bool empty() const { return text_->empty(); }
    bool operator==(std::string_view other) const { return *text_ == other; }

private:
    static std::unordered_set<std::string>& kept() {
        static std::unordered_set<std::string> texts;
        return texts;
    }
    const std::string* text_;
};

/// A scalar of a case file; NaN: no value, `note` gives the reason.
struct IndexedScalar {
    SharedText name;
    double value = 0.0;
    SharedText note;
};

/// The data of one case file that tables require.
struct CaseDigest {
    std::string id;     // the name of the file
    std::string status; // "complete" or, where the file cannot be read, "damaged"
    std::string damage; // why it is damaged
    bool is_lost =
        false; // the bytes have changed, in contrast to a file that currently cannot be read
    std::string git_id; // git id of the program that computed it
    double wall_s = 0.0;
    std::vector<Remark> warnings;       // severity error: the readings are not valid
    std::vector<IndexedScalar> scalars; // in the order of the file

    bool is_complete() const { return status == "complete"; }
    /// Whether no warning states that the readings are not valid.
    bool is_valid() const {
        for (const Remark& warning : warnings)
            if (warning.severity == Severity::error) return false;
        return true;
    }
};

/// The id in the name `<id>.h5` of a case file; empty for other names, among them those of copies
/// that other programs make, such as `<id> (1).h5` and `._<id>.h5`.
std::string id_of_file(const std::filesystem::path& file);

/// Identifies a version of a file. The time is that of the last change to the file or its
/// attributes (ctime), which programs cannot set.
struct CaseStamp {
    std::uintmax_t size = 0;
    std::int64_t changed_ns = 0;
    bool operator==(const CaseStamp&) const = default;
};

/// The scalars of the case files of an output folder, stored in `index*.jsonl` next to them, so
/// that ten thousand files need not be opened every time. A line is valid if its checksum matches
/// and its file has the recorded size and time of change. Missing data are read from the files,
/// whose checksums are verified. Detected damage is also recorded for the next run. The index can
/// be deleted without harm. Not collective.
class CaseIndex {
public:
    /// The condition for using a line of the index: size and time of the file match, or its bytes
    /// do as well, which are then read and verified once.
    enum class Trust { size_and_time, checksum };

    /// Reads the existing index; damaged lines are treated as missing.
    explicit CaseIndex(std::filesystem::path folder, Trust trust = Trust::size_and_time,
                       std::function<void(const VerifyProgress&)> report = {});

    /// Null if there is no such file. The pointer stays valid.
    const CaseDigest* find(const std::string& id);
    /// The entries of all case files in the folder, in the order of their names.
    const std::map<std::string, CaseDigest>& digests();
    /// Number of lines of the index that were ignored: damaged or truncated.
    long lines_skipped() const { return lines_skipped_; }
    /// Number of bytes that were read to verify checksums.
    double verified_B() const { return verified_B_; }
    bool is_complete(const std::string& id) {
        const CaseDigest* digest = find(id);
        return digest && digest->is_complete();
    }
    /// Adds the entries that were read from files to the index. Has no effect if the folder is not
    /// writable.
    void save();

private:
    struct Entry {
        CaseStamp stamp;
        CaseDigest digest;
    };

    std::filesystem::path case_file(const std::string& id) const;
    bool accept_known(const std::string& id, const CaseStamp& stamp);
    void read_missing();
    void put(const std::string& id, const CaseStamp& stamp, CaseDigest digest);

    std::filesystem::path folder_;
    Trust trust_;
    std::function<void(const VerifyProgress&)> report_;
    long lines_skipped_ = 0;
    double verified_B_ = 0.0;
    std::map<std::string, Entry> known_; // according to the lines
    std::map<std::string, CaseDigest> checked_;
    std::string news_; // lines
};

/// What tables require of a case whose file contains these groups, of which the first is the root,
/// and attributes.
CaseDigest digest_of(const std::vector<VariableGroup>& groups,
                     const std::vector<Attribute>& attributes);

/// Adds a case that was just written to the index file `index`. A failure has no consequences. Not
/// collective.
void add_to_index(const std::filesystem::path& index, const std::filesystem::path& case_file,
                  const CaseDigest& digest);

/// The index file that belongs to a journal of that name.
std::string index_name(const std::string& journal_name);

/// Writes groups of variables to a separate HDF5 file that xarray can open; the file is complete or
/// absent. Not collective. Throws Error if it cannot be written.
void write_record(const std::filesystem::path& path, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes);

} // namespace shearwake::storage
