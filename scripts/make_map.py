# SPDX-License-Identifier: BSD-3-Clause
"""Writes a map of material properties for medium.map.

For maps of your own, pass arrays of shape (x, y, z) to write_map():

    from make_map import write_map
    write_map("mine.h5", x_m, y_m, z_m, c_s_m_s=..., density_kg_m3=...)

scripts/make-map runs this file to write soft tissue with a stiff inclusion of Gaussian shape.
"""
import argparse
import sys

import h5py
import numpy as np

UNITS = {"c_s_m_s": "m/s", "c_p_m_s": "m/s", "density_kg_m3": "kg/m3", "viscosity_Pa_s": "Pa s"}


def write_map(path, x_m, y_m, z_m, **properties):
    """Writes a map. The coordinates in m must be uniformly spaced and ascending; z is the depth. With a
    single coordinate along an axis, the properties are constant along it. The properties, named by the keys
    of UNITS, have the shape (x, y, z); those that are not specified are taken from the layers. An existing
    file is replaced."""
    coordinates = {"x_m": x_m, "y_m": y_m, "z_m": z_m}
    shape = tuple(len(values) for values in coordinates.values())
    unknown = sorted(set(properties) - set(UNITS))
    if unknown or not properties:
        raise ValueError(f"{'unknown property ' + ', '.join(unknown) if unknown else 'no property is specified'}; "
                         f"the properties are {', '.join(UNITS)}")
    for name, values in properties.items():
        if np.shape(values) != shape:
            raise ValueError(f"{name} has the shape {np.shape(values)}; the coordinates require {shape}")
    with h5py.File(path, "w", locking=False) as file:
        for name, values in coordinates.items():
            file[name] = np.asarray(values, dtype=float)
            file[name].attrs["units"] = "m"
            file[name].make_scale(name)
        for name, values in properties.items():
            file[name] = np.asarray(values, dtype=float)
            file[name].attrs["units"] = UNITS[name]
            for number, axis in enumerate(coordinates):
                file[name].dims[number].attach_scale(file[axis])


def gaussian(x_m, y_m, z_m, center_m, fwhm_m):
    """A Gaussian of shape (x, y, z) with the value 1 at the centre and the given widths along x, y and z."""
    def along(at_m, number):
        return np.exp(-4.0 * np.log(2.0) * ((np.asarray(at_m) - center_m[number]) / fwhm_m[number]) ** 2)

    return (along(x_m, 0)[:, None, None] * along(y_m, 1)[None, :, None] * along(z_m, 2)[None, None, :])


def inclusion_c_s_m_s(share, around_m_s, inside_m_s):
    """c_s for a constant density if `share` interpolates the stiffness rho c_s^2 between the surroundings (0)
    and the inclusion (1)."""
    return np.sqrt(around_m_s ** 2 + share * (inside_m_s ** 2 - around_m_s ** 2))


def options():
    parser = argparse.ArgumentParser(
        prog="make-map", formatter_class=argparse.ArgumentDefaultsHelpFormatter,
        description="Writes a map for medium.map: soft tissue with a stiff inclusion of Gaussian shape. The map "
                    "contains only c_s; all other properties are those of the layers.")
    add = parser.add_argument
    add("file", help="HDF5 file to write; an existing file is replaced")
    add("--extent_mm", type=float, nargs=2, default=[96.0, 64.0], metavar=("X", "Y"),
        help="extents of the map, centred at the origin: those of the domain")
    add("--depth_mm", type=float, default=20.0, help="depth of the map: that of the layers")
    add("--spacing_mm", type=float, default=0.75, help="largest distance between points of the map")
    add("--center_mm", type=float, nargs=3, default=[0.0, 0.0, 6.0], metavar=("X", "Y", "Z"),
        help="centre of the inclusion")
    add("--fwhm_mm", type=float, nargs=3, default=[8.0, 8.0, 6.0], metavar=("X", "Y", "Z"),
        help="full width at half maximum of the stiffness")
    add("--c_s_m_s", type=float, default=5.0, help="shear wave speed of the surroundings")
    add("--inside_m_s", type=float, default=15.0, help="shear wave speed at the centre of the inclusion")
    chosen = parser.parse_args()
    lengths = [*chosen.extent_mm, chosen.depth_mm, chosen.spacing_mm, *chosen.fwhm_mm,
               chosen.c_s_m_s, chosen.inside_m_s]
    if not all(np.isfinite(length) and length > 0.0 for length in lengths):
        parser.error("extents, depth, spacing, widths and speeds must be greater than 0")
    return chosen


def main():
    chosen = options()

    def between(low_mm, high_mm):
        points = max(2, 1 + int(np.ceil((high_mm - low_mm) / chosen.spacing_mm - 1e-9)))
        return 1e-3 * np.linspace(low_mm, high_mm, points)

    x_m, y_m = (between(-0.5 * width, 0.5 * width) for width in chosen.extent_mm)
    z_m = between(0.0, chosen.depth_mm)
    share = gaussian(x_m, y_m, z_m, 1e-3 * np.array(chosen.center_mm), 1e-3 * np.array(chosen.fwhm_mm))
    c_s_m_s = inclusion_c_s_m_s(share, chosen.c_s_m_s, chosen.inside_m_s)
    try:
        write_map(chosen.file, x_m, y_m, z_m, c_s_m_s=c_s_m_s)
    except OSError as problem:
        sys.exit(f"make-map: {chosen.file}: {problem}")
    print(f"{chosen.file}: {' x '.join(map(str, c_s_m_s.shape))} points, c_s from {c_s_m_s.min():.4g} "
          f"to {c_s_m_s.max():.4g} m/s")


if __name__ == "__main__":
    main()
