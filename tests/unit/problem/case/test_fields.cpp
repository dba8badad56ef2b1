// SPDX-License-Identifier: BSD-3-Clause
// The descriptions of option structs: nothing of a struct may be missing, everything decides the
// id.
#include "base/field.hpp"
#include "problem/case/case_fields.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

namespace test_fields {

using namespace shearwake;

static std::string name_of(const Field& field) {
    return std::string(field.key) + "/" + field.text;
}

/// A walk that changes the n-th field that it visits.
class Change {
public:
    explicit Change(int number) : left_(number) {}

    template <class T>
    void operator()(T& value, const Field& field) {
        if (!field.applies || field.zero_in_text) return;
        const bool was_done = is_done_;
        change(value);
        if (is_done_ && !was_done) what_ = name_of(field);
    }
    template <class... T>
    void choice(std::variant<T...>& value, const Field& field, const auto&... then) {
        (then(*this), ...);
        if (!is_turn()) return std::visit([&](auto& a) { walk_fields(*this, a); }, value);
        const std::size_t next = (value.index() + 1) % sizeof...(T);
        std::size_t i = 0;
        ((i++ == next ? void(value = Example<T>::make()) : void()), ...);
        what_ = name_of(field);
    }
    template <class T>
    void each(const char* table, std::vector<T>& list, const Field& field) {
        if (is_turn()) {
            what_ = table;
            list.push_back(list.empty() ? Example<T>::make() : list.front());
            return;
        }
        for (T& element : list)
            if constexpr (requires { element.valueless_by_exception(); })
                choice(element, field);
            else
                walk_fields(*this, element);
    }
    template <class T>
    void maybe(const char* table, std::optional<T>& value) {
        if (is_turn()) {
            what_ = table;
            value = value ? std::nullopt : std::optional(Example<T>::make());
        } else if (value) {
            walk_fields(*this, *value);
        }
    }
    void section(const char*) {}
    void key(const Field&) {}
    void key(const auto&, const Field&) {}

    bool is_done() const { return is_done_; }
    const std::string& what() const { return what_; }

private:
    bool is_turn() {
        if (left_-- != 0) return false;
        is_done_ = true;
        return true;
    }
    // By the least that a number can change.
    void change(double& value) {
        if (is_turn()) value = value == 0.0 ? 1e-3 : std::nextafter(value, 1e300);
    }
    void change(std::integral auto& value) {
        if (is_turn()) ++value;
    }
    void change(bool& value) {
        if (is_turn()) value = !value;
    }
    void change(std::string& value) {
        if (is_turn()) value += "x";
    }
    template <class E>
    requires std::is_enum_v<E>
    void change(E& value) {
        if constexpr (Named<E>) {
            const auto count = names_of(std::type_identity<E>{}).size();
            if (is_turn()) value = static_cast<E>((static_cast<std::size_t>(value) + 1) % count);
        } else {
            static_assert(std::is_same_v<E, Switch>);
            if (is_turn()) value = value == Switch::on ? Switch::off : Switch::on;
        }
    }
    void change(Vec2& value) {
        change(value.x);
        change(value.y);
    }
    void change(Vec3& value) {
        change(value.x);
        change(value.y);
        change(value.z);
    }
    void change(FrequencyBand& band) {
        change(band.low_Hz);
        change(band.high_Hz);
    }
    void change(ListedAfferent& one) {
        change(one.at_m);
        change(one.kind);
        change(one.row);
    }
    template <class T>
    void change(std::optional<T>& value) {
        if (value)
            change(*value);
        else if (is_turn())
            value = T{};
    }
    template <class T>
    void change(std::vector<T>& values) {
        for (T& value : values)
            change(value);
        if (is_turn()) values.push_back(values.empty() ? T{} : values.back());
    }
    template <class T>
    void change(std::shared_ptr<const T>& file) {
        if (!is_turn()) return;
        T other;
        other.content_hash = file ? file->content_hash + "x" : "other";
        file = std::make_shared<const T>(other);
    }

    int left_;
    bool is_done_ = false;
    std::string what_;
};

/// A walk over every alternative of everything: what there is to change.
class Everything {
public:
    template <class T>
    void operator()(T&, const Field& field) {
        all.insert(name_of(field));
    }
    template <class... T>
    void choice(const std::variant<T...>&, const Field&, const auto&...) {
        for_each_alternative(std::type_identity<std::variant<T...>>{},
                             [&](auto alternative) { walk_fields(*this, alternative); });
    }
    template <class T>
    void each(const char*, const std::vector<T>&, const Field& field) {
        T example = Example<T>::make();
        if constexpr (requires { example.valueless_by_exception(); })
            choice(example, field);
        else
            walk_fields(*this, example);
    }
    template <class T>
    void maybe(const char*, const std::optional<T>&) {
        T example = Example<T>::make();
        walk_fields(*this, example);
    }
    void section(const char*) {}
    void key(const Field&) {}
    void key(const auto&, const Field&) {}

