// SPDX-License-Identifier: BSD-3-Clause
// Volume snapshots from a fake engine via the recorder to the case file.
#include "base/error.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/files.hpp"
#include "support/cases.hpp"
#include "support/shared_folder.hpp"

#include <catch2/catch.hpp>

namespace test_volume {

using namespace shearwake;

const std::vector<double> levels_m = {0.0, 0.3e-3, 1e-3};

static Case small_case() {
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    c.domain = {4, 6, 1e-3, 0.0}; // the last of 5 ranks has no row
    c.time = {2, 1e-3};
    c.measure = {.at_s = 2e-3, .settled_after_s = 0.0, .focal_radius_m = 1e-3};
    c.record.volumes_s = {1e-3, 2e-3};
    c.record.volume_fields = {VolumeField::u, VolumeField::stress};
    return c;
}

static double value_at(const engines::VolumePlane& p, std::ptrdiff_t i, std::ptrdiff_t j) {
    return static_cast<double>(10000 * p.snapshot + 5000 * p.field + 500 * p.component +
                               100 * p.level) +
           static_cast<double>(10 * i + j);
}

/// Passes all planes of all volumes except the last `missing` ones to the observer.
static void run_fake_engine(const Case& c, const Comm& team, engines::Observer& observer,
                            int missing) {
    const std::ptrdiff_t each = (c.domain.nx + team.size() - 1) / team.size();
    const std::ptrdiff_t start = std::min(c.domain.nx, each * team.rank());
    const std::ptrdiff_t rows = std::min(c.domain.nx, start + each) - start;
    observer.begin({start, rows});
    observer.volume_levels(levels_m);
    std::vector<engines::VolumePlane> planes;
    for (std::size_t snapshot = 0; snapshot < c.record.volumes_s.size(); ++snapshot)
        for (std::size_t field = 0; field < c.record.volume_fields.size(); ++field)
            for (std::size_t k = 0; k < components_of(c.record.volume_fields[field]).size(); ++k)
                for (std::size_t level = 0; level < levels_m.size(); ++level)
                    planes.push_back({snapshot, field, k, level, {}});
    planes.resize(planes.size() - static_cast<std::size_t>(missing));
    std::vector<double> slab(static_cast<std::size_t>(rows * 8), -1.0); // padded rows
    for (engines::VolumePlane& plane : planes) {
        for (std::ptrdiff_t i = 0; i < rows; ++i)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
                slab[static_cast<std::size_t>(i * 8 + j)] = value_at(plane, start + i, j);
        plane.values = View2<const double>(slab.data(), rows, c.domain.ny, 8);
        observer.volume(plane);
    }
}

static bool holds_volumes(const std::filesystem::path& path, const Case& c) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    bool same = h5::dataset_names(h5::open_group(file.raw(), "volume").raw()).size() == 4 + 3 + 6;
    for (std::size_t field = 0; field < c.record.volume_fields.size(); ++field) {
        const VolumeField kind = c.record.volume_fields[field];
        const auto components = components_of(kind);
        for (std::size_t k = 0; k < components.size(); ++k) {
            const h5::Id dataset =
                h5::open_dataset(file.raw(), "volume/" + name_of(kind) + "_" + components[k]);
            same = same && h5::shape(dataset) == std::vector<hsize_t>{2, 3, 6, 4} &&
                   h5::text_attribute(dataset.raw(), "units") == units_of(kind);
            const std::vector<double> values = h5::read_all(dataset);
            for (std::size_t at = 0; same && at < values.size(); ++at) {
                const engines::VolumePlane plane{at / 72, field, k, at / 24 % 3, {}};
                same = values[at] == value_at(plane, static_cast<std::ptrdiff_t>(at % 4),
                                              static_cast<std::ptrdiff_t>(at / 4 % 6));
            }
        }
    }
    return same;
}

TEST_CASE("writes the slabs of all ranks as volumes with x as the fastest index", "[mpi]") {
    const Comm world = Comm::world();
    const test::SharedFolder folder(world);
    const Case c = small_case();
    {
        storage::CaseFileWriter writer(folder.file("a.h5"), world, {});
        pipeline::SurfaceRecorder recorder(c, world, {.writer = &writer});
        run_fake_engine(c, world, recorder, 0);
        recorder.finish();
        writer.commit({}, {{"status", std::string("complete")}});
    }
    bool fine = true;
    on_root(world, [&] { fine = holds_volumes(folder.file("a.h5"), c); });
    CHECK(world.max(fine ? 0 : 1) == 0);
}

TEST_CASE("fails the case if the engine does not complete its volumes", "[mpi]") {
    const Comm world = Comm::world();
    const test::SharedFolder folder(world);
    const Case c = small_case();
    storage::CaseFileWriter writer(folder.file("a.h5"), world, {});
    pipeline::SurfaceRecorder recorder(c, world, {.writer = &writer});
    run_fake_engine(c, world, recorder, 1);
    CHECK_THROWS_AS(recorder.finish(), CaseFailure);
}

TEST_CASE("resumes a volume in the unfinished file", "[mpi]") {
    const Comm world = Comm::world();
    const test::SharedFolder folder(world);
    const Case c = small_case();
    const auto path = folder.file("a.h5");
    std::string record;
    {
        storage::CaseFileWriter writer(path, world, {});
        pipeline::SurfaceRecorder recorder(c, world, {.writer = &writer});
        run_fake_engine(c, world, recorder, 20);
        writer.flush();
        record = writer.part_record();
        writer.leave_for_later();
    }
    std::string reason, without, flipped, unrecorded;
    on_root(world, [&] {
        reason = storage::part_error(path, record, {}, storage::HasVolume::yes);
        without = storage::part_error(path, record, {}, storage::HasVolume::no);
        unrecorded = storage::part_error(path, "", {}, storage::HasVolume::yes);
        const auto part = storage::part_path(path);
        const std::string sound = storage::read_file(part);
        std::string damaged = sound;
        damaged[40] = static_cast<char>(damaged[40] ^ 1); // in HDF5's own metadata
        storage::write_file(part, damaged);
        flipped = storage::part_error(path, record, {}, storage::HasVolume::yes);
        storage::write_file(part, sound);
    });
    CHECK(world.broadcast(reason) == "");
    CHECK(world.broadcast(flipped) == "is damaged (it does not match the checksum in the "
                                      "checkpoint)");
    CHECK(world.broadcast(unrecorded) == "has no checksum in the checkpoint");
    CHECK(world.broadcast(without) == "was left incomplete by an interrupted run");
    {
        storage::CaseFileWriter writer(path, world, {}, storage::Beginning::resume, record);
        pipeline::SurfaceRecorder recorder(c, world, {.writer = &writer});
        run_fake_engine(c, world, recorder, 0);
        writer.commit({}, {});
    }
    bool fine = true;
    on_root(world, [&] { fine = holds_volumes(path, c); });
    CHECK(world.max(fine ? 0 : 1) == 0);
}

} // namespace test_volume
