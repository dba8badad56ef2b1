// SPDX-License-Identifier: BSD-3-Clause
// Loads that jump, bend and start between samples: engine `layered` against a numerical inversion
// of Laplace transforms that are known in closed form, and the same fields with frequent and rare
// frames.
//
// On a line x_f = x_0 + v (t - t_j) from t_j to t_j+1, the load of the wave vector k is e^{-i k .
// x_f}, whose Laplace transform is [e^{-s t_j} e^{-i k . x_0} - e^{-s t_j+1} e^{-i k . x_1}] / (s +
// i k . v). The response is therefore a sum over the ends of all passes of r(t - t_j) e^{-i k . x},
// where r has the transform H(k, s) / (s + i k . v). It is inverted by the Euler algorithm (Abate
// and Whitt 1995, ORSA Journal on Computing 7, 36), a Fourier series of its own for each time,
// whose alternating tail is summed by Euler's transformation. It has neither samples of the load
// nor a highest frequency.
#include "engines/layered/load/time_step.hpp"
#include "engines/layered/response/stack_response.hpp"
#include "problem/load/footprint.hpp"
#include "problem/load/load.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <complex>
#include <numbers>

namespace test_load_jumps {

using namespace shearwake;

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

/// The function of t whose Laplace transform is F, from both(s) = F(s) + F(conj s).
template <class Both>
Complex inverse_laplace(const Both& both, double t_s) {
    constexpr double a = 18.4; // discretisation error e^-a = 1e-8
    constexpr int terms = 160, extra = 14;
    std::array<Complex, extra + 1> partial;
    Complex sum = 0.0;
    for (int n = 0; n <= terms + extra; ++n) {
        const Complex s(0.5 * a / t_s, pi * n / t_s);
        sum += (n == 0 ? 0.5 : n % 2 == 0 ? 1.0 : -1.0) * both(s);
        if (n >= terms) partial[static_cast<std::size_t>(n - terms)] = sum;
    }
    Complex mean = 0.0;
    double binomial = std::pow(0.5, extra);
    for (int m = 0; m <= extra; ++m) {
        mean += binomial * partial[static_cast<std::size_t>(m)];
        binomial *= static_cast<double>(extra - m) / (m + 1);
    }
    return std::exp(0.5 * a) / (2.0 * t_s) * mean;
}

/// An end of a pass: from its time on the response is multiplied by +1 or -1.
struct End {
    double time_s;
    Vec2 place_m;
    double sign;
};

/// u_z at grid points of a focus whose passes have one velocity.
static std::vector<double> displacements_m(const Case& c, const std::vector<End>& ends,
                                           Vec2 velocity_m_s, const std::vector<Vec2>& places_m,
                                           double t_s) {
    const double dkx = 2.0 * pi / c.domain.extent_x_m(), dky = 2.0 * pi / c.domain.extent_y_m();
    std::vector<double> sums(places_m.size());
    for (std::ptrdiff_t i = 1 - c.domain.nx / 2; i < c.domain.nx / 2; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny / 2; ++j) {
            const Vec2 k{static_cast<double>(i) * dkx, static_cast<double>(j) * dky};
            if (i == 0 && j == 0) continue; // the mean, subtracted on the other side as well
            const auto both = [&](Complex s) {
                // e^{i omega t} with omega = -i s; H at the conjugate of s is the conjugate.
                Complex h;
                const double depth_m = 0.0;
                layered::StackResponse(c.scene.medium, Complex(s.imag(), -s.real()), {&depth_m, 1})
                    .evaluate(norm(k), {&h, 1});
                const Complex rate(0.0, dot(k, velocity_m_s));
                return h / (s + rate) + std::conj(h) / (std::conj(s) + rate);
            };
            Complex response = 0.0;
            for (const End& end : ends)
                if (end.time_s < t_s)
                    response += end.sign * std::polar(1.0, -dot(k, end.place_m)) *
                                inverse_laplace(both, t_s - end.time_s);
            response *= (j == 0 ? 1.0 : 2.0) * spectrum(c.scene.load.footprint, k.x, k.y);
            for (std::size_t n = 0; n < sums.size(); ++n)
                sums[n] += (response * std::polar(1.0, dot(k, places_m[n]))).real();
        }
    for (double& sum : sums)
        sum *= c.scene.load.peak_Pa / (c.domain.extent_x_m() * c.domain.extent_y_m());
    return sums;
}

static double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

static Case small_case(const Medium& medium) {
    Case c = test::moving_focus(medium, {});
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.domain = {16, 16, 1.5e-3, 0.0};
    return c;
}

static double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values)
        most = std::max(most, std::abs(value));
    return most;
}

