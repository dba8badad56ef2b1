// SPDX-License-Identifier: BSD-3-Clause
#include "serve/interrupt.hpp"

namespace shearwake::serve {
namespace {

constexpr double between_questions_s = 0.01; // a newer request waits about this long

} // namespace

Interrupt::Interrupt(const Comm& team, std::function<bool()> is_asked)
    : is_asked_(std::move(is_asked)), question_(team, between_questions_s) {}

bool Interrupt::stop_asked() {
    stops_ = stops_ || question_.ask(is_asked_);
    return stops_;
}

} // namespace shearwake::serve
