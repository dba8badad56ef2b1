// SPDX-License-Identifier: BSD-3-Clause
#include "neural/fibre/fibre.hpp"

#include "base/units.hpp"
#include "neural/kernels/neuron.hpp"
#include "simd/kernels.hpp"

#include <Random123/philox.h>
#include <Random123/uniform.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>

namespace shearwake::neural {
namespace {

const NeuronKernels& kernels() {
    return simd::kernels<NeuronKernels>();
}

LowPass low_pass_of(const EightNeurons& neurons) {
    LowPass filter;
    for (std::ptrdiff_t i = 0; i < lane_count; ++i) {
        const double K = std::tan(std::numbers::pi * 10.0 / neuron_rate_Hz * neurons.low_pass[i]);
        const double p0 = K + 1.0, p1 = K - 1.0; // first-order factor
        // Second-order factor.
        const double q0 = K * K + K + 1.0, q1 = 2.0 * K * K - 2.0, q2 = K * K - K + 1.0;
        const double c = p0 * q0;
        filter.b[i] = K * K * K / c;
        filter.a1[i] = (p0 * q1 + p1 * q0) / c;
        filter.a2[i] = (p0 * q2 + p1 * q1) / c;
        filter.a3[i] = p1 * q2 / c;
    }
    return filter;
}

} // namespace

EightNeurons side_by_side(std::span<const Afferent> afferents) {
    using Row = NeuronRow;
    constexpr std::array<std::pair<double Row::*, Block EightNeurons::*>, 13> members = {
        {{&Row::low_pass, &EightNeurons::low_pass},
         {&Row::static_positive, &EightNeurons::static_positive},
         {&Row::static_negative, &EightNeurons::static_negative},
         {&Row::rate_positive, &EightNeurons::rate_positive},
         {&Row::rate_negative, &EightNeurons::rate_negative},
         {&Row::jerk_positive, &EightNeurons::jerk_positive},
         {&Row::jerk_negative, &EightNeurons::jerk_negative},
         {&Row::saturation, &EightNeurons::saturation},
         {&Row::noise, &EightNeurons::noise},
         {&Row::membrane_samples, &EightNeurons::membrane_samples},
         {&Row::after_spike_1, &EightNeurons::after_spike_1},
         {&Row::after_spike_2, &EightNeurons::after_spike_2},
         {&Row::delay_ms, &EightNeurons::delay_ms}}};
    EightNeurons eight{};
    for (std::ptrdiff_t i = 0; i < lane_count; ++i) {
        const Afferent& afferent =
            afferents[std::min(static_cast<std::size_t>(i), afferents.size() - 1)];
        const NeuronRow& row = neuron_rows(afferent.kind)[afferent.row];
        for (const auto& [one, lanes] : members)
            (eight.*lanes)[i] = row.*one;
    }
    return eight;
}

void low_pass(const EightNeurons& neurons, Line& line) {
    kernels().low_pass(low_pass_of(neurons), std::ssize(line), line.data());
}

Line current(const EightNeurons& neurons, const Line& s, Line d) {
    const CurrentWeights weights = {.static_positive = neurons.static_positive,
                                    .static_negative = neurons.static_negative,
                                    .rate_positive = neurons.rate_positive,
                                    .rate_negative = neurons.rate_negative,
                                    .jerk_positive = neurons.jerk_positive,
                                    .jerk_negative = neurons.jerk_negative};
    kernels().current(weights, std::ssize(d), s.empty() ? nullptr : s.data(), d.data());
    return d;
}

void add_noise(const EightNeurons& neurons, std::uint64_t key,
               std::span<const std::uint32_t> afferent_numbers, Line& I) {
    for (std::size_t k = 0; k < I.size(); k += 2) {
        for (std::size_t i = 0; i < afferent_numbers.size(); ++i) {
            const auto lane = static_cast<std::ptrdiff_t>(i);
            const auto pair = two_normals(key, afferent_numbers[i], k / 2);
            I[k][lane] += neurons.noise[lane] * pair[0];
            if (k + 1 < I.size()) I[k + 1][lane] += neurons.noise[lane] * pair[1];
        }
    }
}

void saturate(const EightNeurons& neurons, Line& I) {
    kernels().saturate(neurons.saturation, std::ssize(I), I.data());
}

std::array<Block, after_spike_samples + 1> after_spike_current(const EightNeurons& neurons) {
    using std::numbers::pi;
    std::array<Block, after_spike_samples + 1> h{};
    for (std::size_t j = 0; j < after_spike_samples; ++j) {
        const double u = 0.75 * pi * std::log1p(static_cast<double>(j) / 5.0) / std::log(3.0);
        const double b1 = 0.5 * (1.0 + std::cos(std::min(u, pi)));
        const double b2 = 0.5 * (1.0 + std::cos(std::clamp(u - 1.5 * pi, -pi, pi)));
        add_scaled(b1, neurons.after_spike_1, h[j]);
        add_scaled(b2, neurons.after_spike_2, h[j]);
    }
    return h;
}

std::array<std::vector<std::uint32_t>, lane_count> integrate_and_fire(const EightNeurons& neurons,
                                                                      const Line& I) {
    const auto h = after_spike_current(neurons);
    std::vector<unsigned char> fired(I.size());
    kernels().integrate_and_fire(neurons.membrane_samples, h.data(), after_spike_samples,
                                 std::ssize(I), I.data(), fired.data());
    std::array<std::vector<std::uint32_t>, lane_count> spikes;
    for (std::size_t k = 0; k < fired.size(); ++k)
        for (unsigned lanes = fired[k]; lanes != 0; lanes &= lanes - 1)
            spikes[static_cast<std::size_t>(std::countr_zero(lanes))].push_back(
                static_cast<std::uint32_t>(k));
    return spikes;
}

std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto low = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const r123::Philox4x32::ctr_type at = {{low(counter), low(counter >> 32), stream, 0}};
    const r123::Philox4x32::key_type with = {{low(key), low(key >> 32)}};
    const auto bits = r123::Philox4x32{}(at, with);
    const auto word = [&](std::size_t i) {
        return static_cast<std::uint64_t>(bits[i + 1]) << 32 | bits[i];
    };
    return {r123::u01<double>(word(0)), r123::u01<double>(word(2))};
}

