# SPDX-License-Identifier: BSD-3-Clause
# Shortens clean builds by precompiled headers, groups of small files, and fewer optimisations of components that
# compute little.
#
# If a single file is edited repeatedly, -DSHEARWAKE_UNITY=OFF may be faster.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON checks whether each file includes what it uses.
option(SHEARWAKE_UNITY "Compile small files in groups" ON)

# Headers of the standard library and of fmt, which nearly every file includes.
set(SHEARWAKE_PRECOMPILED <algorithm> <array> <charconv> <chrono> <cmath> <complex> <cstddef> <cstdint>
    <filesystem> <fmt/format.h> <fstream> <functional> <limits> <map> <memory> <numbers> <numeric>
    <optional> <span> <sstream> <string> <string_view> <utility> <variant> <vector>)
target_compile_options(shearwake_flags INTERFACE
    $<$<AND:$<BOOL:${CCACHE}>,$<CXX_COMPILER_ID:GNU>>:-fpch-preprocess>) # for ccache

# Components that read, write and schedule compute little. The compilation of the five largest took 68 s with -O1 and
# 54 s with -Og. The exceptions (FAST) process every sample. Eigen requires the inlining of -O1.
set(SHEARWAKE_FEW_OPTIMISATIONS $<$<CONFIG:Release>:-Og>)
set(SHEARWAKE_FEW_OPTIMISATIONS_WITH_EIGEN $<$<CONFIG:Release>:-O1>)

# g++ spends an eighth of its time on garbage collection unless it may keep 800 MB: the five slowest files took 34.9 s
# instead of 39.7 s.
target_compile_options(shearwake_flags INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=800000 --param=ggc-min-expand=100>)

# All components that are compiled with the same options share a precompiled header.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "// Compiled with the components' headers.\n")
foreach(optimisations full few)
    set(target shearwake_precompiled_${optimisations})
    add_library(${target} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
    target_link_libraries(${target} PRIVATE shearwake_flags fmt::fmt)
    target_compile_options(${target} PRIVATE ${SHEARWAKE_FLAGS_baseline})
    target_precompile_headers(${target} PRIVATE ${SHEARWAKE_PRECOMPILED})
endforeach()
target_compile_options(shearwake_precompiled_few PRIVATE ${SHEARWAKE_FEW_OPTIMISATIONS})

function(shorten_component target optimisations)
    if(optimisations STREQUAL "few")
        get_target_property(libraries ${target} LINK_LIBRARIES)
        if("Eigen3::Eigen" IN_LIST libraries)
            target_compile_options(${target} PRIVATE ${SHEARWAKE_FEW_OPTIMISATIONS_WITH_EIGEN})
        else()
            target_compile_options(${target} PRIVATE ${SHEARWAKE_FEW_OPTIMISATIONS})
        endif()
    endif()
    target_precompile_headers(${target} REUSE_FROM shearwake_precompiled_${optimisations})
endfunction()
