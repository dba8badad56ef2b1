// SPDX-License-Identifier: BSD-3-Clause
#include "fft/fftw_real.hpp"
#include "fft/slab_transform.hpp"
#include "fft/wisdom.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <fftw3.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

namespace test_wisdom {

using namespace shearwake;

/// Sets SHEARWAKE_CACHE during its lifetime.
class CacheAt {
public:
    explicit CacheAt(const std::string& place) {
        if (const char* was = std::getenv("SHEARWAKE_CACHE")) before_ = was;
        ::setenv("SHEARWAKE_CACHE", place.c_str(), 1);
    }
    ~CacheAt() {
        if (before_) ::setenv("SHEARWAKE_CACHE", before_->c_str(), 1);
        if (!before_) ::unsetenv("SHEARWAKE_CACHE");
    }
    CacheAt(const CacheAt&) = delete;
    CacheAt& operator=(const CacheAt&) = delete;

private:
    std::optional<std::string> before_;
};

/// A new cache folder for all ranks. Construction and destruction are collective.
class NewCache {
public:
    NewCache() : cache_(Comm::world().broadcast((folder_ / "cache").string())) {}
    ~NewCache() { Comm::world().barrier(); }

private:
    test::TemporaryFolder folder_;
    CacheAt cache_;
};

/// A transform of one line that counts how often and how it was planned.
struct CountedPlans {
    int measured = 0, loaded = 0, estimated = 0;
    fft::FftwPlan plan;

