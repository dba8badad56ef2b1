// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shearwake {

// The labels of keys and columns, which analysis/shearwake/labels.csv defines for the program and
// the Python package.

/// The label of a key or a column without its unit: "efficiency η" of "eta_period_1", "shear-wave
/// speed, layer 1" of "medium.layer[1].c_s_m_s"; the words of a name that has no label.
std::string label_of(std::string_view name);
/// The unit of a key or a column as in figures: "µm" of "peak_um"; empty for a number.
std::string unit_label(std::string_view name);
/// The label with its unit: "AM frequency (Hz)".
std::string axis_label(std::string_view name);

} // namespace shearwake
