# SPDX-License-Identifier: BSD-3-Clause
"""Rejects media and time steps for which the simulation would be unstable or without meaning."""
import numpy as np

from structures import BadInput


def first_node(bad, study):
    """The first node where `bad` is true, counted from 1 in the grid of kgrid; empty for uniform values."""
    if not np.ndim(bad):
        return ""
    node = np.argwhere(bad)[0] - study.first + 1
    return f" at node ({', '.join(str(int(n)) for n in node)})"


def check_range(values, field, study, positive=False):
    """All values must be 0 or more, or positive."""
    bad = values <= 0.0 if positive else values < 0.0
    if np.any(bad):
        found = float(values[bad].flat[0] if np.ndim(values) else values)
        raise BadInput(f"{field} is {found:g}{first_node(bad, study)}; it must be "
                       f"{'greater than 0' if positive else '0 or more'}")


def check_medium(study):
    c_p, c_s = study.medium["c_p_m_s"], study.medium["c_s_m_s"]
    bad = np.asarray(c_s > c_p)
    if np.any(bad):
        raise BadInput(f"medium.sound_speed_shear exceeds medium.sound_speed_compression{first_node(bad, study)}: "
                       "shear waves must be slower than compressional waves")
    if np.any(4.0 * c_s ** 2 > 3.0 * c_p ** 2):
        study.notes.append("medium: sound_speed_compression is below 1.1547 times sound_speed_shear, so the bulk "
                           "modulus is negative, which no material has")


def positive_root(a, b):
    """The positive root dt of a dt^2 + b dt = 4; infinite without waves."""
    with np.errstate(divide="ignore"):
        return 8.0 / (b + np.sqrt(b * b + 16.0 * a))


def step_limits(study):
    """(dt of the stiffest material alone, dt that is stable for any arrangement of these materials) in s. With the
    largest wave number K of the grid (an odd number of points has no wave of two points), dt^2 c^2 K^2 + 2 dt K^2 E/rho <= 4 for compressional waves (c_p,
    E = chi + 2 eta) and shear waves (c_s, E = eta); the C++ counterpart is engines/pstd/scene/case_step.hpp."""
    medium = study.medium
    largest = np.pi / study.spacing_m * (1.0 - (study.points % 2) / study.points)
    k2 = np.sum(largest ** 2)
    rho, eta, chi = medium["density_kg_m3"], medium.get("eta_Pa_s", 0.0), medium.get("chi_Pa_s", 0.0)
    alone = min(np.min(positive_root(c ** 2 * k2, 2.0 * k2 * loss / rho))
                for c, loss in ((medium["c_p_m_s"], chi + 2.0 * eta), (medium["c_s_m_s"], eta)))
    safe = positive_root(np.max(rho * medium["c_p_m_s"] ** 2) / np.min(rho) * k2,
                         2.0 * k2 * np.max(chi + 2.0 * eta) / np.min(rho))
    return float(alone), float(safe)


def check_time_step(study):
    alone_s, safe_s = step_limits(study)
    step_s = study.time_step_s
    if step_s > alone_s:
        raise BadInput(f"kgrid.dt = {1e6 * step_s:.6g} us is unstable: at this spacing and in this medium, steps up to "
                       f"{1e6 * safe_s:.6g} us are stable and steps above {1e6 * alone_s:.6g} us are unstable; reduce "
                       "kgrid.dt")
    if step_s > safe_s:
        study.notes.append(f"kgrid.dt = {1e6 * step_s:.6g} us may be unstable: steps up to {1e6 * safe_s:.6g} us are "
                           "stable")
