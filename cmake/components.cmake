# SPDX-License-Identifier: BSD-3-Clause
# Defines one component per folder of src: a static library whose CMakeLists.txt lists its sources and
# dependencies.
#
# shearwake_component([FEW_OPTIMISATIONS]
#     [UNITED name ...] ...    sources that are compiled as one file; names local to a file must differ
#     [ALONE name ...]         sources that are compiled separately
#     [FAST name ...]          sources that are compiled separately, with -O3 even with FEW_OPTIMISATIONS
#     [KERNELS name ...]       sources that are compiled once per instruction set
#     [PUBLIC dependency ...]  folders and libraries that the component's headers include
#     [PRIVATE dependency ...] folders and libraries that only its .cpp files include)
#
# Names have no extension. A dependency is the path of a folder relative to src, as in #include lines, or
# the target of a library. scripts/check_layers.py compares these lists with the #include lines.

# Sets `out` to the target of a dependency: shearwake_engines_pstd for the folder engines/pstd. Targets of
# libraries are passed on unchanged.
function(shearwake_target out dependency)
    if(IS_DIRECTORY ${CMAKE_SOURCE_DIR}/src/${dependency})
        string(REPLACE "/" "_" dependency shearwake_${dependency})
    endif()
    set(${out} ${dependency} PARENT_SCOPE)
endfunction()

# Compiles the kernels once per instruction set. All other files must be compiled for the baseline only
# (src/simd/kernels.hpp).
function(add_kernels target)
    foreach(instruction_set IN LISTS SHEARWAKE_INSTRUCTION_SETS)
        set(objects ${target}_${instruction_set})
        add_library(${objects} OBJECT ${ARGN})
        target_include_directories(${objects} PRIVATE ${CMAKE_SOURCE_DIR}/src)
        target_compile_definitions(${objects} PRIVATE SHEARWAKE_SIMD_SET=${instruction_set})
        target_link_libraries(${objects} PRIVATE shearwake_flags)
        target_compile_options(${objects} PRIVATE ${SHEARWAKE_FLAGS_${instruction_set}})
        target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
    endforeach()
endfunction()

# A component without sources.
function(add_header_component target)
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${CMAKE_SOURCE_DIR}/src)
    foreach(word IN LISTS ARGN)
        if(NOT word STREQUAL "PUBLIC")
            shearwake_target(dependency ${word})
            target_link_libraries(${target} INTERFACE ${dependency})
        endif()
    endforeach()
endfunction()

function(shearwake_component)
    file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
    shearwake_target(target ${folder})
    if(NOT "${ARGN}" MATCHES "UNITED|ALONE|FAST|KERNELS")
        add_header_component(${target} ${ARGN})
        return()
    endif()
    add_library(${target} STATIC)
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX UNITY_BUILD ${SHEARWAKE_UNITY}
        UNITY_BUILD_MODE GROUP)
    target_include_directories(${target} PUBLIC ${CMAKE_SOURCE_DIR}/src)
    target_compile_options(${target} PRIVATE ${SHEARWAKE_FLAGS_baseline})
    target_link_libraries(${target} PUBLIC shearwake_flags)
    set(mode "")
    set(optimisations full)
    set(group 0)
    set(kernels "")
    foreach(word IN LISTS ARGN)
        if(word STREQUAL "FEW_OPTIMISATIONS")
            set(optimisations few)
        elseif(word MATCHES "^(UNITED|ALONE|FAST|KERNELS|PUBLIC|PRIVATE)$")
            set(mode ${word})
            math(EXPR group "${group} + 1")
        elseif(mode MATCHES "^(PUBLIC|PRIVATE)$")
            shearwake_target(dependency ${word})
            target_link_libraries(${target} ${mode} ${dependency})
        elseif(mode STREQUAL "KERNELS")
            list(APPEND kernels ${word}.cpp)
        else()
            target_sources(${target} PRIVATE ${word}.cpp)
            if(mode STREQUAL "UNITED")
                set_source_files_properties(${word}.cpp PROPERTIES UNITY_GROUP ${group})
            elseif(mode STREQUAL "FAST")
                set_source_files_properties(${word}.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                    COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>")
            endif()
        endif()
    endforeach()
    if(kernels)
        add_kernels(${target} ${kernels})
    endif()
    shorten_component(${target} ${optimisations})
    set_property(GLOBAL APPEND PROPERTY SHEARWAKE_COMPONENTS ${target})
endfunction()
