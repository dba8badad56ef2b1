// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/make_engine.hpp"

#include "base/field.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/spectral/spectral_engine.hpp"

namespace shearwake::engines {

std::unique_ptr<Engine> make_engine(const SolverOptions& solver) {
    return std::visit(overloaded{
                          [](const LayeredOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<layered::LayeredEngine>();
                          },
                          [](const SpectralOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<spectral::SpectralEngine>();
                          },
                          [](const PstdOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<pstd::PstdEngine>();
                          },
                      },
                      solver);
}

Capabilities capabilities_of(const Case& c) {
    return make_engine(c.solver)->capabilities(c);
}

} // namespace shearwake::engines
