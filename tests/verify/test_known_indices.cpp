// SPDX-License-Identifier: BSD-3-Clause
// Sobol indices of functions with known indices, computed by an engine like any other: the job is
// planned, its cases are computed into files, and the files are reduced to tables.
#include "base/csv.hpp"
#include "pipeline/run_case.hpp"
#include "reduce/reduce.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "support/known_models.hpp"
#include "support/temporary_folder.hpp"
#include "unit/config/jobs.hpp"

#include <cstdlib>
#include <limits>

namespace test_known_indices {

using namespace shearwake;

namespace {

/// 4096 is the sample size for which docs/how-to/uncertainty.md states an accuracy of 0.02. A
/// quarter of it reaches that accuracy for these two functions in a quarter of the time, and is the
/// default; SHEARWAKE_SOBOL_SAMPLES=4096 computes the documented size.
std::size_t sample_size() {
    const char* text = std::getenv("SHEARWAKE_SOBOL_SAMPLES");
    return text ? std::stoul(text) : 1024;
}

/// Four keys, each over a narrow range in which no check of a case objects.
std::string job_text() {
    std::string job(test::plain_job);
    for (const auto& [old, by] : {std::pair{"fwhm_mm = 3.0", "fwhm_mm = 4.5"},
                                  {"AM-STM", "STM"},
                                  {"am_frequency_Hz = 500.0\n", ""},
                                  {"[-14.0, 0.0], to_mm = [14.0", "[-1.0, 0.0], to_mm = [1.0"},
                                  {"[96.0, 64.0]", "[24.0, 24.0]"},
                                  {"spacing_mm = 0.75", "spacing_mm = 1.5"},
                                  {"duration_ms = 4.0", "duration_ms = 0.2"}})
        job = test::replaced(job, old, by);
    return job + R"([measure]
at_ms = 0.2
depths_mm = [0.0, 1.0]
[uncertain]
samples = {samples}
analysis = "sobol-indices"
"load.peak_Pa" = { distribution = "uniform", min = 100.0, max = 101.0 }
"medium.layer[1].c_s_m_s" = { distribution = "uniform", min = 5.0, max = 5.01 }
"medium.layer[1].thickness_mm" = { distribution = "uniform", min = 20.0, max = 20.1 }
"medium.layer[1].density_kg_m3" = { distribution = "uniform", min = 1000.0, max = 1001.0 }
exceedance = { peak_um = 21.0, "peak_um_z1mm" = 1.0 }
)";
}

/// The displacement of the central node in um is the Ishigami function plus 20 at the surface,
/// since displacements have no sign in peak_um, and the g-function at the second depth. All other
/// nodes rest, so that no wave at the edges makes readings invalid.
class ModelEngine : public engines::Solver {
public:
    engines::Resources resources(const Case&, int) const override { return {}; }
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints*) override {
        const Layer& layer = c.scene.medium.layers.front();
        const std::vector<double> u = {c.scene.load.peak_Pa - 100.0, 100.0 * (layer.c_s_m_s - 5.0),
                                       1e4 * (layer.thickness_m - 20e-3),
                                       layer.density_kg_m3 - 1000.0};
        const bool is_root = team.is_root();
        const std::ptrdiff_t rows = is_root ? c.domain.nx : 0;
        observer.begin({0, rows});
        for (std::ptrdiff_t frame = 0; frame < c.time.frames; ++frame)
            for (const std::size_t depth : {std::size_t{0}, std::size_t{1}}) {
                const double value = depth == 0 ? test::ishigami(u) + 20.0 : test::g_function(u);
                std::vector<double> plane(static_cast<std::size_t>(rows * c.domain.ny), 0.0);
                if (is_root)
                    plane[static_cast<std::size_t>((rows + 1) * c.domain.ny / 2)] = 1e-6 * value;
                observer.frame({frame, depth, {plane.data(), rows, c.domain.ny}});
            }
        observer.solved({});
    }
};

void compute(const Plan& plan, const std::filesystem::path& folder) {
    const Comm world = Comm::world();
    const storage::Journal journal(folder / "journal.jsonl");
    storage::make_directory(folder / "cases");
    storage::write_file(folder / "plan.json", storage::plan_text(plan));
    ModelEngine engine;
    for (const PlannedCase& planned : plan.cases) {
        pipeline::CaseCheckpoints checkpoints(folder / planned.id, {planned.id, ""}, {}, world,
                                              journal,
                                              {[] { return false; }, [](const std::string&) {}});
        pipeline::run_case(planned, {.memory_per_rank_B = std::numeric_limits<double>::infinity()},
                           engine, world, folder / "cases" / (planned.id + ".h5"), checkpoints,
                           [] {});
    }
}

} // namespace

TEST_CASE("an engine with known Sobol indices shows them after plan, run and reduce",
          "[long][sensitivity]") {
    const test::TemporaryFolder folder;
    std::string job = job_text();
    job.replace(job.find("{samples}"), std::string_view("{samples}").size(),
                std::to_string(sample_size()));
    const Plan plan = config::read_job(job, "known.toml").plan;
    REQUIRE(plan.cases.size() == sample_size() * 6);
    compute(plan, folder / "");
    const reduce::ReducedTables written = reduce::reduce(
        {.folder = folder / "", .plan = folder / "plan.json", .tables = folder / "tables"});
    CHECK(written.complete == plan.cases.size());
    const std::string text = storage::read_file(written.sensitivity);
    std::vector<std::vector<std::string>> rows;
    for (CsvReader reader(text); reader.next();)
        rows.push_back(reader.cells());
    std::size_t checked = 0;
    const auto check = [&](const std::string& column, std::size_t key, const std::string& index,
                           double exact) {
        for (const auto& row : rows) {
            if (row[0] != column || row[1] != plan.swept_keys[key] || row[2] != index) continue;
            const double value = std::stod(row[3]), low = std::stod(row[4]),
                         high = std::stod(row[5]);
            INFO(column << " " << plan.swept_keys[key] << " " << index << ": " << value << " in "
                        << low << ".." << high);
            CHECK(std::abs(value - exact) < 0.02); // the documented accuracy
            CHECK(low <= exact);
            CHECK(high >= exact);
            ++checked;
        }
    };
    const auto check_all = [&](const std::string& column,
                               const std::vector<test::KnownIndex>& known) {
        for (std::size_t k = 0; k < known.size(); ++k) {
            check(column, k, "first_order", known[k].first_order);
            check(column, k, "total", known[k].total);
        }
    };
    check_all("peak_um", test::ishigami_indices());
    check_all("peak_um_z1mm", test::g_indices());
    CHECK(checked == 14);
}

} // namespace test_known_indices
