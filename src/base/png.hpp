// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::image {

/// Row by row from the top; 0: black, 1: white.
struct GreyImage {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<double> greys;
};

/// A picture, or the reason why it was rejected.
struct DecodedImage {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<std::uint8_t> greys; // row by row from the top; 0: black, 255: white
    std::string problem;
};

/// Decodes a PNG file of at most 4096 x 4096 pixels. Colours become grey, and what is transparent
/// becomes black.
DecodedImage decode_png(std::string_view bytes);

/// Encodes a picture as a PNG file with 8 bits per pixel; values outside of 0 to 1 and NaN become
/// black or white. Throws Error if the library fails.
std::string encode_png(const GreyImage& image);

} // namespace shearwake::image
