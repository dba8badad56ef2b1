// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/diagnostic.hpp"
#include "config/document/tree.hpp"
#include "problem/case/plan.hpp"

#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace shearwake::config {

/// Collects the remarks of `check` on the cases of a sweep. Remarks that differ only in their
/// numbers are combined: the case that needs the largest domain, otherwise the first one, is
/// reported with the number of further cases.
class SweepRemarks {
public:
    /// Checks a case that was read from `root`, which provides the location of the key of a remark.
    void add(const Case& c, const NodePtr& root);
    void report(DiagnosticList& diagnostics) const;

private:
    struct Group {
        Remark reported;
        Place at;
        std::size_t cases = 0;
        std::size_t last_case = 0; // number of the last counted case, from 1
    };
    std::map<std::tuple<Severity, std::string, std::string>, Group> groups_;
    std::vector<const Group*> order_;
    std::size_t added_ = 0; // number of cases
};

} // namespace shearwake::config
