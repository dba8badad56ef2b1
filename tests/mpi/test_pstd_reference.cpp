#include "engines/pstd/recording.hpp"
#include "io/h5.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>

using namespace shearwake;
using namespace shearwake::pstd;

namespace {

// Fields that k-Wave's pstdElastic3D computed (GNU Octave, double precision): 48 x 40 x 32 nodes of
// 1 mm, c_p 20 m/s, c_s 5 m/s, 1000 kg/m^3; a Gaussian plane source of u_z with Ricker's pulse at
// z index 13. Traces of nine fields at five points, and the xz plane y = 18 after the last step.
constexpr std::ptrdiff_t nx = 48, ny = 40, nz = 32, steps = 400, source_z = 13, plane_y = 18;

struct Reference {
    std::vector<double> traces; // [point][step][field]
    std::vector<double> plane;  // [field][x][z], single precision
    std::vector<Node> points;
    std::vector<double> pattern, series; // of the source, without its amplitude
};

Reference read(const std::string& name) {
    const auto file = h5::open_file(TEST_DATA "/pstd/" + name + ".h5", h5::Access::read);
    const auto values = [&](const char* of) {
        return h5::read_all(h5::open_dataset(file.raw(), of));
    };
    Reference r{
        values("traces"), values("snapshot_xz"), {}, values("source_G"), values("source_R")};
    const auto points = values("points_ijk0");
    for (std::size_t i = 0; i < points.size(); i += 3)
        r.points.push_back(
            {std::lround(points[i]), std::lround(points[i + 1]), std::lround(points[i + 2])});
    return r;
}

Setup setup_of(const Reference& reference, SourceMode mode, double pml_strength) {
    Setup s;
    s.grid = {{nx, ny, nz}, {1e-3, 1e-3, 1e-3}, 1e-5};
    s.pml.strength_1 = {pml_strength, pml_strength, pml_strength};
    s.material = [](Node) { return NodeMaterial{1000.0, 20.0, 5.0}; };
    Source source{.field = Field::uz, .mode = mode};
    for (std::ptrdiff_t x = 0; x < nx; ++x)
        for (std::ptrdiff_t y = 0; y < ny; ++y)
            source.nodes.push_back({x, y, source_z});
    std::vector<double> pattern_m_s = reference.pattern;
    for (double& p : pattern_m_s)
        p *= 1e-3;
    s.sources.push_back(separable_source(source, pattern_m_s, reference.series));
    return s;
}

/// Largest difference of each field's traces and planes, over the largest value of the reference.
struct Differences {
    double traces = 0.0, planes = 0.0;
};

template <class Real>
Differences differences(const Reference& reference, const Setup& setup, const Comm& team) {
    Stepper<Real> stepper(setup, team);
    std::vector<double> largest(field_count, 0.0), apart(field_count, 0.0);
    for (std::ptrdiff_t n = 0; n < steps; ++n) {
        stepper.step();
        for (std::size_t f = 0; f < field_count; ++f) {
            const auto got =
                values_at<Real>(stepper, static_cast<Field>(f), reference.points, team);
            for (std::size_t p = 0; p < got.size(); ++p) {
                const double wanted =
                    reference.traces[(p * steps + static_cast<std::size_t>(n)) * field_count + f];
                largest[f] = std::max(largest[f], std::abs(wanted));
                apart[f] = test::worse(apart[f], std::abs(got[p] - wanted));
            }
        }
    }
    Differences d;
    for (std::size_t f = 0; f < field_count; ++f) {
        d.traces = test::worse(d.traces, apart[f] / largest[f]);
        const auto got =
            values_in<Real>(stepper, static_cast<Field>(f), {{0, plane_y, 0}, {nx, 1, nz}}, team);
        double scale = 0.0, worst = 0.0;
        for (std::size_t i = 0; i < got.size(); ++i) {
            const double wanted = reference.plane[f * got.size() + i];
            scale = std::max(scale, std::abs(wanted));
            worst = test::worse(worst, std::abs(got[i] - wanted));
        }
        d.planes = test::worse(d.planes, worst / scale);
    }
    return d;
}

struct Run {
    const char* name;
    SourceMode mode;
    double pml_strength;
};

} // namespace

TEST_CASE("pstd computes what k-Wave's pstdElastic3D computes, on any number of ranks",
          "[mpi][pstd]") {
    const Run run = GENERATE(Run{"a_additive_pml10", SourceMode::additive, 2.0},
                             Run{"a_additive_pmloff", SourceMode::additive, 0.0},
                             Run{"c_dirichlet_pml10", SourceMode::dirichlet, 2.0},
                             Run{"c_dirichlet_pmloff", SourceMode::dirichlet, 0.0});
    const Comm world = Comm::world();
    const Reference reference = read(run.name);
    const Setup setup = setup_of(reference, run.mode, run.pml_strength);
    const Differences d = differences<double>(reference, setup, world);
    INFO(run.name << ": traces " << d.traces << ", planes " << d.planes);
    CHECK(d.traces < 1e-12); // 400 steps of rounding: another program's are 3e-14 apart
    CHECK(d.planes < 1e-6);  // the planes were kept in single precision
}

TEST_CASE("pstd in single precision is k-Wave's field to its rounding", "[mpi][pstd]") {
    const Comm world = Comm::world();
    const Reference reference = read("c_dirichlet_pml10");
    const Setup setup = setup_of(reference, SourceMode::dirichlet, 2.0);
    const Differences d = differences<float>(reference, setup, world);
    INFO("traces " << d.traces << ", planes " << d.planes);
    CHECK(d.traces < 1e-4); // 6e-8 a step, 400 steps, largest stresses over smallest
    CHECK(d.planes < 1e-4);
}
