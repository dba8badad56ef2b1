// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/optimise/study.hpp"

#include <string>

namespace shearwake::optimise {

/// The forms of a case, and one of its optima with the certificate, as JSON. Numbers are read back
/// exactly. The readers throw UsageError (environment) for a damaged text; `name` is for this
/// message. Not collective.
std::string forms_text(const std::string& id, const Knots& knots, const Forms& forms);
Forms read_forms(const std::string& text, const std::string& name);
/// `forms_id`: of the file with the forms of the motion of the optimum.
std::string optimum_text(const std::string& id, const std::string& forms_id,
                         const Optimum& optimum);
Optimum read_optimum(const std::string& text, const std::string& name);

} // namespace shearwake::optimise
