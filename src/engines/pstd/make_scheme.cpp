// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/make_scheme.hpp"

#include "base/error.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#ifdef SHEARWAKE_GPU
#include "engines/pstd/gpu/device_stepper.hpp"
#endif

namespace shearwake::pstd {

std::string device_error([[maybe_unused]] PstdDevice device) {
#ifndef SHEARWAKE_GPU
    if (device == PstdDevice::gpu)
        return "is \"gpu\", but this program was built without the headers of OpenCL";
#endif
    return "";
}

std::unique_ptr<Scheme> make_scheme(const Setup& setup, Precision precision,
                                    const DeviceChoice& choice, const Comm& team) {
    const bool is_single = precision == Precision::single_precision;
    if (const std::string error = device_error(choice.device); !error.empty())
        throw CaseFailure("the device " + error);
    if (choice.device == PstdDevice::gpu && team.size() > 1)
        throw CaseFailure(
            "a GPU computes a grid in one rank: start kwave without mpirun, or a sweep with "
            "--ranks-per-case 1");
#ifdef SHEARWAKE_GPU
    if (choice.device == PstdDevice::gpu)
        return std::make_unique<gpu::DeviceStepper>(setup, team, choice.number,
                                                    is_single ? sizeof(float) : sizeof(double));
#endif
    if (is_single) return std::make_unique<Stepper<float>>(setup, team);
    return std::make_unique<Stepper<double>>(setup, team);
}

} // namespace shearwake::pstd
