// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <istream>
#include <string>

namespace shearwake {

/// Reads the next line, or the text up to the next `end`; false at the end of the stream. Rethrows
/// an exception that interrupted the reading, such as std::bad_alloc, which std::getline() reports
/// as the end of the stream, so that a file would be read in part. From then on the stream throws
/// such exceptions in all operations. Not collective.
inline bool next_line(std::istream& in, std::string& line, char end = '\n') {
    in.exceptions(std::ios::badbit);
    return static_cast<bool>(std::getline(in, line, end));
}

} // namespace shearwake
