// SPDX-License-Identifier: BSD-3-Clause
// Compares with a table of eta and focal rms that was computed independently with the closed form
// of the half-space: 1000 kg/m^3, c_s = 5 m/s, c_p = 50 m/s, 1 Pa s; FWHM 3 mm, r_f 3 mm; 192 x 144
// mm at 0.75 mm; frames every 62.5 us; complete periods in 4 < t <= 14 ms.
#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_reference_table {

using namespace shearwake;

struct Entry {
    double frequency_Hz, eta_at, eta_period, focal_rms_nm;
};

constexpr Entry am_stm[] = {{100.0, 0.294, 0.1718, 73.3},
                            {200.0, 0.133, 0.1863, 71.6},
                            {400.0, 0.295, 0.1831, 67.5},
                            {800.0, 0.048, 0.1746, 63.6}};
constexpr Entry sm_stm[] = {{100.0, 0.094, 0.1967, 132.1},
                            {200.0, 0.234, 0.1860, 127.4},
                            {400.0, 0.123, 0.1711, 121.8},
                            {800.0, 0.144, 0.1665, 120.3}};
constexpr Entry stm = {0.0, 0.141, 0.1671, 120.7};

/// Focal rms as defined in the table: root of the time mean of sum_focal u^2 over the samples, nm
/// per Pa.
static double focal_rms_nm(const std::map<std::string, double>& columns) {
    const double samples_in_disc = M_PI * 3e-3 * 3e-3 / (0.75e-3 * 0.75e-3);
    return 1e3 * columns.at("focal_rms_um") * std::sqrt(samples_in_disc);
}

static void check_entry(const Case& c, const Entry& entry, double reference_rms_nm,
                        const std::map<std::string, double>& columns) {
    CAPTURE(c.scene.load.modulation.kind, entry.frequency_Hz);
    CHECK(columns.at("eta_period_1") == Approx(entry.eta_period).epsilon(0.01));
    // The table has three digits: half a digit of .048 is 1 %.
    CHECK(columns.at("eta_at_1") == Approx(entry.eta_at).epsilon(0.03));
    CHECK(focal_rms_nm(columns) / reference_rms_nm ==
          Approx(entry.focal_rms_nm / stm.focal_rms_nm).epsilon(0.01));
}

TEST_CASE("reproduces an independent table of AM-STM and SM-STM values", "[verify]") {
    const Medium medium = test::half_space(test::tissue());
    const Comm alone = Comm::world().split(Comm::world().rank());
    const Case plain = test::moving_focus(medium, ConstantSpeed{7.0});
    const auto engine = engines::make_engine(plain.solver);

    const auto reference = test::columns_of(plain, *engine, alone);
    const double rms_nm = focal_rms_nm(reference);
    CHECK(rms_nm == Approx(stm.focal_rms_nm).epsilon(0.01));
    check_entry(plain, stm, rms_nm, reference);
    for (const Entry& entry : am_stm) {
        Case c = plain;
        c.scene.load.modulation.kind = "AM-STM";
        c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = entry.frequency_Hz}}};
        check_entry(c, entry, rms_nm, test::columns_of(c, *engine, alone));
    }
    for (const Entry& entry : sm_stm) {
        Case c = test::moving_focus(medium, OscillatingSpeed{7.0, 2.0, entry.frequency_Hz, 0.0});
        c.scene.load.modulation.kind = "SM-STM";
        check_entry(c, entry, rms_nm, test::columns_of(c, *engine, alone));
    }
}

} // namespace test_reference_table
