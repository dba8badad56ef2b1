// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// The keys of a job in full, such as "load.peak_Pa" and "medium.layer[1].c_s_m_s".
std::vector<std::string> key_names();

/// "did you mean load.peak_Pa?" for the end of a key, such as "peak_Pa". Empty if no key of a job
/// ends in this way, or more than three do.
std::string full_key_hint(std::string_view ending);

} // namespace shearwake::config
