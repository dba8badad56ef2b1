// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/text.hpp"
#include "config/sections/read_fields.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr std::array optimised_parts = {OptimisedPart::envelope, OptimisedPart::speed_profile,
                                        OptimisedPart::speed, OptimisedPart::size};

/// In a fixed order and without duplicates.
std::vector<OptimisedPart> read_over(Reader& reader) {
    const auto names = reader.find_words("over");
    if (!names) return {OptimisedPart::envelope};
    const auto contains = [](const auto& list, const std::string& name) {
        return std::find(list.begin(), list.end(), name) != list.end();
    };
    std::vector<std::string> known;
    std::vector<OptimisedPart> over;
    for (const OptimisedPart part : optimised_parts) {
        known.emplace_back(name_in_text(part));
        if (contains(*names, known.back())) over.push_back(part);
    }
    for (const std::string& name : *names)
        if (!contains(known, name))
            reader.error("over", fmt::format("must contain only {}, but contains \"{}\"",
                                             quoted_list(known), excerpt(name)));
    if (!contains(*names, known.front()))
        reader.error("over", "must contain \"envelope\", which is always optimised");
    return over;
}

bool varies_factor(const OptimiseOptions& options) {
    return std::ranges::any_of(options.over, [](OptimisedPart part) {
        return part == OptimisedPart::speed || part == OptimisedPart::size;
    });
}

} // namespace

std::optional<OptimiseOptions> read_optimise(Reader reader) {
    if (reader.empty()) return std::nullopt;
    OptimiseOptions options;
    read_fields(reader, options);
    options.over = read_over(reader);
    if (options.strengths.empty())
        reader.error("strength_at_least", "must contain at least one number");
    if (reader.has("bits") && !reader.has("update_rate_Hz"))
        reader.error("bits", "applies only with update_rate_Hz");
    if (reader.has("robust_strength") && !reader.has("robust_to"))
        reader.error("robust_strength", "applies only with robust_to");
    for (const double strength : options.robust_strengths)
        if (std::ranges::find(options.strengths, strength) == options.strengths.end())
            reader.error("robust_strength",
                         fmt::format("{:g} is not a value of strength_at_least", strength));
    if (reader.has("factor_at_most") && !varies_factor(options))
        reader.error("factor_at_most", "applies only with \"speed\" or \"size\" in over");
    if (reader.has("rounds") && options.over.size() < 2)
        reader.error("rounds", "applies only with more than \"envelope\" in over");
    reader.finish();
    return options;
}

} // namespace shearwake::config
