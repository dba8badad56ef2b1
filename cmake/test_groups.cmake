# SPDX-License-Identifier: BSD-3-Clause
# Registers the tests with CTest. Each CTest test is a group of test cases: the Python tests of a folder or of every third
# file of it, a file of the verification, or a runner on a number of ranks. Each writes a JUnit report to
# BUILD/test-results, from which scripts/count_tests.py counts. Labels: unit, mpi, verify, the folders of Python tests, and
# small, extended and long for what does not run in all sizes of scripts/test.

# The first Python that has numpy and h5py, searched as in scripts/common.sh.
foreach(candidate IN ITEMS "$ENV{SHEARWAKE_PYTHON}" python3 /usr/bin/python3)
    if(candidate AND NOT SHEARWAKE_TEST_PYTHON)
        execute_process(COMMAND ${candidate} -c "import numpy, h5py, pytest, sys; print(sys.executable)"
            OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
        if(NOT failed)
            set(SHEARWAKE_TEST_PYTHON ${found} CACHE FILEPATH "Python that runs the tests")
        endif()
    endif()
endforeach()
if(NOT SHEARWAKE_TEST_PYTHON)
    message(WARNING "No Python with numpy, h5py and pytest found: only C++ tests are registered; set SHEARWAKE_PYTHON to "
        "choose one")
endif()

# The program under test, and MPI next to other programs: more ranks than cores, which Open MPI 4 (OMPI) and 5 (PRTE)
# refuse otherwise, not bound to cores, and yielding when idle. Without a search for networks ranks start in half the
# time. MPICH ignores all this.
set(test_environment "SHEARWAKE=${CMAKE_BINARY_DIR}/shearwake" "SHEARWAKE_PYTHON=${SHEARWAKE_TEST_PYTHON}"
    SHEARWAKE_NAME_TESTS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_pml=ob1
    OMPI_MCA_btl=self,vader OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
    OMPI_MCA_mpi_yield_when_idle=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
    PRTE_MCA_hwloc_default_binding_policy=none)

file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/test-results)

# add_group(NAME LABEL COMMAND...): REPORT in COMMAND stands for the path of the report. The time limit ends a group that
# hangs; it does not express an expectation of speed.
function(add_group name label)
    string(MAKE_C_IDENTIFIER ${name} stem)
    list(TRANSFORM ARGN REPLACE REPORT ${CMAKE_BINARY_DIR}/test-results/${stem}.xml)
    add_test(NAME ${name} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR} COMMAND ${ARGN})
    set_tests_properties(${name} PROPERTIES LABELS "${label}" TIMEOUT 14400 ENVIRONMENT "${test_environment}")
endfunction()

# -# tags tests with their file. A group without tests is a failure, with Catch2 2 by an option.
set(catch_options -\# -r junit -o REPORT)
if(Catch2_VERSION VERSION_LESS 3)
    list(APPEND catch_options -w NoTests)
endif()

# Adds the test cases of a Catch2 runner that match all patterns of ARGN, on one rank.
function(add_catch_group name label runner)
    add_group(${name} "${label}" $<TARGET_FILE:${runner}> ${catch_options} ${ARGN})
endfunction()

# Adds the test cases of a Catch2 runner on several ranks. Next to two other groups, three ranks took ten times as long as
# alone: on a machine of two cores nothing runs beside them.
function(add_mpi_group name label runner ranks)
    set(launch "")
    if(ranks GREATER 1)
        set(launch ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks})
    endif()
    add_group(${name} "${label}" ${launch} $<TARGET_FILE:${runner}> ${catch_options} ${ARGN})
    math(EXPR processors "${ranks} + 2")
    set_tests_properties(${name} PROPERTIES PROCESSORS ${processors} COST 1000) # start first
endfunction()

# Adds all tests/FOLDER/test_*.py, with the folder as label, in this number of processes, which import the libraries once.
function(add_python_groups folder processes)
    if(SHEARWAKE_TEST_PYTHON)
        file(GLOB files CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/tests/${folder}/test_*.py)
        foreach(process RANGE 1 ${processes})
            set(files_${process} "")
        endforeach()
        set(process 1)
        foreach(file IN LISTS files)
            list(APPEND files_${process} ${file})
            math(EXPR process "${process} % ${processes} + 1")
        endforeach()
        foreach(process RANGE 1 ${processes})
            set(name ${folder})
            if(processes GREATER 1)
                set(name "${folder} ${process} of ${processes}")
            endif()
            add_group(${name} ${folder} ${SHEARWAKE_TEST_PYTHON} -m pytest -v --junitxml REPORT ${files_${process}})
            set_tests_properties(${name} PROPERTIES COST 500)
        endforeach()
    endif()
endfunction()
