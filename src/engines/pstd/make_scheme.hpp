// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/scheme.hpp"
#include "problem/case/case.hpp"

#include <memory>
#include <string>

namespace shearwake::pstd {

/// Where a scheme is computed.
struct DeviceChoice {
    PstdDevice device = PstdDevice::cpu;
    int number = -1; // of a GPU; -1: the teams on a machine use its devices in turn
};

/// Why the program offers no such device; empty if it does. Not collective.
std::string device_error(PstdDevice device);

/// The scheme of a setup. A GPU computes it for teams of one rank. Throws CaseFailure if there is
/// no such device, or if it lacks memory or double precision. Collective.
std::unique_ptr<Scheme> make_scheme(const Setup& setup, Precision precision,
                                    const DeviceChoice& choice, const Comm& team);

} // namespace shearwake::pstd
