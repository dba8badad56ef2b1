# SPDX-License-Identifier: BSD-3-Clause
# Defines one target per library that the program uses. Debian has no CMake packages for FFTW and for HDF5
# with MPI.
find_package(PkgConfig REQUIRED)
find_package(MPI REQUIRED COMPONENTS C)
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(Ceres REQUIRED)
find_package(Boost 1.74 REQUIRED) # headers only: Boost.Math and Boost.Random
pkg_check_modules(FFTW_DOUBLE REQUIRED IMPORTED_TARGET fftw3)
pkg_check_modules(FFTW_SINGLE REQUIRED IMPORTED_TARGET fftw3f)
pkg_check_modules(HDF5_OPENMPI REQUIRED IMPORTED_TARGET hdf5-openmpi)
find_library(HDF5_HL hdf5_hl HINTS ${HDF5_OPENMPI_LIBRARY_DIRS} REQUIRED)
find_library(FFTW_MPI fftw3_mpi REQUIRED)
find_path(TOMLPP_INCLUDE toml++/toml.h REQUIRED)
find_path(RANDOM123_INCLUDE Random123/philox.h REQUIRED)
find_path(XXHASH_INCLUDE xxhash.h REQUIRED)

function(add_library_target name)
    add_library(${name} INTERFACE IMPORTED)
    target_link_libraries(${name} INTERFACE ${ARGN})
endfunction()

add_library_target(FFTW::FFTW ${FFTW_MPI} PkgConfig::FFTW_DOUBLE PkgConfig::FFTW_SINGLE MPI::MPI_C)
add_library_target(HDF5::HDF5 ${HDF5_HL} PkgConfig::HDF5_OPENMPI MPI::MPI_C)
add_library_target(tomlplusplus::tomlplusplus)
target_include_directories(tomlplusplus::tomlplusplus INTERFACE ${TOMLPP_INCLUDE})
add_library_target(Random123::Random123)
target_include_directories(Random123::Random123 INTERFACE ${RANDOM123_INCLUDE})
add_library_target(xxhash::xxhash)
target_include_directories(xxhash::xxhash INTERFACE ${XXHASH_INCLUDE})
