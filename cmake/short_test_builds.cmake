# SPDX-License-Identifier: BSD-3-Clause
# Shortens builds of the tests, as short_builds.cmake does for the program. All runners share a precompiled
# Catch2. The tests compute little themselves and are not optimised; the engines under test keep their
# options.
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp CONTENT "// The tests' headers.\n")
add_library(precompiled_catch OBJECT ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp)
target_link_libraries(precompiled_catch PRIVATE Catch2::Catch2 shearwake_tested)
target_compile_options(precompiled_catch PRIVATE $<$<CONFIG:Release>:-O0>)
target_precompile_headers(precompiled_catch PRIVATE <catch2/catch.hpp> ${SHEARWAKE_PRECOMPILED})
# On a busy machine, compiling Catch2 took 15.5 s with -O0, and 16.1 and 20.3 s with -O1.
target_compile_options(catch_main PRIVATE $<$<CONFIG:Release>:-O0>)

function(shorten_build runner)
    target_compile_options(${runner} PRIVATE $<$<CONFIG:Release>:-O0>)
    target_precompile_headers(${runner} REUSE_FROM precompiled_catch)
    set_target_properties(${runner} PROPERTIES UNITY_BUILD ${SHEARWAKE_UNITY} UNITY_BUILD_MODE GROUP)
endfunction()

# A file whose templates the engines share. The precompiled header is not optimised and cannot be used.
function(optimise_test file)
    set_source_files_properties(${file} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON
        COMPILE_OPTIONS $<$<CONFIG:Release>:-O2>)
endfunction()