TEST_CASE("a line that is drawn again and again agrees with Laplace inversion",
          "[layered][jumps]") {
    Layer layer = test::tissue(1500.0, 0.5);
    layer.thickness_m = 10e-3;
    for (const Medium& medium :
         {Medium{{layer}, Base::rigid}, test::half_space(test::tissue(50.0))}) {
        const Vec2 from{-8e-3, -2e-3}, to{7e-3, 3e-3};
        const double speed_m_s = 7.0, pass_s = norm(to - from) / speed_m_s;
        Case c = small_case(medium);
        c.scene.load.modulation.trajectory.parts = {
            Travel{Line{from, to}, ConstantSpeed{speed_m_s}, AtEnd::repeat}};
        std::vector<End> ends;
        for (int pass = 0; pass < 4; ++pass) {
            ends.push_back({pass * pass_s, from, 1.0});
            ends.push_back({(pass + 1) * pass_s, to, -1.0});
        }
        const std::vector<std::ptrdiff_t> columns = {3, 8, 12};
        std::vector<Vec2> places_m;
        for (const std::ptrdiff_t i : columns)
            places_m.push_back({c.domain.x_m(i), c.domain.y_m(9)});
        // After the start, just after the first and the second jump (2.26 and 4.52 ms), and later.
        std::map<double, std::vector<double>> expected;
        for (const double t_s : {0.6e-3, 2.4e-3, 4.5e-3, 4.8e-3, 6e-3})
            expected[t_s] = displacements_m(c, ends, (speed_m_s / norm(to - from)) * (to - from),
                                            places_m, t_s);
        for (const double interval_s : {100e-6, 300e-6}) {
            c.time = {std::lround(6e-3 / interval_s), interval_s};
            const test::FrameStore frames = test::frames_of(c);
            double most = 0.0;
            for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
                most = std::max(most, largest(frames.at(n)));
            for (const auto& [t_s, values] : expected) {
                const auto& u = frames.at(std::lround(t_s / interval_s) - 1);
                for (std::size_t n = 0; n < columns.size(); ++n) {
                    INFO("t = " << t_s << " s, x = " << places_m[n].x << " m");
                    // The stated accuracy of the default step is 1e-4; 3e-5 is asked of this case,
                    // whose step was chosen for it.
                    CHECK(std::abs(u[static_cast<std::size_t>(columns[n] * c.domain.ny + 9)] -
                                   mean(u) - values[n]) < 3e-5 * most);
                }
            }
        }
    }
}

