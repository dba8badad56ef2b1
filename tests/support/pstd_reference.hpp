// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/source.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/hdf5/h5_block.hpp"
#include "support/pstd_sources.hpp"

#include <cmath>
#include <filesystem>

namespace shearwake::test {

/// Runs of k-Wave's pstdElastic3D (GNU Octave, double precision): 48 x 40 x 32 nodes of 1 mm, c_p =
/// 20 m/s, c_s = 5 m/s, 1000 kg/m^3, with a Gaussian plane source of u_z and a Ricker pulse at z
/// index 13. All four runs use a uniform lossless solid.
struct KwaveRun {
    const char* name;
    pstd::SourceMode mode;
    double pml_strength;
};
constexpr std::ptrdiff_t kwave_nx = 48, kwave_ny = 40, kwave_nz = 32, kwave_steps = 400,
                         kwave_source_z = 13;

inline const std::vector<KwaveRun>& kwave_runs() {
    using pstd::SourceMode;
    static const std::vector<KwaveRun> runs = {
        {"a_additive_pml10", pstd::SourceMode::additive, 2.0},
        {"a_additive_pmloff", pstd::SourceMode::additive, 0.0},
        {"c_dirichlet_pml10", pstd::SourceMode::dirichlet, 2.0},
        {"c_dirichlet_pmloff", pstd::SourceMode::dirichlet, 0.0}};
    return runs;
}

/// The arrays of the file of a run, by name.
class KwaveFile {
public:
    explicit KwaveFile(const std::filesystem::path& path)
        : file_(h5::open_file(path, h5::Access::read)) {}
    std::vector<double> values(const char* name) const {
        return storage::read_numbers(file_.raw(), name).values;
    }
    std::vector<std::ptrdiff_t> integers(const char* name) const {
        std::vector<std::ptrdiff_t> numbers;
        for (const double v : values(name))
            numbers.push_back(std::lround(v));
        return numbers;
    }

private:
    h5::Id file_;
};

inline pstd::Setup kwave_setup(const KwaveFile& file, const KwaveRun& run) {
    using namespace pstd;
    pstd::Setup s;
    s.grid = {{kwave_nx, kwave_ny, kwave_nz}, {1e-3, 1e-3, 1e-3}, 1e-5};
    s.pml.strength_1 = {run.pml_strength, run.pml_strength, run.pml_strength};
    s.material = [](pstd::Node) { return pstd::NodeMaterial{1000.0, 20.0, 5.0}; };
    pstd::Source source{.field = pstd::Field::uz, .mode = run.mode};
    for (std::ptrdiff_t x = 0; x < kwave_nx; ++x)
        for (std::ptrdiff_t y = 0; y < kwave_ny; ++y)
            source.nodes.push_back({x, y, kwave_source_z});
    std::vector<double> pattern_m_s = file.values("source_G");
    for (double& p : pattern_m_s)
        p *= 1e-3;
    s.sources.push_back(test::separable_source(source, pattern_m_s, file.values("source_R")));
    return s;
}

} // namespace shearwake::test
