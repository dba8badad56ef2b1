// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>

namespace shearwake {

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

} // namespace shearwake
