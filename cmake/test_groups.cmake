# SPDX-License-Identifier: BSD-3-Clause
# Registers the tests with CTest. Each CTest test is a group of test cases that scripts/run_group.py runs,
# counts, and ends if it hangs. Labels: unit, mpi, verify, end_to_end, faults, integrity, docs, slurm, report,
# scripts.

# The first Python that has numpy and h5py, searched as in scripts/common.sh.
foreach(candidate IN ITEMS "$ENV{SHEARWAKE_PYTHON}" python3 /usr/bin/python3)
    if(candidate AND NOT SHEARWAKE_TEST_PYTHON)
        execute_process(COMMAND ${candidate} -c "import numpy, h5py, sys; print(sys.executable)"
            OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
        if(NOT failed)
            set(SHEARWAKE_TEST_PYTHON ${found} CACHE FILEPATH "Python that runs the tests")
        endif()
    endif()
endforeach()
if(NOT SHEARWAKE_TEST_PYTHON)
    message(WARNING "No Python with numpy and h5py found: no tests are registered; set SHEARWAKE_PYTHON to choose "
        "one")
endif()

# Groups that take minutes start first, so that they do not run last and on their own.
set(long_groups "mpi_tests on 5 ranks" "mpi_tests on 3 ranks" "mpi_tests on 8 ranks" "mpi_tests on 2 ranks"
    tests/docs/test_blocks.py tests/faults/test_faults.py tests/slurm/test_slurm.py "verify_tests test_known_indices"
    tests/end_to_end/test_optimise.py tests/end_to_end/test_adaptive.py tests/python/test_explore_page.py)

# add_group(NAME LABEL VERDICTS COMMAND...): a group that uses about one core on average and may run concurrently
# with any other group. There is no time limit: run_group.py ends groups that make no progress.
function(add_group name label verdicts)
    if(NOT SHEARWAKE_TEST_PYTHON)
        return()
    endif()
    add_test(NAME ${name} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
        COMMAND ${SHEARWAKE_TEST_PYTHON} ${CMAKE_SOURCE_DIR}/scripts/run_group.py ${CMAKE_BINARY_DIR}
            ${verdicts} ${name} ${ARGN})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 1000000)
    if(name IN_LIST long_groups)
        set_tests_properties(${name} PROPERTIES COST 100)
    endif()
endfunction()

# Adds the test cases of a Catch2 runner that ARGN selects, on one rank. -# tags them with their file.
function(add_catch_group name label runner)
    add_group(${name} ${label} catch $<TARGET_FILE:${runner}> -\# -r xml -o REPORT ${ARGN})
endfunction()

# Adds the test cases of a Catch2 runner on several ranks. The ranks are not bound and yield when idle
# (analysis/nightly/ranks.py), since other processes may use the cores: next to another program, two ranks took six
# times as long as one. For the same reason no other group runs beside them: next to two groups, three ranks took ten
# times as long as alone.
function(add_mpi_group name label runner ranks)
    set(launch "")
    if(ranks GREATER 1)
        set(launch ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks})
    endif()
    add_group(${name} ${label} catch ${launch} $<TARGET_FILE:${runner}> -\# -r xml -o REPORT ${ARGN})
    if(ranks GREATER 1 AND TEST ${name}) # more than there are: nothing runs beside it
        set_tests_properties(${name} PROPERTIES PROCESSORS 1000)
    endif()
endfunction()

# Adds each tests/FOLDER/test_*.py as a group, with the folder as label.
function(add_python_groups folder)
    file(GLOB files CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/tests/${folder}/test_*.py)
    foreach(file IN LISTS files)
        add_group(${file} ${folder} unittest ${SHEARWAKE_TEST_PYTHON}
            ${CMAKE_SOURCE_DIR}/scripts/test_runner/unittest_main.py ${CMAKE_SOURCE_DIR}/${file} REPORT)
    endforeach()
endfunction()
