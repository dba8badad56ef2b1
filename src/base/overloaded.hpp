#pragma once

namespace shearwake {

/// One lambda per member of a variant: std::visit(overloaded{...}, v).
template <class... F>
struct overloaded : F... {
    using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>;

} // namespace shearwake
