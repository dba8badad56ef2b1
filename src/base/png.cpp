// SPDX-License-Identifier: BSD-3-Clause
#include "base/png.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <png.h>
#include <stdexcept>

namespace shearwake::image {
namespace {

constexpr std::uint32_t largest_side = 4096;

/// Frees what the library keeps for a picture.
struct Png {
    png_image image = {};
    Png() { image.version = PNG_IMAGE_VERSION; }
    ~Png() { png_image_free(&image); }
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
};

} // namespace

DecodedImage decode_png(std::string_view bytes) {
    DecodedImage decoded;
    Png png;
    if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) {
        decoded.problem = fmt::format("it is not a valid PNG file ({})", png.image.message);
        return decoded;
    }
    if (png.image.width > largest_side || png.image.height > largest_side) {
        decoded.problem =
            fmt::format("it has {} x {} pixels, but at most {} x {} are supported", png.image.width,
                        png.image.height, largest_side, largest_side);
        return decoded;
    }
    png.image.format = PNG_FORMAT_GRAY;
    decoded.greys.resize(PNG_IMAGE_SIZE(png.image));
    const png_color black = {0, 0, 0};
    if (png_image_finish_read(&png.image, &black, decoded.greys.data(), 0, nullptr) == 0)
        decoded.problem = fmt::format("it is not a valid PNG file ({})", png.image.message);
    decoded.columns = static_cast<std::ptrdiff_t>(png.image.width);
    decoded.rows = static_cast<std::ptrdiff_t>(png.image.height);
    return decoded;
}

std::string encode_png(const GreyImage& image) {
    std::vector<std::uint8_t> greys;
    for (const double grey : image.greys)
        greys.push_back(grey > 0.0
                            ? static_cast<std::uint8_t>(std::lround(255.0 * std::min(grey, 1.0)))
                            : std::uint8_t{0});
    Png png;
    png.image.width = static_cast<png_uint_32>(image.columns);
    png.image.height = static_cast<png_uint_32>(image.rows);
    png.image.format = PNG_FORMAT_GRAY;
    png_alloc_size_t size = 0;
    std::string bytes;
    if (png_image_write_get_memory_size(png.image, size, 0, greys.data(), 0, nullptr) != 0) {
        bytes.resize(size);
        if (png_image_write_to_memory(&png.image, bytes.data(), &size, 0, greys.data(), 0,
                                      nullptr) != 0) {
            bytes.resize(size);
            return bytes;
        }
    }
    throw std::runtime_error(
        fmt::format("a PNG picture could not be encoded: {}", png.image.message));
}

} // namespace shearwake::image
