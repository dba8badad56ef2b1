// SPDX-License-Identifier: BSD-3-Clause
// The periodic regime against the last repetition of a long run, and against a closed form.
#include "engines/layered/response/stack_response.hpp"
#include "problem/load/load.hpp"
#include "support/cases.hpp"
#include "support/half_space.hpp"

#include <catch2/catch.hpp>
#include <complex>
#include <numbers>
#include <string_view>

namespace test_steady_state {

using namespace shearwake;

using Complex = std::complex<double>;
constexpr double turn = 2.0 * std::numbers::pi;
constexpr double period_s = 10e-3;

static Travel circle(double radius_m, double draws_per_s) {
    return {Arc{{}, radius_m, 0.3, turn}, ConstantSpeed{turn * radius_m * draws_per_s},
            AtEnd::repeat};
}

struct NamedLoad {
    const char* name;
    Trajectory trajectory;
    Envelope envelope = {};
    std::vector<Vec2> foci_m = {};
    Footprint footprint = GaussianFootprint{5e-3};
};

/// Loads whose least common period is 10 ms: six kinds for every medium, and further combinations
/// of them for one.
static std::vector<NamedLoad> loads(std::string_view medium) {
    Travel with_speed = circle(6e-3, 100.0);
    with_speed.motion = OscillatingSpeed{turn * 6e-3 * 100.0, 1.0, 200.0, 0.4};
    const Travel there_and_back{Curve(Vec2{-7e-3, 1e-3}, Vec2{7e-3, -2e-3}),
                                ConstantSpeed{2.0 * std::hypot(14e-3, 3e-3) / period_s},
                                AtEnd::back_and_forth};
    std::vector<NamedLoad> kinds = {
        {"STM", {{circle(8e-3, 100.0)}}},
        {"back and forth", {{there_and_back}}},
        {"AM",
         {{Hold{{2e-3, 1e-3}}}},
         {{SineGain{.frequency_Hz = 200.0}, SineGain{.frequency_Hz = 300.0}}}},
        {"LM", {{Swing{{4e-3, 1e-3}, 100.0}}}},
        {"SM-STM", {{with_speed}}},
        {"STP", {{circle(5e-3, 100.0), circle(2e-3, 300.0)}}}};
    if (medium != "skin") return kinds;
    const std::vector<NamedLoad> combinations = {
        {"DTP", {{circle(6e-3, 100.0), circle(2e-3, 300.0)}}, {{SineGain{.frequency_Hz = 200.0}}}},
        {"custom",
         {{there_and_back, Swing{{0.0, 2e-3}, 300.0}}},
         {{SineGain{.frequency_Hz = 200.0, .on = GainOn::pressure},
           SquareGain{.frequency_Hz = 100.0, .edge_s = 1e-3}}}},
        {"STM of an array", {{circle(8e-3, 100.0)}}, {}, {}, ArrayFootprint{.reach_m = 20e-3}},
        {"AM-STM with two foci",
         {{circle(5e-3, 100.0)}},
         {{SineGain{.frequency_Hz = 200.0}}},
         {{0.0, 3e-3}, {0.0, -3e-3}}}};
    kinds.insert(kinds.end(), combinations.begin(), combinations.end());
    return kinds;
}

struct NamedMedium {
    const char* name;
    Medium medium;
};

static std::vector<NamedMedium> media() {
    Layer film = test::tissue(1500.0, 0.5), fat = test::tissue(1500.0, 5.0);
    film.thickness_m = 0.3e-3;
    film.c_s_m_s = 20.0;
    fat.thickness_m = 20e-3;
    fat.c_s_m_s = 2.8;
    return {{"half-space", test::half_space(test::tissue())},
            {"skin", {{film, test::tissue(1500.0)}, Base::half_space}},
            {"forearm", {{fat}, Base::rigid}}};
}

static Case periodic_case(const Medium& medium) {
    Case c = test::moving_focus(medium, {});
    c.scene.load.footprint = GaussianFootprint{5e-3};
    c.domain = {36, 32, 1.25e-3, 0.0, DomainEdges::open};
    c.time = {60, period_s / 60.0, Regime::periodic};
    c.measure.at_s = period_s;
    c.solver = LayeredOptions{.time_step_s = period_s / 120.0}; // all loads share one table
    return c;
}

/// Frames and energies of a case.
class Recorded : public test::FrameStore {
public:
    void solved(const engines::SolverReport& report) override { report_ = report; }
    const engines::SolverReport& report() const { return report_; }

private:
    engines::SolverReport report_;
};

TEST_CASE("the steady state is the last of many repetitions", "[long][steady_state]") {
    constexpr std::ptrdiff_t repetitions = 12;
    const Comm alone = Comm::world().split(Comm::world().rank());
    for (const NamedMedium& medium : media()) {
        const auto steady = engines::make_engine(LayeredOptions{}),
                   transient = engines::make_engine(LayeredOptions{});
        for (const NamedLoad& load : loads(medium.name)) {
            INFO(load.name << " on the medium " << medium.name);
            Case c = periodic_case(medium.medium);
            c.scene.load.footprint = load.footprint;
            c.scene.load.modulation = {load.name, load.trajectory, load.envelope, load.foci_m};
            const LoadPeriod period = least_period(c.scene.load, 1.0);
            REQUIRE(period.reason.empty());
            REQUIRE(std::abs(period.period_s - period_s) < 1e-12);
            Case run = c;
            run.time = {repetitions * c.time.frames, c.time.interval_s};
            Recorded frames, of_run;
            steady->run(c, alone, frames);
            REQUIRE(frames.report().period_energy);
            CHECK(frames.report().period_energy->work_J > 0.0);
            CHECK(std::abs(frames.report().period_energy->imbalance()) < 1e-6);
            CHECK(frames.report().warnings.empty());
            transient->run(run, alone, of_run);
            double square = 0.0, all = 0.0;
            for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
                const auto &u = frames.at(n),
                           &last = of_run.at((repetitions - 1) * c.time.frames + n);
                for (std::size_t i = 0; i < u.size(); ++i) {
                    square += (u[i] - last[i]) * (u[i] - last[i]);
                    all += u[i] * u[i];
                }
            }
            // The waves of the start have left or decayed: on the forearm, where the layer guides
            // them longest, 1e-4 of the field remains after 110 ms.
            CHECK(std::sqrt(square / all) < 1e-3);
        }
    }
}

