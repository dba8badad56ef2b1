// A field that blows up ends the case on all ranks together, with the step and a hint.
#include "base/error.hpp"
#include "engines/spectral/stepper.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace shearwake;

namespace {

/// A state in this rank's memory.
class Memory : public StateWriter, public StateReader {
public:
    void put(const std::string& name, const StateRows& rows, const double* values) override {
        rows_[name].assign(values, values + rows.count * rows.row_length);
    }
    void put(const std::string& name, double value) override { numbers_[name] = value; }
    void get(const std::string& name, const StateRows&, double* values) override {
        std::copy(rows_.at(name).begin(), rows_.at(name).end(), values);
    }
    double get(const std::string& name) override { return numbers_.at(name); }
    std::vector<double>& rows(const std::string& name) { return rows_.at(name); }

private:
    std::map<std::string, std::vector<double>> rows_;
    std::map<std::string, double> numbers_;
};

Case small_case(bool body) {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    c.medium.base = Base::rigid;
    c.medium.layers[0].thickness_m = 8e-3;
    if (body)
        c.medium.bodies = {{.name = "body",
                            .shape = Ellipsoid{{5e-3, 4e-3, 2e-3}},
                            .centre_m = {1e-3, 2e-3, 4e-3},
                            .density_kg_m3 = 1300.0}};
    c.domain = {24, 18, 1.5e-3, 0.0};
    c.time = {100, 100e-6};
    c.solver = SpectralOptions{.time_step_s = 100e-6};
    return c;
}

/// What the run says that goes on for 40 steps from a state that `spoil` has changed.
template <class Spoil>
std::string failure(const Case& c, const Spoil& spoil) {
    const Comm world = Comm::world();
    const SlabTransform slabs(c.domain.nx, c.domain.ny, world);
    const DepthMesh mesh = choose_mesh(c, std::get<SpectralOptions>(c.solver));
    Stepper stepper(c, mesh, slabs, 100e-6, world);
    for (int i = 0; i < 20; ++i)
        stepper.advance();
    Memory state;
    stepper.save(state);
    spoil(state);
    stepper.restore(state);
    try {
        for (int i = 0; i < 40; ++i)
            stepper.advance();
    } catch (const FieldDiverges& failure) {
        return failure.what();
    }
    return "no failure";
}

/// On how many ranks the failure says all that.
int ranks_that_say(const std::string& said, std::initializer_list<const char*> words) {
    double found = 1.0;
    for (const char* word : words)
        if (said.find(word) == std::string::npos) found = 0.0;
    return static_cast<int>(Comm::world().sum(found));
}

} // namespace

TEST_CASE("a number that is none on one rank fails on all of them", "[mpi]") {
    const bool body = GENERATE(false, true);
    const int bad_rank = Comm::world().size() - 1;
    const std::string said = failure(small_case(body), [&](Memory& state) {
        // kx = 0 of the first row: a wave vector that every rank with rows has.
        if (Comm::world().rank() == bad_rank && !state.rows("now").empty())
            state.rows("now")[1] = std::numeric_limits<double>::quiet_NaN();
    });
    CAPTURE(body, said);
    CHECK(ranks_that_say(said, {"step ", " ms: the field is not finite", "time_step_us",
                                "contrast_cap", "residual"}) == Comm::world().size());
}

TEST_CASE("a field that moves with more than the load's work fails", "[mpi]") {
    const bool body = GENERATE(false, true);
    const std::string said = failure(small_case(body), [&](Memory& state) {
        for (double& u : state.rows("now"))
            u *= 100.0;
    });
    CAPTURE(body, said);
    CHECK(ranks_that_say(said, {"step ", " ms: the field diverges: it moves with", "time_step_us",
                                "contrast_cap"}) == Comm::world().size());
}

TEST_CASE("a sound run is left alone", "[mpi]") {
    const bool body = GENERATE(false, true);
    CHECK(failure(small_case(body), [](Memory&) {}) == "no failure");
}
