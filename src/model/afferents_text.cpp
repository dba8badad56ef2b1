#include "model/afferents_text.hpp"

#include "base/overloaded.hpp"

namespace shearwake {
namespace {

void put_points(TomlText& t, const char* x_key, const char* y_key, const auto& points,
                const auto& at) {
    std::vector<double> xs, ys;
    for (const auto& point : points) {
        xs.push_back(at(point).x);
        ys.push_back(at(point).y);
    }
    t.put(x_key, xs);
    t.put(y_key, ys);
}

void put_list(TomlText& t, const AfferentList& list) {
    t.put("where", "list");
    put_points(t, "x_m", "y_m", list.all, [](const ListedAfferent& one) { return one.at_m; });
    std::vector<std::string> neurons;
    for (const ListedAfferent& one : list.all)
        neurons.push_back(name_of(one.kind) + " " + std::to_string(one.row));
    t.put("neurons", neurons);
}

void put_carrier(TomlText& t, const CarrierInput& carrier) {
    t.put("input", "carrier");
    t.put("wave", carrier.wave == CarrierWave::signed_     ? "signed"
                  : carrier.wave == CarrierWave::rectified ? "rectified"
                                                           : "squared");
    t.put("carrier_Hz", carrier.frequency_Hz);
    t.put("amplitude_m", carrier.amplitude_m);
    t.put("sampling_Hz", carrier.sampling_Hz);
    t.put("am_frequency_Hz", carrier.am_frequency_Hz);
    t.put("am_depth", carrier.am_depth);
}

} // namespace

void put_afferents(TomlText& t, const AfferentOptions& options) {
    t.table("afferents");
    std::visit(overloaded{
                   [&](const HandAfferents& places) {
                       t.put("where", places.part);
                       if (places.part == "fingertip")
                           t.put("digit", static_cast<std::ptrdiff_t>(places.digit));
                   },
                   [&](const GridAfferents& grid) {
                       t.put("where", "grid");
                       t.put("extent_m", grid.extent_m);
                       t.put("pitch_m", grid.pitch_m);
                   },
                   [&](const AfferentList& list) { put_list(t, list); },
               },
               options.places);
    std::vector<std::string> classes;
    for (const AfferentClass kind : options.classes)
        classes.push_back(name_of(kind));
    t.put("classes", classes);
    t.put("seed", static_cast<std::ptrdiff_t>(options.seed));
    if (options.patch_m) t.put("patch_m", *options.patch_m);
    t.put("patch_rad", options.patch_rad);
    t.put("skin", options.sheet == SkinSheet::hand ? "hand" : "flat");
    std::visit(overloaded{
                   [&](const PinInput&) { t.put("input", "pins"); },
                   [&](const StressInput&) { t.put("input", "stress"); },
                   [&](const CarrierInput& carrier) { put_carrier(t, carrier); },
               },
               options.input);
    put_points(t, "pins_x_m", "pins_y_m", options.pins_m, [](Vec2 pin_m) { return pin_m; });
    t.put("pin_radius_m", options.pin_radius_m);
    t.put("silence_s", options.silence_s);
    t.put_flag("noise", options.noise == Switch::on);
    t.put_flag("conduction_delay", options.conduction_delay == Switch::on);
}

} // namespace shearwake
