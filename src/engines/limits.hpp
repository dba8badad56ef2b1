// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/remark.hpp"

#include <string>
#include <vector>

namespace shearwake::engines {

/// A choice of an engine. `key` is empty, or the key to change where the choice reduces the
/// accuracy.
struct Choice {
    std::string key, text;
};
/// The texts of all choices.
std::vector<std::string> notes_of(const std::vector<Choice>& choices);
/// Warnings about the choices that reduce the accuracy.
std::vector<Remark> warnings_of(const std::vector<Choice>& choices);

/// Errors if the case requests open edges or the periodic regime, for engines that step in time on
/// a periodic or absorbing domain.
std::vector<Remark> refused_edges(const Case& c);

/// Errors for the layers that are neither lossless nor Kelvin-Voigt, for engines that step in time.
std::vector<Remark> refused_losses(const Case& c);

} // namespace shearwake::engines