    std::set<std::string> all;
};

static Layer layer(const ShearLoss& loss) {
    return {"tissue", 0.02, 1000.0, 1500.0, 5.0, loss};
}

static Travel travel(const Curve& path, const Motion& motion) {
    return {.path = path, .motion = motion};
}

static std::vector<Vec2> spiral(int points) {
    std::vector<Vec2> all;
    for (int n = 0; n < points; ++n)
        all.push_back({1e-3 * n * std::cos(n), 1e-3 * n * std::sin(n)});
    return all;
}

/// Between them, these hold every alternative.
static std::vector<Case> samples() {
    Case first;
    first.scene.medium = {
        .layers = {layer(Lossless{}), layer(KelvinVoigt{1.0}),
                   layer(FractionalKelvinVoigt{1e-4, 0.3}), layer(StandardLinearSolid{1e-4, 0.5})},
        .bodies = {{.name = "a", .shape = Ellipsoid{{1e-3, 2e-3, 3e-3}}},
                   {.name = "b", .shape = Cylinder{1e-3, 5e-3, 30.0}},
                   {.name = "c", .shape = Box{{1e-3, 1e-3, 1e-3}}, .rigid = true}}};
    first.scene.load.peak_Pa = 100.0;
    first.scene.load.footprint = ArrayFootprint{};
    first.scene.load.carrier = ResolvedCarrier{};
    first.scene.load.modulation = {
        .kind = "custom",
        .trajectory = {{Hold{}, Swing{.amplitude_m = {1e-3, 0.0}, .frequency_Hz = 100.0},
                        travel(Line{{}, {0.1, 0.0}}, ConstantSpeed{7.0}),
                        travel(Arc{{}, 0.01, 0.0, 1.0}, OscillatingSpeed{7.0, 1.0, 200.0}),
                        travel(Example<Lissajous>::make(), ConstantSpeed{1.0}),
                        travel(Polyline(spiral(4), Ends::closed), ConstantSpeed{1.0}),
                        travel(Polyline(spiral(4), Ends::open),
                               Rests{{0.0, 1e-3}, {1e-3, 2e-3}, {0.5, 1.0}})}},
        .envelope = {{SineGain{200.0}, RampGain{0.01}, RampGain{0.01, 0.0, 0.2}, SquareGain{20.0},
                      WindowGain{0.0, 0.1}, SampledGain{.values = {0.5, 1.0}, .interval_s = 1e-3}}},
        .foci_m = {{1e-3, 0.0}, {-1e-3, 0.0}}};
    first.domain = {.nx = 256, .ny = 180, .spacing_m = 0.00075};
    first.time = {.frames = 280, .interval_s = 5e-5};
    first.measure = {.at_s = 0.014, .settled_after_s = 0.004, .focal_radius_m = 0.003};
    first.measure.bands = {{100.0, 500.0}};
    first.record = {.traces_m = {{}},
                    .snapshots_s = {0.007},
                    .volumes_s = {0.007},
                    .volume_fields = {VolumeField::u}};
    first.solver = PstdOptions{.top = PstdTop::fluid, .load = PstdLoad::displacement};
    first.afferents = AfferentOptions{.places = AfferentList{{{{1e-3, 0.0}, AfferentClass::RA, 3}}},
                                      .input = CarrierInput{}};
    first.vibrometer = VibrometerOptions{.points_m = {{1e-3, 0.0}}};
    first.sensation = SensationOptions{.threshold = {{100.0, 0.02}}, .line_m = {{}, {1e-3, 0.0}}};
    Case second = first;
    second.scene.load.footprint = GaussianFootprint{0.003};
    second.scene.load.carrier = AveragedCarrier{};
    second.scene.load.modulation.trajectory.parts = {
        travel(Polyline(spiral(101), Ends::open), ConstantSpeed{1.0}),
        travel(Polyline(spiral(101), Ends::open),
               Rests{std::vector(101, 1e-3), std::vector(101, 1e-3), std::vector(101, 0.5)})};
    second.scene.load.modulation.foci_m = {};
    second.record.volumes_s = {};
    second.record.volume_fields = {};
    second.measure.bands = {};
    second.solver = SpectralOptions{};
    second.afferents = AfferentOptions{.places = GridAfferents{{0.01, 0.01}, 1e-3}};
    Case third = second;
    third.solver = LayeredOptions{};
    third.afferents =
        AfferentOptions{.places = HandAfferents{"fingertip", 2}, .input = StressInput{}};
    Case fourth = third;
    fourth.solver = PstdOptions{.load = PstdLoad::velocity, .device = PstdDevice::gpu};
    fourth.afferents.reset();
    LensFootprint lens;
    lens.foci_m = {{1e-3, 0.0}};
    lens.polygon_m = {{0.0, 0.0}, {1e-3, 0.0}, {0.0, 1e-3}};
    lens.image = std::make_shared<const TargetImage>();
    fourth.scene.load.footprint = lens;
    return {first, second, third, fourth};
}

TEST_CASE("every field of every option struct decides the id of a case", "[fields][case]") {
    std::set<std::string> changed;
    for (const Case& sample : samples()) {
        const std::string id = case_id(sample);
        for (int n = 0;; ++n) {
            Case other = sample;
            Change change(n);
            walk_fields(change, other);
            if (!change.is_done()) break;
            INFO(change.what());
            CHECK(case_id(other) != id);
            CHECK_FALSE(other == sample);
            changed.insert(change.what());
        }
    }
    Everything everything;
    Case defaults;
    walk_fields(everything, defaults);
    for (const std::string& name : everything.all) {
        INFO(name);
        CHECK(changed.count(name) == 1);
    }
}

TEST_CASE("an id is never a number for programs that read tables", "[fields]") {
    for (const char* number : {"68169e2466327440", "0012345678901234", "1234567890123456"}) {
        const std::string id = avoid_numeric_id(number);
        INFO(id);
        CHECK(id.size() == 16);
        CHECK(std::isalpha(static_cast<unsigned char>(id.front())) != 0);
        CHECK(id.substr(1) == std::string(number).substr(1));
    }
    for (const char* id : {"0c563b767c5d4791", "e123456789012345", "12e456e890123456"})
        CHECK(avoid_numeric_id(id) == id);
}

} // namespace test_fields