std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto [u, v] = two_uniforms(key, stream, counter);
    const double radius = std::sqrt(-2.0 * std::log(u)), angle = two_pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

namespace {

// Saal, Delhaye, Rayhaun and Bensmaia, PNAS 114 (2017) E5693: neurons fitted to the responses of
// single fibres of macaques. Columns are in the order of NeuronParameters.
// clang-format off
constexpr std::array<NeuronRow, 4> SA1_rows = {{
    {10.1317138671875, 0.4346477971850776, -0.3183095561981179,
     0.005801812635149275, -0.003968963623046875, 0.0, 0.0,
     0.0, 0.015624985098838806, 281.20660400390625,
     -0.2770230138813521, -7.37607479095459e-06, 4.911723506025806},
    {10.23828125, 0.2412385912745362, 0.12073856448095693,
     0.0013467991020565942, -0.0006571010044642857, 0.0, 0.0,
     0.0, 0.015624985098838806, 249.483642578125,
     -0.0368194580078125, 0.0, 1.0726562500000014},
    {8.773358270525932, 0.9886979737922287, 1.1086141173869393,
     0.0034691394266628084, 0.0, 0.0, 0.0,
     0.0, 0.015624985098838806, 168.93812130391598,
     -0.40451574325561523, -0.0015840381383895874, 1.0411652088165297},
    {10.0927734375, 0.25340826489318846, -0.05668146275281015,
     0.002346132550920759, -0.0018686104910714285, 0.0, 0.0,
     0.0, 0.015903189778327942, 408.9072265625,
     -0.00714111328125, 0.0, 3.1351562500000014},
}};
constexpr std::array<NeuronRow, 9> RA_rows = {{
    {10.185546875, 0.0, 0.0,
     0.3384958031063988, 0.2545269097222222, -11.344285955133929, 1.8030133928571428,
     279.794677734375, 0.044993430376052856, 20.396484375,
     -1.8815673828124986, -0.07879638671875, 6.2726806640625},
    {10.521484375, 0.0, 0.0,
     0.22559820265997024, 0.24457978360615082, 0.07224339373102241, -0.5405718504844527,
     923.249755859375, 0.044993430376052856, 28.43115234375,
     -2.304882812499997, -0.0538330078125, 7.616430664062499},
    {9.0380859375, 0.0, 0.0,
     0.0, 0.5587039000496032, 0.8178338913690475, 2.6672247023809526,
     2.2818603515625, 0.044993430376052856, 17.1121826171875,
     -2.800048828125, -0.048509836196899414, 1.0539874076843265},
    {11.6650390625, 0.0, 0.0,
     0.2693360413823809, 0.00244140625, 0.7202845982142857, 0.5372273886487597,
     0.99560546875, 0.04690554738044739, 44.8564453125,
     -1.4896484375, -0.020179644227027893, 4.632055664062499},
    {17.951171875, 0.0, 0.0,
     0.3384958031063988, 0.2545269097222222, -9.469285955133929, 1.8030133928571428,
     279.794677734375, 0.051002293825149536, 19.943359375,
     -1.8034423828124986, -0.12567138671875, 5.7101806640625},
    {14.4306640625, 0.0, 0.0,
     0.0, 0.6580630270337302, 3.5151907591592697, 0.47567894345238093,
     1.27392578125, 0.044993430376052856, 23.4725341796875,
     -1.908903217315674, -0.07398223876953125, 2.2727604001760486},
    {14.27734375, 0.0, 0.0,
     0.26199840727306545, 0.1543594990079365, 0.12965029761904762, -2.2392113095238093,
     967.622802734375, 0.0429452508687973, 22.8720703125,
     -1.8538574218749986, -0.083160400390625, 6.2726806640625},
    {7.357143327593803, 0.0, 0.0,
     0.27796925612858364, 0.0761181116104126, 1.107421875, 0.4043157373865446,
     79.1891860961914, 0.0332021564245224, 42.696229457855225,
     -1.7969741821289062, -0.04978790879249573, 3.405777165293694},
    {16.1875, 0.0, 0.0,
     0.3198946126302083, 0.2299733382936508, -10.10023833608631, 1.4131324404761905,
     3.013427734375, 0.044993430376052856, 20.130859375,
     -1.3503173828124986, -0.10223388671875, 10.9914306640625},
}};
constexpr std::array<NeuronRow, 4> PC_rows = {{
    {27.50213623046875, 0.0, 0.0,
     -257.79678911169367, -185.6558443855175, 1455.1497846354166, 592.888733969869,
     10.196911334991455, 0.0499999925494194, 8.962864220142365,
     -11.321471893787383, -0.5863523483276367, 6.220311934432983},
    {36.996826171875, 0.0, 0.0,
     -35.39813110704223, -22.65387249772037, 157.5796183803252, 174.77248278118313,
     4.882041722536087, 0.0499999925494194, 4.557584926486015,
     -4.5480041742324815, -0.9200621098279953, 3.5259496516799924},
    {34.4921875, 0.0, 0.0,
     -10.02273802522215, 0.42768528444781173, 18.534118547148648, 27.073339950470697,
     7.5830078125, 0.04131823629140854, 6.657888576388359,
     -6.2153930902481065, -0.4205046147108078, 6.775949651679992},
    {30.25, 0.0, 0.0,
     -16.097870690375565, -49.80729511676799, 110.51101718984899, 277.7479292097546,
     5.665244847536087, 0.0499999925494194, 4.733122035861015,
     -6.1505432367324815, -0.2100401371717453, 3.6196996516799924},
}};
// clang-format on

constexpr std::array<std::span<const NeuronRow>, receptor_classes.size()> all_rows = {
    SA1_rows, RA_rows, PC_rows};
static_assert(std::ranges::equal(
    all_rows, receptor_classes, {}, [](const auto& rows) { return rows.size(); },
    &ReceptorClass::neurons));

} // namespace

double depth_mm(AfferentClass kind) {
    return 1e3 * properties(kind).depth_m;
}

std::span<const NeuronRow> neuron_rows(AfferentClass kind) {
    return all_rows[static_cast<std::size_t>(kind)];
}

} // namespace shearwake::neural