    fft::MakePlans maker(int length = 360) {
        return [this, length](unsigned flags) {
            if (flags & FFTW_ESTIMATE)
                ++estimated;
            else if (flags & FFTW_WISDOM_ONLY)
                ++loaded;
            else
                ++measured;
            fft::AlignedVector<double> line(static_cast<std::size_t>(2 * length));
            auto* data = reinterpret_cast<fftw_complex*>(line.data());
            plan.reset(fftw_plan_dft_1d(length, data, data, FFTW_FORWARD, flags));
            return plan != nullptr;
        };
    }
};

static std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

static void write(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

/// Spectrum and plane of this rank after both transforms.
static fft::AlignedVector<double> transformed(const fft::SlabTransform& transform) {
    const fft::SlabShare& share = transform.share();
    fft::AlignedVector<double> plane(static_cast<std::size_t>(share.reals));
    for (std::ptrdiff_t i = 0; i < share.x_count * share.padded_ny; ++i)
        plane[static_cast<std::size_t>(i)] =
            std::sin(12.9898 * static_cast<double>(i + share.x_start * share.padded_ny));
    transform.to_spectral(plane.data());
    fft::AlignedVector<double> both(plane.begin(), plane.begin() + 2 * share.ky_count * 384);
    transform.to_physical(plane.data());
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i) // without the padding
        both.insert(both.end(), plane.begin() + i * share.padded_ny,
                    plane.begin() + i * share.padded_ny + 320);
    return both;
}

static bool everywhere(bool here) {
    return Comm::world().max(here ? 0 : 1) == 0;
}

TEST_CASE("measures a plan once on one rank and reuses it", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    CountedPlans first, second;
    fft::plan_measured(world, "line", first.maker());
    const std::string words = world.broadcast(content(*fft::wisdom_file("line")));
    fft::plan_measured(world, "line", second.maker());
    CHECK(world.sum(first.measured) == 1.0);
    CHECK(world.sum(second.measured) == 0.0);
    CHECK(world.sum(second.loaded) == world.size());
    CHECK(world.sum(first.estimated + second.estimated) == 0.0);
    CHECK(everywhere(content(*fft::wisdom_file("line")) == words)); // nothing was measured again
}

TEST_CASE("measured transforms reproduce the same bits on all ranks", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    const fft::AlignedVector<double> first =
        transformed(fft::SlabTransform(384, 320, world, fft::Planning::measured));
    const fft::AlignedVector<double> second =
        transformed(fft::SlabTransform(384, 320, world, fft::Planning::measured));
    CHECK(everywhere(first == second));
    const fft::SlabTransform alone(384, 320, world.split(world.rank()), fft::Planning::measured);
    const fft::AlignedVector<double> whole = transformed(alone);
    const fft::SlabTransform team(384, 320, world, fft::Planning::measured);
    const auto modes = static_cast<std::ptrdiff_t>(2 * team.share().ky_count * 384);
    CHECK(everywhere(std::equal(first.begin(), first.begin() + modes,
                                whole.begin() + 2 * team.share().ky_start * 384)));
}

TEST_CASE("estimated plans ignore earlier measurements", "[mpi]") {
    const Comm world = Comm::world();
    const auto text_of = [](const CountedPlans& plans) {
        const std::unique_ptr<char, void (*)(void*)> text(fftw_sprint_plan(plans.plan.get()), free);
        return std::string(text.get());
    };
    CountedPlans before, measured, following, after;
    fftw_forget_wisdom();
    before.maker()(FFTW_ESTIMATE);
    fftw_forget_wisdom();
    measured.maker()(FFTW_MEASURE);
    following.maker()(FFTW_ESTIMATE); // FFTW itself would use the measured plan
    fft::plan_estimated(after.maker());
    CHECK(everywhere(text_of(following) == text_of(measured)));
    CHECK(everywhere(text_of(after) == text_of(before)));
}

TEST_CASE("leaves no wisdom in the process", "[mpi]") {
    const auto planning = GENERATE(fft::Planning::estimated, fft::Planning::measured);
    const NewCache cache;
    const auto wisdom = [] {
        const std::unique_ptr<char, void (*)(void*)> text(fftw_export_wisdom_to_string(), free);
        return std::string(text.get());
    };
    // The first transform registers the MPI part of FFTW, whose name is contained in all wisdom.
    const fft::SlabTransform first(16, 16, Comm::world(), fft::Planning::estimated);
    fftw_forget_wisdom();
    const std::string none = wisdom();
    const fft::SlabTransform transform(384, 320, Comm::world(), planning);
    CHECK(everywhere(wisdom() == none));
}

TEST_CASE("of two programs measuring at the same time the second uses the plans of the first",
          "[mpi]") {
    const Comm world = Comm::world();
    std::string theirs;
    {
        // Their file contains another length, so that it differs from ours.
        const NewCache cache;
        CountedPlans plans;
        fft::plan_measured(world, "line", [&](unsigned flags) {
            return plans.maker(350)(flags) && plans.maker(360)(flags);
        });
        theirs = world.broadcast(content(*fft::wisdom_file("line")));
    }
    const NewCache cache;
    CountedPlans ours;
    fft::plan_measured(world, "line", [&](unsigned flags) {
        const bool made = ours.maker()(flags);
        if (!(flags & FFTW_WISDOM_ONLY))
            write(*fft::wisdom_file("line"), theirs); // the other program has finished
        return made;
    });
    CHECK(world.sum(ours.measured) == 1.0);
    CHECK(world.sum(ours.estimated) == 0.0);
    CHECK(everywhere(content(*fft::wisdom_file("line")) == theirs));
}

TEST_CASE("estimates plans if there is no cache", "[mpi]") {
    // /dev/null is not a folder, not even for root.
    const CacheAt cache(GENERATE("off", "/dev/null/cache"));
    const Comm world = Comm::world();
    CountedPlans plans;
    fft::plan_measured(world, "line", plans.maker());
    CHECK(world.sum(plans.measured) == 0.0);
    CHECK(world.sum(plans.estimated) == world.size());
    CHECK(everywhere(transformed(fft::SlabTransform(384, 320, world, fft::Planning::measured)) ==
                     transformed(fft::SlabTransform(384, 320, world))));
}

TEST_CASE("replaces a damaged file", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    CountedPlans first, second, third;
    fft::plan_measured(world, "line", first.maker());
    const auto damage = GENERATE(0, 1, 2, 3, 4);
    if (world.is_root()) {
        std::string text = content(*fft::wisdom_file("line"));
        const std::string invalid = "(fftw-3.3 nonsense\n";
        if (damage == 0) text = "";
        if (damage == 1) text.resize(text.size() / 2);
        if (damage == 2) text[text.size() / 2] ^= 1;
        if (damage == 3) text = std::string(5000, '\0');
        if (damage == 4) text = invalid;
        write(*fft::wisdom_file("line"), text);
    }
    fft::plan_measured(world, "line", second.maker());
    fft::plan_measured(world, "line", third.maker());
    CHECK(world.sum(second.measured) == 1.0);
    CHECK(world.sum(third.measured) == 0.0);
    CHECK(world.sum(second.estimated + third.estimated) == 0.0);
}

} // namespace test_wisdom
