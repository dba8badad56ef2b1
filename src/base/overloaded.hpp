// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shearwake {

/// Combines one lambda per alternative of a variant: std::visit(overloaded{...}, v).
template <class... F>
struct overloaded : F... {
    using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>;

} // namespace shearwake
