# SPDX-License-Identifier: BSD-3-Clause
# Defines one component per folder of src: a static library of all its .cpp files, whose CMakeLists.txt lists its
# dependencies.
#
# shearwake_component(
#     [KERNELS name ...]       sources, without extension, that are compiled once per instruction set
#     [PUBLIC dependency ...]  folders and libraries that the component's headers include
#     [PRIVATE dependency ...] folders and libraries that only its .cpp files include)
#
# A dependency is the path of a folder relative to src, as in #include lines, or the target of a library.
# scripts/check_layers.py compares these lists with the #include lines.

# Sets `out` to the target of a dependency: shearwake_engines_pstd for the folder engines/pstd. Targets of
# libraries are passed on unchanged.
function(shearwake_target out dependency)
    if(IS_DIRECTORY ${CMAKE_SOURCE_DIR}/src/${dependency})
        string(REPLACE "/" "_" dependency shearwake_${dependency})
    endif()
    set(${out} ${dependency} PARENT_SCOPE)
endfunction()

# Precompiled: headers of the standard library and of fmt, which nearly every file includes.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON checks whether each file includes what it uses, -DCMAKE_UNITY_BUILD=OFF may be
# faster if a single file is edited repeatedly.
set(SHEARWAKE_PRECOMPILED <algorithm> <array> <charconv> <chrono> <cmath> <complex> <cstddef> <cstdint>
    <filesystem> <fmt/format.h> <fstream> <functional> <limits> <map> <memory> <numbers> <numeric>
    <optional> <span> <sstream> <string> <string_view> <utility> <variant> <vector>)
target_compile_options(shearwake_flags INTERFACE
    $<$<AND:$<BOOL:${CCACHE}>,$<CXX_COMPILER_ID:GNU>>:-fpch-preprocess>) # for ccache
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "// Compiled with the components' headers.\n")
foreach(optimisation -O2 -Og)
    set(target shearwake_precompiled${optimisation})
    add_library(${target} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
    target_link_libraries(${target} PRIVATE shearwake_flags)
    target_compile_options(${target} PRIVATE ${SHEARWAKE_FLAGS_baseline} $<$<CONFIG:Release>:${optimisation}>)
    target_precompile_headers(${target} PRIVATE ${SHEARWAKE_PRECOMPILED})
endforeach()

# Compiles the kernels once per instruction set. All other files must be compiled for the baseline only
# (src/simd/kernels.hpp).
function(add_kernels target)
    foreach(instruction_set IN LISTS SHEARWAKE_INSTRUCTION_SETS)
        set(objects ${target}_${instruction_set})
        add_library(${objects} OBJECT ${ARGN})
        set_target_properties(${objects} PROPERTIES UNITY_BUILD OFF)
        target_include_directories(${objects} PRIVATE ${CMAKE_SOURCE_DIR}/src)
        target_compile_definitions(${objects} PRIVATE SHEARWAKE_SIMD_SET=${instruction_set})
        target_link_libraries(${objects} PRIVATE shearwake_flags)
        target_compile_options(${objects} PRIVATE ${SHEARWAKE_FLAGS_${instruction_set}})
        target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
    endforeach()
endfunction()

function(shearwake_component)
    cmake_parse_arguments(arg "" "" "KERNELS;PUBLIC;PRIVATE" ${ARGN})
    file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
    shearwake_target(target ${folder})
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
    list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp)
    list(TRANSFORM arg_KERNELS REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/\\1.cpp")
    if(NOT sources)
        set(kind INTERFACE)
    else()
        set(kind PUBLIC)
    endif()
    list(REMOVE_ITEM sources ${arg_KERNELS})
    if(kind STREQUAL "INTERFACE")
        add_library(${target} INTERFACE)
    else()
        add_library(${target} STATIC ${sources})
        set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
        target_compile_options(${target} PRIVATE ${SHEARWAKE_FLAGS_baseline}
            $<$<CONFIG:Release>:${SHEARWAKE_OPTIMISATION}>) # -O2 or -Og, see src/CMakeLists.txt
        target_link_libraries(${target} PUBLIC shearwake_flags)
        target_precompile_headers(${target} REUSE_FROM shearwake_precompiled${SHEARWAKE_OPTIMISATION})
        if(arg_KERNELS)
            add_kernels(${target} ${arg_KERNELS})
        endif()
        set_property(GLOBAL APPEND PROPERTY SHEARWAKE_COMPONENTS ${target})
    endif()
    target_include_directories(${target} ${kind} ${CMAKE_SOURCE_DIR}/src)
    foreach(visibility IN ITEMS PUBLIC PRIVATE)
        foreach(word IN LISTS arg_${visibility})
            shearwake_target(dependency ${word})
            if(kind STREQUAL "INTERFACE")
                target_link_libraries(${target} INTERFACE ${dependency})
            else()
                target_link_libraries(${target} ${visibility} ${dependency})
            endif()
        endforeach()
    endforeach()
endfunction()
