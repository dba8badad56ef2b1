#include "engines/engine.hpp"
#include "engines/layered/layered_engine.hpp"

namespace shearwake {

std::unique_ptr<Engine> make_engine(const SolverOptions& solver) {
    return std::visit(
        [](const LayeredOptions&) -> std::unique_ptr<Engine> {
            return std::make_unique<LayeredEngine>();
        },
        solver);
}

} // namespace shearwake