TEST_CASE("the work per period is that of the load on the computed field", "[steady_state]") {
    // With the mean displacement w(t) under the resting focus, weighted with its pressure, the work
    // is the integral of e(t) dw/dt over the period: a sum over the harmonics of both.
    Case c = periodic_case(test::half_space(test::tissue()));
    c.scene.load.modulation.trajectory = {{Hold{{2e-3, 1e-3}}}};
    c.scene.load.modulation.envelope = {
        {SineGain{.frequency_Hz = 200.0}, SineGain{.frequency_Hz = 300.0}}};
    const auto frames = test::frames_of<Recorded>(c);
    const Load& load = c.scene.load;
    std::vector<double> w, e;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        double sum = 0.0;
        for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
                sum += pressure(load.footprint, c.domain.x_m(i) - 2e-3, c.domain.y_m(j) - 1e-3) *
                       frames.at(n)[static_cast<std::size_t>(i * c.domain.ny + j)];
        w.push_back(sum * load.peak_Pa * c.domain.spacing_m * c.domain.spacing_m);
        e.push_back(amplitude(load, c.time.frame_s(n)));
    }
    double work_J = 0.0;
    for (int m = 1; m <= 10; ++m) { // the envelope has harmonics up to the fifth
        Complex of_w = 0.0, of_e = 0.0;
        for (std::size_t n = 0; n < w.size(); ++n) {
            const Complex wave =
                std::polar(1.0 / static_cast<double>(w.size()),
                           -turn * m * c.time.frame_s(static_cast<std::ptrdiff_t>(n)) / period_s);
            of_w += w[n] * wave;
            of_e += e[n] * wave;
        }
        work_J += 2.0 * (std::conj(of_e) * Complex(0.0, turn * m) * of_w).real();
    }
    // The Gaussian has fallen to 1e-8 of its peak where the sum over the grid ends.
    CHECK(frames.report().period_energy->work_J == Approx(work_J).epsilon(1e-7));
}

