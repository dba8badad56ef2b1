// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "config/document/tree.hpp"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// Reads one table of a job with strict types. Units are converted only here: the suffix of a key
/// is its unit ("_mm"), and results are in SI. After an error, the reader reports its location and
/// continues with a valid substitute, so that one pass finds all errors. A requested key is known
/// from then on; `finish` reports all other keys as unknown.
class Reader {
public:
    /// A null `table` represents an absent table: it has no keys, and none are reported as missing.
    Reader(NodePtr table, std::string path, DiagnosticList& diagnostics);

    bool has(std::string_view key);
    /// Whether the table has an unknown key that can hardly stand for anything but `key`.
    bool has_misspelled(std::string_view key) const;
    /// The keys of the table, in the order of the file.
    std::vector<std::string> keys() const;
    bool empty() const { return !table_; }

    double number(std::string_view key, const Range& range);
    double number_or(std::string_view key, double fallback_SI, const Range& range);
    std::optional<double> find_number(std::string_view key, const Range& range);

    std::string word(std::string_view key);
    std::optional<std::string> find_word(std::string_view key);
    /// One of `allowed`; after an error, the first of them.
    std::string choice(std::string_view key, std::span<const std::string> allowed);
    std::string choice_or(std::string_view key, const std::string& fallback,
                          std::span<const std::string> allowed);
    /// After an error, the allowed word with a similar spelling, so that errors in keys that depend
    /// on it are found in the same pass; nothing if there is none.
    std::optional<std::string> find_choice(std::string_view key,
                                           std::span<const std::string> allowed);
    std::optional<bool> find_flag(std::string_view key);

    std::optional<std::vector<double>> find_numbers(std::string_view key, const Range& range);
    std::optional<std::vector<std::string>> find_words(std::string_view key);
    Vec2 point(std::string_view key, const Range& range = Range::any());
    Vec2 point_or(std::string_view key, Vec2 fallback_SI);
    std::optional<std::vector<Vec2>> find_points(std::string_view key);

    Reader table(std::string_view key);          // required
    Reader optional_table(std::string_view key); // empty() if absent
    std::vector<Reader> tables(std::string_view key);
    /// The node of this key, or null.
    NodePtr node(std::string_view key);

    /// Marks keys as known without reading them.
    template <class Keys>
    void allow(const Keys& keys) {
        known_.insert(known_.end(), std::begin(keys), std::end(keys));
    }

    /// Reports an error; `message` follows the full name of the key. Its location is the value, if
    /// present.
    void error(std::string_view key, std::string_view message) const;
    /// Reports that a key excludes another one: in a sweep once, not for each of its values.
    void conflict(std::string_view key, std::string_view message) const;
    void missing(std::string_view key);
    /// Reports that a key on which the others depend is missing, if it is. `finish` is not called
    /// then, since the other keys belong to some choice.
    void report_missing(std::string_view key);
    /// Reports unknown and missing keys. Call it after all keys have been requested.
    void finish();

    std::string full(std::string_view key) const; // "load.peak_Pa"
    Place place(std::string_view key) const;
    const std::string& path() const { return path_; }
    DiagnosticList& diagnostics() const { return *diagnostics_; }

private:
    std::string unknown_message(std::string_view key, std::optional<std::string>& meant) const;
    void wrong_kind(std::string_view key, std::string_view wanted, const Node& found) const;
    bool is_clean(std::string_view key, const std::string& word, const Node& node) const;
    std::optional<double> checked(std::string_view key, const Node& node, const Range& range) const;
    std::optional<Vec2> checked_point(std::string_view key, const Node& node,
                                      const Range& range) const;
    const ListNode* list(std::string_view key, std::string_view wanted);

    NodePtr table_;
    std::string path_;
    DiagnosticList* diagnostics_;
    std::vector<std::string> known_;
    std::vector<std::string> missing_;
    bool is_guessed_ = false; // a choice with an error, on which missing keys depend
};

} // namespace shearwake::config
