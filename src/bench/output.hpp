// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

namespace shearwake::bench {

/// One number of a benchmark.
struct Measurement {
    std::string name;
    double value = 0.0;
    std::string unit;
};

/// Collects the measurements of a benchmark, and prints its text unless a document is wanted.
class Output {
public:
    enum class Form { text, document };
    explicit Output(Form form) : form_(form) {}

    template <class... Arguments>
    void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        if (form_ == Form::text) fmt::print(format, std::forward<Arguments>(arguments)...);
    }
    /// Adds a measurement to the document. Call it on rank 0.
    void add(std::string name, double value, std::string unit) {
        measurements_.push_back({std::move(name), value, std::move(unit)});
    }
    const std::vector<Measurement>& measurements() const { return measurements_; }

private:
    Form form_;
    std::vector<Measurement> measurements_;
};

} // namespace shearwake::bench