/// Gauss-Legendre rule of 16 points on [from, to].
template <class F>
void integrate(double from, double to, F f) {
    static const double x[] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274,
                               0.6178762444026438, 0.7554044083550030, 0.8656312023878318,
                               0.9445750230732326, 0.9894009349916499};
    static const double w[] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025,
                               0.1495959888165767, 0.1246289712555339, 0.0951585116824928,
                               0.0622535239386479, 0.0271524594117541};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    for (int i = 0; i < 8; ++i) {
        f(middle + half * x[i], half * w[i]);
        f(middle - half * x[i], half * w[i]);
    }
}

TEST_CASE("a circle that is drawn for ever has its closed form", "[steady_state]") {
    // With a radius a and an angle Omega t + theta_0, harmonic m of the field at (r, theta) is
    //   e^{i m (theta_0 - theta)} / (2 pi) integral H(k, m Omega) G(k) J_m(k a) J_m(k r) k dk.
    const double a = 6e-3, fwhm = 6e-3, theta_0 = 0.3;
    Case c = periodic_case(test::half_space(test::tissue()));
    c.scene.load.footprint = GaussianFootprint{fwhm};
    c.scene.load.modulation.trajectory = {{circle(a, 100.0)}};
    c.domain.spacing_m = 1e-3;
    c.solver = LayeredOptions{.interpolation_tolerance = 1e-11};
    const test::FrameStore frames = test::frames_of(c);

    const double sigma = fwhm / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    constexpr int harmonics = 24;
    struct Place {
        std::ptrdiff_t i, j;
        std::vector<Complex> lines;
    };
    std::vector<Place> places = {{18, 16, {}}, {24, 16, {}}, {9, 25, {}}, {35, 1, {}}};
    for (Place& place : places)
        place.lines.resize(harmonics + 1);
    for (int m = 0; m <= harmonics; ++m) {
        const double omega = m * turn / period_s;
        const auto add = [&](double k, double weight) {
            const Complex h = test::half_space_response(c.scene.medium.layers[0], omega, k);
            const Complex common = weight * k / turn * h * turn * sigma * sigma *
                                   std::exp(-0.5 * sigma * sigma * k * k) *
                                   std::cyl_bessel_j(m, k * a);
            for (Place& place : places) {
                const double x = c.domain.x_m(place.i), y = c.domain.y_m(place.j);
                place.lines[static_cast<std::size_t>(m)] +=
                    common * std::polar(1.0, m * (theta_0 - std::atan2(y, x))) *
                    std::cyl_bessel_j(m, k * std::hypot(x, y));
            }
        };
        // Panels of 2/m near the poles, which are at least 1.6/m from the real axis.
        for (double k = 0.0; k < 800.0; k += 2.0)
            integrate(k, k + 2.0, add);
        for (double k = 800.0; k < 3000.0; k += 20.0)
            integrate(k, k + 20.0, add);
    }
    for (const Place& place : places) {
        double worst = 0.0, largest = 0.0;
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            Complex sum = place.lines[0];
            for (int m = 1; m <= harmonics; ++m)
                sum += 2.0 * place.lines[static_cast<std::size_t>(m)] *
                       std::polar(1.0, m * turn * c.time.frame_s(n) / period_s);
            const double u =
                frames.at(n)[static_cast<std::size_t>(place.i * c.domain.ny + place.j)];
            worst = std::max(worst, std::abs(u - sum.real()));
            largest = std::max(largest, std::abs(sum.real()));
        }
        INFO("sample " << place.i << ", " << place.j);
        CHECK(worst < 1e-6 * largest);
    }
}

} // namespace test_steady_state
