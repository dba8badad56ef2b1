// SPDX-License-Identifier: BSD-3-Clause
// The description of an option struct contains all its members.
#include "base/field.hpp"
#include "problem/case/case_fields.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <set>
#include <tuple>
#include <typeinfo>

namespace test_described_members {

using namespace shearwake;

/// The members of an aggregate of N.
template <std::size_t N>
auto members(auto& s) {
    if constexpr (N == 1) {
        auto& [a] = s;
        return std::tie(a);
    } else if constexpr (N == 2) {
        auto& [a, b] = s;
        return std::tie(a, b);
    } else if constexpr (N == 3) {
        auto& [a, b, c] = s;
        return std::tie(a, b, c);
    } else if constexpr (N == 4) {
        auto& [a, b, c, d] = s;
        return std::tie(a, b, c, d);
    } else if constexpr (N == 5) {
        auto& [a, b, c, d, e] = s;
        return std::tie(a, b, c, d, e);
    } else if constexpr (N == 6) {
        auto& [a, b, c, d, e, f] = s;
        return std::tie(a, b, c, d, e, f);
    } else if constexpr (N == 7) {
        auto& [a, b, c, d, e, f, g] = s;
        return std::tie(a, b, c, d, e, f, g);
    } else if constexpr (N == 8) {
        auto& [a, b, c, d, e, f, g, h] = s;
        return std::tie(a, b, c, d, e, f, g, h);
    } else if constexpr (N == 9) {
        auto& [a, b, c, d, e, f, g, h, i] = s;
        return std::tie(a, b, c, d, e, f, g, h, i);
    } else if constexpr (N == 10) {
        auto& [a, b, c, d, e, f, g, h, i, j] = s;
        return std::tie(a, b, c, d, e, f, g, h, i, j);
    } else if constexpr (N == 12) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
        return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
    } else if constexpr (N == 13) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
        return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
    } else if constexpr (N == 14) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
        return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
    } else if constexpr (N == 16) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = s;
        return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
    }
}

/// A walk that records the positions of the fields that it visits.
class Places {
public:
    template <class T>
    void operator()(T& value, const Field&) {
        note(value);
    }
    template <class T>
    void choice(T& value, const Field&, const auto&...) {
        note(value);
    }
    template <class T>
    void each(const char*, T& value, const Field&) {
        note(value);
    }
    template <class T>
    void maybe(const char*, T& value) {
        note(value);
    }
    void section(const char*) {}
    void key(const Field&) {}
    void key(const auto&, const Field&) {}

    bool has_one_in(const auto& member) const {
        const auto from = reinterpret_cast<std::uintptr_t>(&member);
        const auto first = all_.lower_bound(from);
        return first != all_.end() && *first < from + sizeof(member);
    }

private:
    void note(const auto& value) { all_.insert(reinterpret_cast<std::uintptr_t>(&value)); }
    std::set<std::uintptr_t> all_;
};

/// Does not compile when N is not the number of members: add the new one to the description.
template <std::size_t N, class T>
void check_members(T object = Example<T>::make()) {
    INFO(typeid(T).name());
    Places places;
    walk_fields(places, object);
    const bool all_are_met =
        std::apply([&](const auto&... member) { return (places.has_one_in(member) && ...); },
                   members<N>(object));
    CHECK(all_are_met);
}

TEST_CASE("every member of an option struct is described", "[fields][case]") {
    check_members<4, LayeredOptions>();
    check_members<9, SpectralOptions>();
    check_members<16, PstdOptions>();
    check_members<5, Domain>();
    check_members<3, TimeAxis>();
    check_members<8, MeasureOptions>();
    check_members<2, SensationOptions>();
    check_members<5, RecordOptions>();
    check_members<9, Case>();
    check_members<14, VibrometerOptions>();
    check_members<4, Medium>();
    check_members<6, Layer>();
    check_members<1, KelvinVoigt>();
    check_members<2, FractionalKelvinVoigt>();
    check_members<2, StandardLinearSolid>();
    check_members<10, Body>();
    check_members<2, Ellipsoid>();
    check_members<5, Cylinder>();
    check_members<2, Box>();
    check_members<3, Orientation>();
    check_members<4, Load>();
    check_members<1, ResolvedCarrier>();
    check_members<1, GaussianFootprint>();
    check_members<14, ArrayFootprint>();
    check_members<4, Modulation>();
    check_members<1, Hold>();
    check_members<4, Swing>();
    check_members<4, Travel>();
    check_members<2, Line>();
    check_members<4, Arc>();
    check_members<1, ConstantSpeed>();
    check_members<4, OscillatingSpeed>();
    check_members<3, CornerPace>();
    check_members<4, SineGain>();
    check_members<5, RampGain>();
    check_members<6, SquareGain>();
    check_members<4, WindowGain>();
    check_members<4, SampledGain>();
    check_members<13, AfferentOptions>();
    check_members<2, HandAfferents>();
    check_members<2, GridAfferents>();
    check_members<1, AfferentList>();
    check_members<6, CarrierInput>();
}

} // namespace test_described_members
