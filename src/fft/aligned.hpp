#pragma once

#include <cstddef>
#include <fftw3.h>
#include <new>
#include <vector>

namespace shearwake {

/// Gives vectors the alignment that FFTW's vector instructions want.
template <class T>
struct FftwAllocator {
    using value_type = T;
    FftwAllocator() = default;
    template <class U>
    FftwAllocator(const FftwAllocator<U>&) {} // NOLINT: allocators convert
    T* allocate(std::size_t n) {
        if (void* memory = fftw_malloc(n * sizeof(T))) return static_cast<T*>(memory);
        throw std::bad_alloc();
    }
    void deallocate(T* memory, std::size_t) { fftw_free(memory); }
    bool operator==(const FftwAllocator&) const { return true; }
};

template <class T>
using AlignedVector = std::vector<T, FftwAllocator<T>>;

} // namespace shearwake
