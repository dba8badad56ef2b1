// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/make_scheme.hpp"

#include "base/error.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#ifdef SHEARWAKE_GPU
#include "engines/pstd/gpu/device_stepper.hpp"
#endif

namespace shearwake::pstd {
namespace {

template <class Real>
std::unique_ptr<Scheme> scheme_of(const Setup& setup, const DeviceChoice& choice,
                                  const Comm& team) {
    if (choice.device == PstdDevice::cpu) return std::make_unique<Stepper<Real>>(setup, team);
    if (const std::string error = device_error(choice.device); !error.empty())
        throw CaseFailure("the device " + error);
    if (team.size() > 1)
        throw CaseFailure(
            "a GPU computes a grid in one rank: start kwave without mpirun, or a sweep with "
            "--ranks-per-case 1");
#ifdef SHEARWAKE_GPU
    return std::make_unique<gpu::DeviceStepper<Real>>(setup, team, choice.number);
#else
    return nullptr;
#endif
}

} // namespace

std::string device_error([[maybe_unused]] PstdDevice device) {
#ifndef SHEARWAKE_GPU
    if (device == PstdDevice::gpu)
        return "is \"gpu\", but this program was built without the headers of OpenCL";
#endif
    return "";
}

std::unique_ptr<Scheme> make_scheme(const Setup& setup, Precision precision,
                                    const DeviceChoice& choice, const Comm& team) {
    return precision == Precision::single_precision ? scheme_of<float>(setup, choice, team)
                                                    : scheme_of<double>(setup, choice, team);
}

} // namespace shearwake::pstd
