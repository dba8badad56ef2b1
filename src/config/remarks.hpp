#pragma once

#include "config/tree.hpp"

#include <map>
#include <string>
#include <tuple>

namespace shearwake {

/// Gathers what `check` says about the cases of a sweep: the same thing once, with a count where
/// only its numbers differ from case to case.
class Remarks {
public:
    /// Checks a case that was read from `root`, where the key of a remark has its place.
    void add(const Case& c, const NodePtr& root);
    void report(Diagnostics& findings) const;

private:
    struct Group {
        Remark first;
        Place at;
        std::size_t others = 0; // cases with other numbers
    };
    std::map<std::tuple<Severity, std::string, std::string>, Group> groups_;
    std::vector<const Group*> order_;
};

} // namespace shearwake
