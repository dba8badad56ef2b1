// SPDX-License-Identifier: BSD-3-Clause

#include "neural/response.hpp"
#include "neural/skin/skin.hpp"
#include "support/neural_data.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace test_stress_source {

using namespace shearwake;
using namespace shearwake::neural;

TEST_CASE("scale between stress and the dynamic term equals the closed form", "[neural]") {
    const double z = GENERATE(0.3, 1.6, 2.0, 50.0), a = GENERATE(0.5, 1.0);
    const double xi2 = z * z / (a * a);
    const double closed =
        std::numbers::pi * a * std::pow(1.0 + xi2, 2) / (z * z * (1.0 + 3.0 * xi2));
    // Limited by the stress itself.
    CHECK(dynamic_per_stress_rate(z, a) == Approx(closed).epsilon(1e-11));
    if (z > 20.0) // 5/3 of (a/z)^2 is neglected
        CHECK(closed == Approx(std::numbers::pi / (3.0 * a)).epsilon(1e-3));
}

TEST_CASE("receptor below a pin responds equally to the pin and to its stress", "[neural]") {
    const std::string name =
        GENERATE("sine200_50um", "sine20_300um", "ramphold_1mm", "sine200_50um_fs20k");
    const PinStimulus stimulus = test::single_stimulus(name);
    const std::vector<Afferent> afferents = test::one_of_each_row();
    const Lines load = loads_N(stimulus);
    Lines stress(afferents.size(), load.samples);
    for (std::size_t i = 0; i < afferents.size(); ++i)
        for (std::size_t k = 0; k < load.samples; ++k)
            stress.line(i)[k] =
                load.values[k] * stress_per_load(0.0, depth_mm(afferents[i].kind), 1.0);
    const StressSource source(stress, stimulus.rate_Hz, 1.0);
    const auto spikes = respond(source, afferents, {});
    CHECK(spikes == respond(stimulus, afferents, {}));
    std::size_t count = 0;
    for (const Spikes& train : spikes)
        count += train.size();
    CHECK(count > 50);
}

} // namespace test_stress_source
