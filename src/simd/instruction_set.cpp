// SPDX-License-Identifier: BSD-3-Clause
#include "simd/instruction_set.hpp"

#include "base/error.hpp"

#include <array>
#include <cstdlib>
#include <fmt/format.h>

namespace shearwake::simd {
namespace {

constexpr std::array<std::string_view, 3> names = {"baseline", "avx2", "avx512"};

InstructionSet find_best() {
#ifdef SHEARWAKE_DISPATCH
    __builtin_cpu_init();
    const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                          __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool has_avx512 =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl");
    if (has_avx2 && has_avx512) return InstructionSet::avx512;
    if (has_avx2) return InstructionSet::avx2;
#endif
    return InstructionSet::baseline;
}

/// The only global state of the process. It is justified because the CPU is global, too.
InstructionSet& chosen_set() {
    static InstructionSet set = best_instruction_set();
    return set;
}

} // namespace

std::string_view name_of(InstructionSet set) {
    return names[static_cast<std::size_t>(set)];
}

std::optional<InstructionSet> instruction_set_named(std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return static_cast<InstructionSet>(i);
    return std::nullopt;
}

InstructionSet best_instruction_set() {
    static const InstructionSet best = find_best();
    return best;
}

InstructionSet instruction_set() {
    return chosen_set();
}

void use_instruction_set(InstructionSet set) {
    if (set > best_instruction_set())
        throw UsageError(fmt::format("SHEARWAKE_SIMD={}: this CPU and this build support "
                                     "{} at most",
                                     name_of(set), name_of(best_instruction_set())));
    chosen_set() = set;
}

std::optional<InstructionSet> requested_instruction_set() {
    const char* value = std::getenv("SHEARWAKE_SIMD");
    if (!value || !*value) return std::nullopt;
    const auto set = instruction_set_named(value);
    if (!set)
        throw UsageError(fmt::format("SHEARWAKE_SIMD={} is not an instruction set; allowed: "
                                     "baseline, avx2, avx512",
                                     value));
    return set;
}

} // namespace shearwake::simd
