// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace shearwake::simd {

/// Instruction sets for which the kernels are compiled. Each one is a superset of the previous one.
///     baseline  required by the whole program: x86-64-v2 (SSE4.2), two doubles per instruction;
///               on other architectures, or with SHEARWAKE_NATIVE, the target of the compiler
///     avx2      x86-64-v3: AVX2 and fused multiply-add, four doubles
///     avx512    x86-64-v4: AVX-512 F, BW, CD, DQ, VL, eight doubles
enum class InstructionSet { baseline, avx2, avx512 };

/// "baseline", "avx2" or "avx512".
std::string_view name_of(InstructionSet set);
/// The inverse of name_of(); empty for an unknown name.
std::optional<InstructionSet> instruction_set_named(std::string_view name);

/// The best instruction set that both this build and this CPU support. Not collective.
InstructionSet best_instruction_set();

/// The instruction set that the kernels of this process use: best_instruction_set() unless
/// use_instruction_set() was called. Not collective.
InstructionSet instruction_set();

/// Selects an instruction set; to be called once at the start of the program. Throws UsageError if
/// this CPU or this build does not support it. Not collective: ranks that work together must select
/// the same set (parallel/session).
void use_instruction_set(InstructionSet set);

/// Value of the environment variable SHEARWAKE_SIMD if it is set and not empty. Throws UsageError
/// if the value is not the name of an instruction set. Not collective.
std::optional<InstructionSet> requested_instruction_set();

} // namespace shearwake::simd
