#include "fft/fftw_plan.hpp"
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

using namespace shearwake;

namespace {

/// SHEARWAKE_CACHE for as long as this lives.
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

/// One new cache folder for all ranks. Collective at both ends.
class NewCache {
public:
    NewCache() : cache_(Comm::world().broadcast((folder_ / "cache").string())) {}
    ~NewCache() { Comm::world().barrier(); }

private:
    test::TemporaryFolder folder_;
    CacheAt cache_;
};

/// A transform of one line that counts how it was planned.
struct CountedPlans {
    int measured = 0, recalled = 0, estimated = 0;
    FftwPlan plan;

    MakePlans maker(int length = 360) {
        return [this, length](unsigned flags) {
            if (flags & FFTW_ESTIMATE)
                ++estimated;
            else if (flags & FFTW_WISDOM_ONLY)
                ++recalled;
            else
                ++measured;
            AlignedVector<double> line(static_cast<std::size_t>(2 * length));
            auto* data = reinterpret_cast<fftw_complex*>(line.data());
            plan.reset(fftw_plan_dft_1d(length, data, data, FFTW_FORWARD, flags));
            return plan != nullptr;
        };
    }
};

std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

/// Spectrum and plane again of this rank's part, after both transforms.
AlignedVector<double> transformed(const SlabTransform& transform) {
    const SlabShare& share = transform.share();
    AlignedVector<double> plane(static_cast<std::size_t>(share.reals));
    for (std::ptrdiff_t i = 0; i < share.x_count * share.padded_ny; ++i)
        plane[static_cast<std::size_t>(i)] =
            std::sin(12.9898 * static_cast<double>(i + share.x_start * share.padded_ny));
    transform.to_spectral(plane.data());
    AlignedVector<double> both(plane.begin(), plane.begin() + 2 * share.ky_count * 384);
    transform.to_physical(plane.data());
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i) // without the padding
        both.insert(both.end(), plane.begin() + i * share.padded_ny,
                    plane.begin() + i * share.padded_ny + 320);
    return both;
}

bool everywhere(bool here) {
    return Comm::world().max(here ? 0 : 1) == 0;
}

} // namespace

TEST_CASE("a plan is measured once, by one rank, and then recalled", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    CountedPlans first, second;
    plan_measured(world, "line", first.maker());
    const std::string words = world.broadcast(content(*wisdom_file("line")));
    plan_measured(world, "line", second.maker());
    CHECK(world.sum(first.measured) == 1.0);
    CHECK(world.sum(second.measured) == 0.0);
    CHECK(world.sum(second.recalled) == world.size());
    CHECK(world.sum(first.estimated + second.estimated) == 0.0);
    CHECK(everywhere(content(*wisdom_file("line")) == words)); // nothing new was learnt
}

TEST_CASE("measured transforms give the same bits again, on any ranks", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    const AlignedVector<double> first =
        transformed(SlabTransform(384, 320, world, Planning::measured));
    const AlignedVector<double> second =
        transformed(SlabTransform(384, 320, world, Planning::measured));
    CHECK(everywhere(first == second));
    const SlabTransform alone(384, 320, world.split(world.rank()), Planning::measured);
    const AlignedVector<double> whole = transformed(alone);
    const SlabTransform team(384, 320, world, Planning::measured);
    const auto modes = static_cast<std::ptrdiff_t>(2 * team.share().ky_count * 384);
    CHECK(everywhere(std::equal(first.begin(), first.begin() + modes,
                                whole.begin() + 2 * team.share().ky_start * 384)));
}

TEST_CASE("estimated plans do not follow what was measured before", "[mpi]") {
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
    following.maker()(FFTW_ESTIMATE); // what FFTW itself does: the measured plan again
    plan_estimated(after.maker());
    CHECK(everywhere(text_of(following) == text_of(measured)));
    CHECK(everywhere(text_of(after) == text_of(before)));
}

TEST_CASE("no wisdom stays in the process", "[mpi]") {
    const auto planning = GENERATE(Planning::estimated, Planning::measured);
    const NewCache cache;
    const auto wisdom = [] {
        const std::unique_ptr<char, void (*)(void*)> text(fftw_export_wisdom_to_string(), free);
        return std::string(text.get());
    };
    // The first of all transforms makes FFTW's MPI part known, whose name stands in every wisdom.
    const SlabTransform first(16, 16, Comm::world(), Planning::estimated);
    fftw_forget_wisdom();
    const std::string none = wisdom();
    const SlabTransform transform(384, 320, Comm::world(), planning);
    CHECK(everywhere(wisdom() == none));
}

TEST_CASE("of two programs that learn at once the second takes the first one's plans", "[mpi]") {
    const Comm world = Comm::world();
    std::string theirs;
    {
        // Theirs knows a second length, so that it cannot be taken for ours.
        const NewCache cache;
        CountedPlans plans;
        plan_measured(world, "line", [&](unsigned flags) {
            return plans.maker(350)(flags) && plans.maker(360)(flags);
        });
        theirs = world.broadcast(content(*wisdom_file("line")));
    }
    const NewCache cache;
    CountedPlans ours;
    plan_measured(world, "line", [&](unsigned flags) {
        const bool made = ours.maker()(flags);
        if (!(flags & FFTW_WISDOM_ONLY)) write(*wisdom_file("line"), theirs); // they are done now
        return made;
    });
    CHECK(world.sum(ours.measured) == 1.0);
    CHECK(world.sum(ours.estimated) == 0.0);
    CHECK(everywhere(content(*wisdom_file("line")) == theirs));
}

TEST_CASE("without a cache plans are estimated, not measured", "[mpi]") {
    // /dev/null is no folder, not even for root.
    const CacheAt cache(GENERATE("off", "/dev/null/cache"));
    const Comm world = Comm::world();
    CountedPlans plans;
    plan_measured(world, "line", plans.maker());
    CHECK(world.sum(plans.measured) == 0.0);
    CHECK(world.sum(plans.estimated) == world.size());
    CHECK(everywhere(transformed(SlabTransform(384, 320, world, Planning::measured)) ==
                     transformed(SlabTransform(384, 320, world))));
}

TEST_CASE("a damaged file is replaced", "[mpi]") {
    const NewCache cache;
    const Comm world = Comm::world();
    CountedPlans first, second, third;
    plan_measured(world, "line", first.maker());
    const auto damage = GENERATE(0, 1, 2, 3, 4);
    if (world.is_root()) {
        std::string text = content(*wisdom_file("line"));
        const std::string senseless = "(fftw-3.3 nonsense\n";
        if (damage == 0) text = "";
        if (damage == 1) text.resize(text.size() / 2);
        if (damage == 2) text[text.size() / 2] ^= 1;
        if (damage == 3) text = std::string(5000, '\0');
        if (damage == 4) text = senseless;
        write(*wisdom_file("line"), text);
    }
    plan_measured(world, "line", second.maker());
    plan_measured(world, "line", third.maker());
    CHECK(world.sum(second.measured) == 1.0);
    CHECK(world.sum(third.measured) == 0.0);
    CHECK(world.sum(second.estimated + third.estimated) == 0.0);
}
