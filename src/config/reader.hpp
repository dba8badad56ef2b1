#pragma once

#include "base/vec2.hpp"
#include "config/tree.hpp"

#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// What a number may be, in the unit of its key.
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool least_excluded = false;
    bool most_excluded = false;

    static Range any() { return {}; }
    static Range above(double least) { return {.least = least, .least_excluded = true}; }
    static Range at_least(double least) { return {.least = least}; }
    static Range between(double least, double most) { return {.least = least, .most = most}; }
    static Range inside(double least, double most) { return {least, most, true, true}; }

    bool holds(double value) const;
    std::string words() const; // "above 0"
};

/// One table of a job: typed, strict, and the only place where units are converted. A key's
/// suffix is its unit ("_mm"); what comes out is SI. A mistake is reported with its place and the
/// reader goes on with a harmless value, so that one reading finds them all. Every key that is
/// asked for is known from then on; `finish` reports the others.
class Reader {
public:
    /// A null `table` stands for one that is not there: it has no keys and lacks none.
    Reader(NodePtr table, std::string path, Diagnostics& findings);

    bool has(std::string_view key);
    bool empty() const { return !table_; }

    double number(std::string_view key, const Range& range);
    double number_or(std::string_view key, double fallback_SI, const Range& range);
    std::optional<double> find_number(std::string_view key, const Range& range);

    std::string word(std::string_view key);
    std::optional<std::string> find_word(std::string_view key);
    /// One of `allowed`; the first of them after a mistake.
    std::string choice(std::string_view key, std::span<const std::string> allowed);
    std::string choice_or(std::string_view key, const std::string& fallback,
                          std::span<const std::string> allowed);
    std::optional<std::string> find_choice(std::string_view key,
                                           std::span<const std::string> allowed);
    bool flag_or(std::string_view key, bool fallback);

    std::optional<std::vector<double>> find_numbers(std::string_view key, const Range& range);
    std::optional<std::vector<std::string>> find_words(std::string_view key);
    Vec2 point(std::string_view key, const Range& range = Range::any());
    Vec2 point_or(std::string_view key, Vec2 fallback_SI);
    std::optional<std::vector<Vec2>> find_points(std::string_view key);

    Reader table(std::string_view key);          // required
    Reader optional_table(std::string_view key); // empty() if it is not there
    std::vector<Reader> tables(std::string_view key);
    /// Whatever is there, or null.
    NodePtr node(std::string_view key);

    /// Makes keys known without looking at them.
    template <class Keys>
    void allow(const Keys& keys) {
        known_.insert(known_.end(), std::begin(keys), std::end(keys));
    }

    /// `message` follows the key's full name. Stands at the value if there is one.
    void error(std::string_view key, std::string_view message) const;
    void missing(std::string_view key);
    /// Unknown and missing keys. To be called when all has been asked for.
    void finish();

    std::string full(std::string_view key) const; // "load.peak_Pa"
    Place place(std::string_view key) const;
    const std::string& path() const { return path_; }
    Diagnostics& findings() const { return *findings_; }

private:
    std::string unknown_message(std::string_view key, std::optional<std::string>& meant) const;
    void wrong_kind(std::string_view key, std::string_view wanted, const Node& found) const;
    std::optional<double> checked(std::string_view key, const Node& node, const Range& range) const;
    std::optional<Vec2> checked_point(std::string_view key, const Node& node,
                                      const Range& range) const;
    const ListNode* list(std::string_view key, std::string_view wanted);

    NodePtr table_;
    std::string path_;
    Diagnostics* findings_;
    std::vector<std::string_view> known_;
    std::vector<std::string_view> missing_;
};

} // namespace shearwake