TEST_CASE("rare frames do not change the field", "[layered][jumps]") {
    Layer layer = test::tissue(1500.0, 0.5);
    layer.thickness_m = 10e-3;
    const Medium medium{{layer}, Base::rigid};
    const Travel line{Line{{-7e-3, -1e-3}, {7e-3, 2e-3}}, ConstantSpeed{3.0}, AtEnd::repeat};
    Travel ends = line, turns = line;
    ends.at_end = AtEnd::off;
    turns.at_end = AtEnd::back_and_forth;
    const Polyline triangle({{-5e-3, -4e-3}, {6e-3, -3e-3}, {0.0, 6e-3}}, Ends::closed);
    const Arc circle{{}, 5e-3, 0.2, 2.0 * pi};
    ArrayFootprint array{.reach_m = 2e-2};
    array.update_rate_Hz = 1000.0;
    struct Kind {
        const char* name;
        Mover mover;
        Envelope envelope = {};
        Footprint footprint = GaussianFootprint{4e-3};
    };
    const std::vector<Kind> kinds = {
        {"a constant force", Hold{}},
        {"AM", Hold{}, {{SineGain{.frequency_Hz = 180.0}}}},
        {"AM from half strength",
         Hold{},
         {{SineGain{.frequency_Hz = 180.0, .phase_rad = 0.5 * pi}}}},
        {"STM at .5 m/s", Travel{line.path, ConstantSpeed{0.5}, AtEnd::repeat}},
        {"a repeated line", line},
        {"a line that ends", ends},
        {"back and forth", turns},
        {"a triangle", Travel{triangle, ConstantSpeed{4.0}, AtEnd::repeat}},
        {"SM-STM", Travel{circle, OscillatingSpeed{4.0, 2.0, 300.0, 0.3}, AtEnd::repeat}},
        {"LM", Swing{{4e-3, 1e-3}, 100.0, 0.0, SwingWave::triangle}},
        {"square AM", Hold{}, {{SquareGain{.frequency_Hz = 150.0, .edge_s = 250e-6}}}},
        {"samples",
         Travel{circle, ConstantSpeed{2.0}, AtEnd::repeat},
         {{SampledGain{{0.2, 1.0, 0.4}, 700e-6, true}}}},
        {"an array with an update rate", line, {}, array}};
    for (const Kind& kind : kinds) {
        INFO(kind.name);
        Case c = small_case(medium);
        c.scene.load.footprint = kind.footprint;
        c.scene.load.modulation.trajectory.parts = {kind.mover};
        c.scene.load.modulation.envelope = kind.envelope;
        c.measure.depths_m = {0.0, 9e-3};
        Case rare = c;
        c.time = {200, 50e-6};
        rare.time = {10, 1e-3};
        const test::FrameStore frames = test::frames_of(c), few = test::frames_of(rare);
        for (const std::size_t depth : {0u, 1u}) {
            double most = 0.0, difference = 0.0;
            for (std::ptrdiff_t n = 0; n < rare.time.frames; ++n) {
                const auto &u = frames.at(20 * n + 19, depth), &v = few.at(n, depth);
                most = std::max(most, largest(u));
                for (std::size_t i = 0; i < u.size(); ++i)
                    difference = std::max(difference, std::abs(u[i] - v[i]));
            }
            INFO("depth " << depth << ": " << difference / most);
            CHECK(difference < 1e-4 * most); // the stated accuracy
        }
    }
}

TEST_CASE("the estimated error of a step is that of the field for edges of any duration",
          "[layered][jumps]") {
    Layer layer = test::tissue(1500.0, 0.5);
    layer.thickness_m = 10e-3;
    Case c = small_case({{layer}, Base::rigid});
    c.time = {50, 200e-6};
    c.scene.load.modulation.trajectory.parts = {Hold{}};
    const auto fields = [&](std::optional<double> step_s) {
        c.solver = LayeredOptions{.time_step_s = step_s};
        return test::frames_of(c);
    };
    for (const double edge_s : {40e-6, 50e-6, 80e-6, 100e-6, 150e-6}) {
        c.scene.load.modulation.envelope = {{SquareGain{.frequency_Hz = 150.0, .edge_s = edge_s}}};
        const test::FrameStore exact = fields(5e-6);
        for (const double step_s : {0.0, 12.5e-6, 25e-6, 50e-6, 100e-6}) {
            const bool is_automatic = step_s == 0.0;
            const test::FrameStore found =
                fields(is_automatic ? std::nullopt : std::optional(step_s));
            double most = 0.0, difference = 0.0;
            for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
                most = std::max(most, largest(exact.at(n)));
                for (std::size_t i = 0; i < exact.at(n).size(); ++i)
                    difference = std::max(difference, std::abs(found.at(n)[i] - exact.at(n)[i]));
            }
            const double used_s =
                layered::time_transform(c, std::get<LayeredOptions>(c.solver)).step_s;
            const double estimate = layered::step_error(c, used_s), error = difference / most;
            INFO("edge " << edge_s << " s, step " << used_s << " s, estimate " << estimate
                         << ", error " << error);
            if (is_automatic) CHECK(estimate <= layered::step_accuracy);
            CHECK(error <= 1.5 * std::max(estimate, layered::step_accuracy));
            // No false alarm: between half an edge and one, the error grows by 130.
            if (estimate > layered::stated_accuracy && estimate < layered::largest_estimate)
                CHECK(error >= 0.05 * estimate);
        }
    }
}

