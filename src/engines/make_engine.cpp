#include "engines/engine.hpp"
#include "base/overloaded.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/spectral/spectral_engine.hpp"

namespace shearwake {

std::unique_ptr<Engine> make_engine(const SolverOptions& solver) {
    return std::visit(overloaded{
                          [](const LayeredOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<LayeredEngine>();
                          },
                          [](const SpectralOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<SpectralEngine>();
                          },
                          [](const PstdOptions&) -> std::unique_ptr<Engine> {
                              return std::make_unique<PstdEngine>();
                          },
                      },
                      solver);
}

} // namespace shearwake
