// SPDX-License-Identifier: BSD-3-Clause
#include "support/pstd_recording.hpp"
#include "support/pstd_reference.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

namespace test_pstd_reference {

using namespace shearwake;
using namespace shearwake::pstd;
using test::KwaveFile;
using test::KwaveRun;

namespace {

/// Largest differences from a reference and its largest values, for each field.
class Differences {
public:
    void add(std::size_t field, std::span<const double> got, std::span<const double> wanted) {
        for (std::size_t i = 0; i < got.size(); ++i) {
            largest_[field] = std::max(largest_[field], std::abs(wanted[i]));
            apart_[field] = test::worse(apart_[field], std::abs(got[i] - wanted[i]));
        }
    }
    /// Maximum over the fields of the difference relative to the largest value of the field.
    double worst() const {
        double all = 0.0;
        for (std::size_t f = 0; f < pstd::field_count; ++f)
            if (largest_[f] > 0.0) all = test::worse(all, apart_[f] / largest_[f]);
        return all;
    }

private:
    std::array<double, pstd::field_count> largest_{}, apart_{};
};

struct Compared {
    Differences traces, planes;
};

/// Traces of nine fields at five points, and the xz plane y = 18 after the last step.
template <class Real>
Compared against_small_copy(const KwaveRun& run, const Comm& team) {
    const KwaveFile file(std::string(TEST_DATA "/pstd/") + run.name + ".h5");
    const std::vector<double> traces = file.values("traces"), plane = file.values("snapshot_xz");
    const auto ijk = file.integers("points_ijk0");
    std::vector<pstd::Node> points;
    for (std::size_t i = 0; i < ijk.size(); i += 3)
        points.push_back({ijk[i], ijk[i + 1], ijk[i + 2]});
    pstd::Stepper<Real> stepper(test::kwave_setup(file, run), team);
    Compared c;
    for (std::size_t n = 0; n < test::kwave_steps; ++n) {
        stepper.step();
        for (std::size_t f = 0; f < pstd::field_count; ++f) {
            const auto got = values_at<Real>(stepper, static_cast<pstd::Field>(f), points, team);
            std::vector<double> wanted; // traces: [point][step][field]
            for (std::size_t p = 0; p < points.size(); ++p)
                wanted.push_back(traces[(p * test::kwave_steps + n) * pstd::field_count + f]);
            c.traces.add(f, got, wanted);
        }
    }
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const pstd::Box box{{0, 18, 0}, {test::kwave_nx, 1, test::kwave_nz}};
        const auto got = values_in<Real>(stepper, static_cast<pstd::Field>(f), box, team);
        c.planes.add(f, got, std::span(plane).subspan(f * got.size(), got.size()));
    }
    return c;
}

/// All fields in single precision of a file of the reference folder: nine in an xz plane and four
/// in an xy plane after ten steps, three complete ones after the last step.
template <class Real>
Differences against_snapshots(const KwaveFile& file, const KwaveRun& run, const Comm& team) {
    constexpr std::size_t of_xy[] = {0, 2, 5, 7}; // ux uz szz sxz
    const auto steps = file.integers("snap_steps");
    const std::vector<double> xz = file.values("snap_xz"), xy = file.values("snap_xy");
    pstd::Stepper<Real> stepper(test::kwave_setup(file, run), team);
    Differences d;
    const auto compare = [&](std::size_t f, const pstd::Box& box, const std::vector<double>& wanted,
                             std::size_t number) {
        const auto got = values_in<Real>(stepper, static_cast<pstd::Field>(f), box, team);
        d.add(f, got, std::span(wanted).subspan(number * got.size(), got.size()));
    };
    for (std::size_t s = 0; s < steps.size(); ++s) {
        while (stepper.steps() < steps[s])
            stepper.step();
        for (std::size_t f = 0; f < pstd::field_count; ++f)
            compare(f, {{0, 18, 0}, {test::kwave_nx, 1, test::kwave_nz}}, xz,
                    s * pstd::field_count + f);
        for (std::size_t i = 0; i < std::size(of_xy); ++i)
            compare(of_xy[i], {{0, 0, test::kwave_source_z}, {test::kwave_nx, test::kwave_ny, 1}},
                    xy, s * std::size(of_xy) + i);
    }
    while (stepper.steps() < test::kwave_steps)
        stepper.step();
    const pstd::Box all{{0, 0, 0}, {test::kwave_nx, test::kwave_ny, test::kwave_nz}};
    compare(pstd::index_of(pstd::Field::ux), all, file.values("final_ux"), 0);
    compare(pstd::index_of(pstd::Field::uz), all, file.values("final_uz"), 0);
    compare(pstd::index_of(pstd::Field::szz), all, file.values("final_szz"), 0);
    return d;
}

} // namespace

TEST_CASE("engine pstd reproduces k-Wave's pstdElastic3D on any number of ranks", "[mpi][pstd]") {
    const KwaveRun run = GENERATE(from_range(test::kwave_runs()));
    const Compared c = against_small_copy<double>(run, Comm::world());
    INFO(run.name << ": traces " << c.traces.worst() << ", planes " << c.planes.worst());
    // Rounding errors of 400 steps; another program differs by 3e-14.
    CHECK(c.traces.worst() < 1e-12);
    CHECK(c.planes.worst() < 1e-6); // the planes are stored in single precision
}

TEST_CASE("engine pstd in single precision reproduces k-Wave up to rounding", "[mpi][pstd]") {
    const KwaveRun run = GENERATE(from_range(test::kwave_runs()));
    const Compared c = against_small_copy<float>(run, Comm::world());
    INFO(run.name << ": traces " << c.traces.worst() << ", planes " << c.planes.worst());
    // 6e-8 per step, 400 steps, ratio of the largest to the smallest stresses.
    CHECK(c.traces.worst() < 1e-4);
    CHECK(c.planes.worst() < 1e-4);
}

// SHEARWAKE_PSTD_REFERENCE specifies the folder of the four complete files, without which this test
// is skipped. tests/data/pstd contains the small files.
TEST_CASE("engine pstd reproduces every stored field of k-Wave", "[mpi][pstd]") {
    const char* folder = std::getenv("SHEARWAKE_PSTD_REFERENCE");
    if (!folder || !*folder) {
        WARN("skipped: SHEARWAKE_PSTD_REFERENCE is not set");
        return;
    }
    const KwaveRun run = GENERATE(from_range(test::kwave_runs()));
    const KwaveFile file(std::string(folder) + "/shared_" + run.name + ".h5");
    const double in_double = against_snapshots<double>(file, run, Comm::world()).worst(),
                 in_single = against_snapshots<float>(file, run, Comm::world()).worst();
    INFO(run.name << ": double " << in_double << ", single " << in_single);
    CHECK(in_double < 1e-6); // stored in single precision
    CHECK(in_single < 1e-4); // the same bound as for the traces
}

} // namespace test_pstd_reference
