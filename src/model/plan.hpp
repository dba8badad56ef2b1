#pragma once

#include "model/case.hpp"

#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// One swept key as the job file spells it ("load.modulation.am_frequency_Hz", in the job's unit)
/// and the value this case has there. Words and flags are text.
struct Setting {
    std::string key;
    std::variant<double, std::string> value;
    bool operator==(const Setting&) const = default;
};

/// A case with its place in the sweep.
struct PlannedCase {
    std::string id; // case_id(physics)
    Case physics;
    std::vector<Setting> settings; // one per swept key that this case has, in the job's order
    bool is_reference = false;     // the unmodulated case beside the sweep
    std::string reference_id;      // of the case it is compared with; empty if there is none
    bool operator==(const PlannedCase&) const = default;
};

/// How the results are laid out: rows, curves.
struct TableOptions {
    std::string x;                   // swept key along the abscissa; empty: no natural one
    std::vector<std::string> series; // swept keys, one curve per combination of their values
    bool operator==(const TableOptions&) const = default;
};

/// A job, expanded: what `plan.json` holds.
struct Plan {
    std::string name;
    std::string title;
    std::vector<std::string> swept_keys; // in the job's order
    TableOptions table;
    std::vector<PlannedCase> cases; // in the job's order, references last
    bool operator==(const Plan&) const = default;
};

} // namespace shearwake