TEST_CASE("rare frames do not change the steady state", "[layered][jumps]") {
    Layer layer = test::tissue(1500.0, 0.5);
    layer.thickness_m = 10e-3;
    const double period_s = 8e-3;
    const Travel line{Line{{-8e-3, 1e-3}, {8e-3, -1e-3}},
                      ConstantSpeed{norm(Vec2{16e-3, -2e-3}) / period_s}, AtEnd::repeat};
    const Envelope square{{SquareGain{.frequency_Hz = 125.0, .edge_s = 250e-6}}};
    for (const auto& [mover, envelope] :
         {std::pair<Mover, Envelope>{line, {}}, std::pair<Mover, Envelope>{Hold{}, square}}) {
        Case c = small_case({{layer}, Base::rigid});
        c.scene.load.modulation.trajectory.parts = {mover};
        c.scene.load.modulation.envelope = envelope;
        c.domain.edges = DomainEdges::open;
        Case rare = c;
        c.time = {160, 50e-6, Regime::periodic};
        rare.time = {8, 1e-3, Regime::periodic};
        const test::FrameStore frames = test::frames_of(c), few = test::frames_of(rare);
        double most = 0.0, difference = 0.0;
        for (std::ptrdiff_t n = 0; n < rare.time.frames; ++n) {
            const auto &u = frames.at(20 * n + 19), &v = few.at(n);
            most = std::max(most, largest(u));
            for (std::size_t i = 0; i < u.size(); ++i)
                difference = std::max(difference, std::abs(u[i] - v[i]));
        }
        CHECK(difference < 1e-4 * most); // the stated accuracy
    }
}

TEST_CASE("the steady state of a period with few samples is that of many", "[layered][jumps]") {
    // The windows around the break of a closed circle overlap if a period has fewer than 20 steps.
    Layer layer = test::tissue(1500.0, 2.6);
    layer.thickness_m = 9.4e-3;
    layer.c_s_m_s = 2.8;
    Case c = small_case({{layer}, Base::rigid});
    c.scene.load.footprint = GaussianFootprint{10.2e-3};
    const double radius_m = 3e-3, draw_Hz = 200.0;
    c.scene.load.modulation.trajectory.parts = {Travel{Arc{{}, radius_m, 0.0, 2.0 * pi},
                                                       ConstantSpeed{2.0 * pi * radius_m * draw_Hz},
                                                       AtEnd::repeat}};
    c.domain.edges = DomainEdges::open;
    c.time = {80, 1.0 / (80.0 * draw_Hz), Regime::periodic};
    const test::FrameStore frames = test::frames_of(c);
    for (const auto& [count, is_chosen] :
         {std::pair{8, true}, std::pair{10, true}, std::pair{16, true}, std::pair{10, false}}) {
        Case few = c;
        few.time = {count, 1.0 / (count * draw_Hz), Regime::periodic};
        if (!is_chosen) few.solver = LayeredOptions{.time_step_s = few.time.interval_s};
        const test::FrameStore found = test::frames_of(few);
        double most = 0.0, difference = 0.0;
        for (std::ptrdiff_t n = 0; n < count; ++n) {
            const auto& u = frames.at(80 / count * (n + 1) - 1);
            most = std::max(most, largest(u));
            for (std::size_t i = 0; i < u.size(); ++i)
                difference = std::max(difference, std::abs(u[i] - found.at(n)[i]));
        }
        INFO(count << " samples: " << difference / most);
        CHECK(difference < 1e-4 * most); // the stated accuracy
    }
}

