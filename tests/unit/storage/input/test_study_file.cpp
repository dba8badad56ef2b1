// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <map>

namespace test_study_file {

using namespace shearwake;

namespace {

struct Dataset {
    std::vector<hsize_t> shape;
    std::vector<double> values;
};

/// A study of 4 x 3 x 2 nodes, to be spoilt before it is written.
struct Draft {
    std::string schema = "shearwake grid study 1", field = "uz", mode = "additive",
                recorded = "uz sxx";
    double sources = 1.0, steps = 5.0, time_step_s = 1e-5, start = 1.0;
    std::map<std::string, Dataset> datasets = {
        {"grid/points", {{3}, {4, 3, 2}}},
        {"grid/spacing_m", {{3}, {1e-3, 1e-3, 2e-3}}},
        {"layer/points", {{3}, {1, 1, 0}}},
        {"layer/strength", {{3}, {2, 2, 2}}},
        {"medium/density_kg_m3", {{1}, {1000}}},
        {"medium/c_p_m_s", {{1}, {20}}},
        {"medium/c_s_m_s", {{4, 3, 2}, std::vector<double>(24, 5.0)}},
        {"source_0/nodes", {{2, 3}, {1, 1, 0, 3, 2, 1}}},
        {"source_0/weights", {{2}, {0.5, -0.5}}},
        {"source_0/rows", {{2}, {0, 1}}},
        {"source_0/series", {{2, 3}, {1, 2, 3, 4, 5, 6}}},
        {"sensor/nodes", {{1, 3}, {2, 1, 1}}},
    };
};

void write(const Draft& draft, const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::create);
    h5::put_attribute(file.raw(), "schema", draft.schema);
    h5::put_attribute(file.raw(), "sources", draft.sources);
    std::map<std::string, h5::Id> groups;
    for (const char* name : {"grid", "layer", "medium", "source_0", "sensor"})
        groups.emplace(name, h5::create_group(file.raw(), name));
    h5::put_attribute(groups["grid"].raw(), "steps", draft.steps);
    h5::put_attribute(groups["grid"].raw(), "time_step_s", draft.time_step_s);
    h5::put_attribute(groups["layer"].raw(), "ratio", 0.1);
    h5::put_attribute(groups["layer"].raw(), "speed_m_s", 0.0);
    h5::put_attribute(groups["source_0"].raw(), "field", draft.field);
    h5::put_attribute(groups["source_0"].raw(), "mode", draft.mode);
    h5::put_attribute(groups["sensor"].raw(), "fields", draft.recorded);
    h5::put_attribute(groups["sensor"].raw(), "start", draft.start);
    for (const auto& [name, dataset] : draft.datasets)
        h5::write_all(h5::create_dataset(file.raw(), name, dataset.shape), dataset.values);
}

StudyData read(const Draft& draft) {
    const test::TemporaryFolder folder;
    write(draft, folder / "study.h5");
    return storage::read_study_file(folder / "study.h5");
}

} // namespace

TEST_CASE("a grid study has the content of its file", "[study]") {
    const StudyData study = read({});
    CHECK(study.points == std::array<std::ptrdiff_t, 3>{4, 3, 2});
    CHECK(study.spacing_m[2] == 2e-3);
    CHECK(study.c_s_m_s.size() == 24);
    CHECK_FALSE(study.lossy());
    REQUIRE(study.sources.size() == 1);
    CHECK(std::string(grid_fields[study.sources[0].field]) == "uz");
    CHECK(study.sources[0].nodes[1] == std::array<std::ptrdiff_t, 3>{3, 2, 1});
    CHECK(study.sources[0].samples == 3);
    CHECK(study.sensor_fields.size() == 2);
}

TEST_CASE("studies with equal content are equal", "[study]") {
    const StudyData study = read({}), again = read({});
    CHECK(study == again); // two files
    CHECK(unpacked(packed(study)) == study);
    CHECK(unpacked(packed(study)).sources == study.sources);
    Draft other;
    other.datasets["source_0/weights"].values[1] = 0.5;
    CHECK_FALSE(read(other) == study);
}

TEST_CASE("errors in a grid study are reported", "[study]") {
    struct Spoilt {
        std::function<void(Draft&)> change;
        const char* words;
    };
    const auto set = [](const char* name, std::size_t at, double value) {
        return [=](Draft& d) { d.datasets[name].values[at] = value; };
    };
    const Spoilt spoilt = GENERATE_COPY(
        Spoilt{[](Draft& d) { d.schema = "other"; }, "scripts/import-kwave"},
        Spoilt{set("grid/points", 0, 4.5), "not a whole number"},
        Spoilt{set("layer/points", 0, 3),
               "of 3 points on both sides does not fit into 4 points along x"},
        Spoilt{set("medium/c_s_m_s", 3, -1), "medium.sound_speed_shear"},
        Spoilt{set("medium/c_s_m_s", 3, 1e4),
               "shear waves must be slower than compressional waves"},
        Spoilt{set("medium/density_kg_m3", 0, -5),
               "is -5 somewhere, but must be at least 1e-09 (in "
               "k-Wave: medium.density)"},
        Spoilt{set("medium/c_p_m_s", 0, std::nan("")), "not finite"},
        Spoilt{[](Draft& d) {
                   d.datasets["medium/c_p_m_s"] = {{2}, {1, 2}};
               },
               "24 nodes"},
        Spoilt{set("source_0/nodes", 2, 2), "a node at 2 along z, which has 2 points"},
        Spoilt{set("source_0/rows", 0, 2), "contains 2, but there are 2 rows"},
        Spoilt{[](Draft& d) {
                   d.datasets["source_0/nodes"] = {{2, 3}, {1, 1, 0, 1, 1, 0}};
               },
               "a node twice"},
        Spoilt{[](Draft& d) {
                   d.datasets["source_0/weights"] = {{1}, {1}};
               },
               "2 nodes"},
        Spoilt{[](Draft& d) { d.field = "uw"; }, "\"uw\""},
        Spoilt{[](Draft& d) { d.mode = "soft"; }, "additive or dirichlet"},
        Spoilt{[](Draft& d) { d.recorded = "p_mean"; }, "\"p_mean\""},
        Spoilt{[](Draft& d) {
                   d.datasets["sensor/weights"] = {{1, 5}, {1, 0, 0, 0, 0}};
               },
               "a weight for each of the nodes"},
        Spoilt{[](Draft& d) { d.start = 9.0; }, "between 1 and 5"},
        Spoilt{[](Draft& d) { d.steps = 0.0; }, "steps is 0"},
        Spoilt{[](Draft& d) { d.sources = 2.0; }, "source_1"},
        Spoilt{[](Draft& d) { d.datasets.erase("sensor/nodes"); }, "nodes"});
    Draft draft;
    spoilt.change(draft);
    std::string said;
    try {
        read(draft);
    } catch (const UsageError& error) {
        said = error.what();
    }
    INFO(said);
    CHECK(said.find(spoilt.words) != std::string::npos);
}

} // namespace test_study_file
