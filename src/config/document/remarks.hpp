// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "case/remark.hpp"
#include "config/document/tree.hpp"

#include <map>
#include <string>
#include <tuple>

namespace shearwake::config {

/// Collects the remarks of `check` on the cases of a sweep. Remarks that differ only in their
/// numbers are combined and counted.
class Remarks {
public:
    /// Checks a case that was read from `root`, which provides the location of the key of a remark.
    void add(const Case& c, const NodePtr& root);
    void report(DiagnosticList& diagnostics) const;

private:
    struct Group {
        Remark first;
        Place at;
        std::size_t others = 0; // number of cases with other numbers
    };
    std::map<std::tuple<Severity, std::string, std::string>, Group> groups_;
    std::vector<const Group*> order_;
};

} // namespace shearwake::config
