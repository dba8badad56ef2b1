// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/respond.hpp"
#include "support/places.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

// The spike trains of tests/data/neural and the traces that caused them, see the README.md there.

namespace shearwake::test {

/// The rows of a CSV file without comments and heading.
inline std::vector<std::vector<std::string>> csv_rows(const std::string& file) {
    std::ifstream in(data_folder / "neural" / file);
    std::vector<std::vector<std::string>> rows;
    bool heading = true;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line.front() == '#') continue;
        if (!std::exchange(heading, false)) {
            std::vector<std::string>& row = rows.emplace_back();
            std::istringstream cells(line + ",");
            for (std::string cell; std::getline(cells, cell, ',');)
                row.push_back(cell);
        }
    }
    return rows;
}

inline neural::Spikes train(const std::string& cell) {
    neural::Spikes spikes;
    std::istringstream numbers(cell);
    for (std::uint32_t sample = 0; numbers >> sample;)
        spikes.push_back(sample);
    return spikes;
}

/// One afferent per row of the table of neurons, at the origin.
inline std::vector<neural::Afferent> one_of_each_row() {
    std::vector<neural::Afferent> afferents;
    for (const AfferentClass kind : neural::all_classes)
        for (std::size_t row = 0; row < neural::neuron_rows(kind).size(); ++row)
            afferents.push_back({{}, kind, row});
    return afferents;
}

inline double sine(double frequency_Hz, double t_s) {
    return std::sin(2.0 * std::numbers::pi * frequency_Hz * t_s);
}

/// A stimulus by one pin of radius 1 mm at the origin.
inline neural::PinStimulus single_stimulus(const std::string& name) {
    neural::PinStimulus s{.at_mm = {{}}, .radius_mm = 1.0, .rate_Hz = 5000.0};
    if (name == "sine200_50um_fs20k") s.rate_Hz = 20000.0;
    const auto samples = static_cast<std::size_t>(0.5 * s.rate_Hz);
    s.indentation_mm = neural::Lines(1, samples);
    for (std::size_t k = 0; k < samples; ++k) {
        const double t_s = static_cast<double>(k) / s.rate_Hz;
        const double ramp = std::min({(static_cast<double>(k) - 250.0) / 250.0, 1.0,
                                      (2250.0 - static_cast<double>(k)) / 250.0});
        s.indentation_mm.values[k] = name == "sine20_300um"   ? 0.3 * sine(20.0, t_s)
                                     : name == "sine60_100um" ? 0.1 * sine(60.0, t_s)
                                     : name == "ramphold_1mm" ? std::max(ramp, 0.0)
                                     : name == "sine200_50um_preindent"
                                         ? 0.5 + 0.05 * sine(200.0, t_s)
                                         : 0.05 * sine(200.0, t_s);
    }
    return s;
}

/// One second of a carrier of 40 kHz, or of its envelope, by a pin of radius 1 mm on the palm.
inline neural::PinStimulus palm_stimulus(const std::string& modulation, const std::string& trace) {
    const bool is_envelope = trace == "envelope5k";
    neural::PinStimulus s{
        .at_mm = {{126.0, 10.0}}, .radius_mm = 1.0, .rate_Hz = is_envelope ? 5e3 : 200e3};
    const auto samples = static_cast<std::size_t>(s.rate_Hz);
    s.indentation_mm = neural::Lines(1, samples);
    constexpr double A = 0.05, turn = 2.0 * std::numbers::pi;
    for (std::size_t k = 0; k < samples; ++k) {
        const std::size_t period = is_envelope ? 25 : 1000; // of the modulation
        const double phase = static_cast<double>(k % period) / static_cast<double>(period);
        const double m = modulation == "unmod" ? 1.0 : 0.5 * (1.0 - std::cos(turn * phase));
        const double c = std::sin(turn * static_cast<double>(k % 5) / 5.0);
        double value = A * m * c;
        if (is_envelope) value = 0.5 * A * m * m;
        if (trace == "halfwave") value = A * std::max(m * c, 0.0);
        if (trace.starts_with("square")) value = A * (m * c) * (m * c);
        if (trace == "square_pad20ms" && (k < 4000 || k >= 196000)) value = 0.0;
        s.indentation_mm.values[k] = value;
    }
    return s;
}

} // namespace shearwake::test
