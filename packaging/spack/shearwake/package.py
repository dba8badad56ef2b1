# SPDX-License-Identifier: BSD-3-Clause
"""Recipe of Spack: add this folder's parent to a repository of packages, then `spack dev-build shearwake@main` in a clone."""
from spack.package import CMakePackage, depends_on, generator, license, version


class Shearwake(CMakePackage):
    """Sweeps of mid-air ultrasound haptics over viscoelastic skin."""

    license("BSD-3-Clause")
    version("main")

    depends_on("cxx", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("ninja", type="build")
    depends_on("mpi")
    depends_on("fftw+mpi precision=double,float")
    depends_on("hdf5@1.10:+mpi")
    depends_on("tomlplusplus@3.3:")
    depends_on("cli11@2.1:")
    depends_on("fmt@9:")
    depends_on("eigen@3.4:")
    depends_on("libpng")
    depends_on("boost@1.74:")
    depends_on("random123")
    depends_on("nlohmann-json@3.11:")
    depends_on("xxhash@0.8:")
    depends_on("python@3.11:", type="run")
    for module in ("numpy", "h5py", "matplotlib", "xxhash", "scipy", "xarray", "netcdf4", "pandas", "tomli-w"):
        depends_on(f"py-{module}", type="run")

    generator("ninja")

    def cmake_args(self):
        return [self.define("SHEARWAKE_TESTS", False)]
