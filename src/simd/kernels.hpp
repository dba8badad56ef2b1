// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/instruction_set.hpp"

namespace shearwake::simd {

// Kernels are free functions defined by the files of a folder named `kernels`. The build compiles
// each of these files once per instruction set, with SHEARWAKE_SIMD_SET set to the name of the set.
// Each file exports one table of function pointers,
//
//     template <>
//     const SkylineKernels& compiled<SkylineKernels, this_set>() { ... }
//
// and the rest of the program calls kernels<SkylineKernels>().solve(...). All other functions in
// such a file must be local to it (in an unnamed namespace, as in simd/vector.hpp). The linker
// would keep only one copy of a function that two object files share, possibly with instructions
// that the CPU does not support. A test rejects such functions.

#ifdef SHEARWAKE_SIMD_SET
inline constexpr InstructionSet this_set = InstructionSet::SHEARWAKE_SIMD_SET;
#endif

/// The table of kernels compiled for `set`.
template <class Kernels, InstructionSet set>
const Kernels& compiled();

/// The table of kernels for `set`, which this build and this CPU must support.
template <class Kernels>
const Kernels& kernels(InstructionSet set) {
#ifdef SHEARWAKE_DISPATCH
    if (set == InstructionSet::avx512) return compiled<Kernels, InstructionSet::avx512>();
    if (set == InstructionSet::avx2) return compiled<Kernels, InstructionSet::avx2>();
#endif
    (void)set;
    return compiled<Kernels, InstructionSet::baseline>();
}

/// The table of kernels for the instruction set in use.
template <class Kernels>
const Kernels& kernels() {
    return kernels<Kernels>(instruction_set());
}

} // namespace shearwake::simd