TEST_CASE("the work of the load in the steady state is the integral of pressure and velocity",
          "[layered][jumps]") {
    // A sum over the points of the grid and over frames, with velocities by differences of the
    // fourth order between frames: neither wave vectors nor the transform of the load take part.
    const std::ptrdiff_t count = 1200;
    const double period_s = 8e-3;
    Layer layer = test::tissue(1500.0, 0.5);
    layer.thickness_m = 10e-3;
    Case c = small_case({{layer}, Base::rigid});
    c.domain = {32, 24, 1e-3, 0.0, DomainEdges::open};
    c.time = {count, period_s / count, Regime::periodic};
    Travel line{Line{{-6e-3, 0.0}, {6e-3, 1e-3}}, ConstantSpeed{norm(Vec2{12e-3, 1e-3}) / period_s},
                AtEnd::repeat};
    c.scene.load.modulation.trajectory.parts = {line};
    c.measure.at_s = period_s;
    class Work : public test::FrameStore {
    public:
        void solved(const engines::SolverReport& report) override { energy = report.period_energy; }
        std::optional<engines::PeriodEnergy> energy;
    } frames;
    const Comm alone = Comm::world().split(Comm::world().rank());
    engines::make_engine(c.solver)->run(c, alone, frames);
    REQUIRE(frames.energy);
    double work_J = 0.0;
    const auto at = [&](std::ptrdiff_t n) -> const std::vector<double>& {
        return frames.at((n + count) % count);
    };
    for (std::ptrdiff_t n = 0; n < count; ++n) {
        // A frame at the jump has the mean of both sides.
        const Vec2 before = focus_m(c.scene.load, c.time.frame_s(n) - 1e-9),
                   after = focus_m(c.scene.load, c.time.frame_s(n) + 1e-9);
        for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
                const auto k = static_cast<std::size_t>(i * c.domain.ny + j);
                const double moved_m =
                    (8.0 * (at(n + 1)[k] - at(n - 1)[k]) - (at(n + 2)[k] - at(n - 2)[k])) / 12.0;
                for (const Vec2 focus : {before, after})
                    work_J += 0.5 * moved_m *
                              pressure(c.scene.load.footprint, c.domain.x_m(i) - focus.x,
                                       c.domain.y_m(j) - focus.y);
            }
    }
    work_J *= c.scene.load.peak_Pa * c.domain.spacing_m * c.domain.spacing_m;
    // The trapezoidal rule at the jump is of second order: 1e-5 with 1200 frames. The tails of the
    // footprint outside of the grid have 1e-5 of the force.
    CHECK(work_J == Approx(frames.energy->work_J).epsilon(1e-4));
    CHECK(std::abs(frames.energy->imbalance()) < 1e-6);
}

TEST_CASE("a path that ends with the run gives the frames of a longer run", "[layered][jumps]") {
    // The slower compressional waves are, the more the load at an instant moves the surface.
    const double c_p_m_s = GENERATE(10.0, 50.0, 1500.0);
    Case c = test::moving_focus(test::half_space(test::tissue(c_p_m_s, 0.5)), ConstantSpeed{5.0});
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.scene.load.modulation.trajectory = {
        {Travel{{{-7e-3, 0.0}, {7e-3, 0.0}}, ConstantSpeed{5.0}}}}; // for 2.8 ms
    c.scene.load.modulation.envelope = {{SineGain{200.0}}};
    c.domain = {60, 44, 1.6e-3, 0.0};
    c.time = {28, 100e-6};
    Case longer = c;
    longer.time.frames = 36;
    const auto frames = test::frames_of(c), reference = test::frames_of(longer);
    double difference = 0.0, most = 0.0;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        for (std::size_t i = 0; i < frames.at(n).size(); ++i) {
            difference = std::max(difference, std::abs(frames.at(n)[i] - reference.at(n)[i]));
            most = std::max(most, std::abs(reference.at(n)[i]));
        }
    CAPTURE(c_p_m_s, difference / most);
    // Observed 5e-7 at most. A step chosen without this break causes 2e-3, 1e-3 and 1e-4.
    CHECK(difference < 2e-5 * most);
}

} // namespace test_load_jumps
