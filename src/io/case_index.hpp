#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// A scalar of a case file; NaN: no value, `note` says why.
struct IndexedScalar {
    std::string name;
    double value = 0.0;
    std::string note;
};

/// What tables need of one case file.
struct CaseDigest {
    std::string id;     // the name of the file
    std::string status; // "complete" or, where the file cannot be read, "damaged"
    std::string damage; // why it is damaged
    std::string git_id; // of the program that computed it
    double wall_s = 0.0;
    std::vector<IndexedScalar> scalars; // in the order of the file

    bool whole() const { return status == "complete"; }
};

/// What tells one state of a file from another.
struct CaseStamp {
    std::uintmax_t size = 0;
    std::int64_t changed_ns = 0;
    bool operator==(const CaseStamp&) const = default;
};

/// What the case files of an output folder say, kept in `index*.jsonl` beside them, so that ten
/// thousand need not be opened every time. A line counts while its file has the size and the time
/// of change that it names; whatever is missing is read from the files. Deleting the index is
/// harmless. Not collective.
class CaseIndex {
public:
    /// Reads what there is; lines that are damaged count as missing.
    explicit CaseIndex(std::filesystem::path folder);

    /// Nothing where there is no such file. The pointer stays valid.
    const CaseDigest* find(const std::string& id);
    bool is_whole(const std::string& id) {
        const CaseDigest* digest = find(id);
        return digest && digest->whole();
    }
    /// Adds to the index what had to be read. Where the folder cannot be written nothing is kept.
    void save();

private:
    struct Entry {
        CaseStamp stamp;
        CaseDigest digest;
    };

    std::filesystem::path case_file(const std::string& id) const;
    bool take_known(const std::string& id, const CaseStamp& stamp);
    void read_missing();

    std::filesystem::path folder_;
    std::map<std::string, Entry> known_; // as the lines say
    std::map<std::string, CaseDigest> checked_;
    std::string news_; // lines
};

/// Adds one case, just written, to the index file `index`. Failing is harmless. Not collective.
void add_to_index(const std::filesystem::path& index, const std::filesystem::path& case_file);

/// The index file beside a journal of that name.
std::string index_name(const std::string& journal_name);

} // namespace shearwake
