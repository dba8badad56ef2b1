#include "model/load_text.hpp"

#include "base/hash.hpp"
#include "base/overloaded.hpp"

#include <array>

namespace shearwake {
namespace {

/// Of more points than this the text holds a hash.
constexpr std::size_t most_points = 100;

void put_points(TomlText& t, const std::vector<Vec2>& points_m) {
    std::vector<double> xs, ys;
    std::string text;
    for (const Vec2& p : points_m) {
        xs.push_back(p.x + 0.0); // -0 and 0 are the same place
        ys.push_back(p.y + 0.0);
        if (points_m.size() > most_points) text += exact(xs.back()) + " " + exact(ys.back()) + "\n";
    }
    if (points_m.size() > most_points) {
        t.put("points", std::ssize(points_m));
        t.put("points_hash", hex(stable_hash(text)));
        return;
    }
    t.put("points_x_m", xs);
    t.put("points_y_m", ys);
}

void put_path(TomlText& t, const Curve& path) {
    std::visit(overloaded{
                   [&](const Line& line) {
                       t.put("mover", "line");
                       t.put("from_m", line.from_m);
                       t.put("to_m", line.to_m);
                   },
                   [&](const Arc& arc) {
                       t.put("mover", "arc");
                       t.put("center_m", arc.center_m);
                       t.put("radius_m", arc.radius_m);
                       t.put("start_rad", arc.start_rad);
                       t.put("sweep_rad", arc.sweep_rad);
                   },
                   [&](const Polyline& line) {
                       t.put("mover", "polyline");
                       t.put("ends", line.ends() == Ends::open ? "open" : "closed");
                       put_points(t, line.points_m());
                   },
                   [&](const Lissajous& curve) {
                       t.put("mover", "lissajous");
                       t.put("center_m", curve.shape().center_m);
                       t.put("amplitudes_m", curve.shape().amplitudes_m);
                       t.put("p", static_cast<std::ptrdiff_t>(curve.shape().p));
                       t.put("q", static_cast<std::ptrdiff_t>(curve.shape().q));
                       t.put("phase_rad", curve.shape().phase_rad);
                   },
               },
               path.shape);
}

void put_travel(TomlText& t, const Travel& travel) {
    static constexpr std::array ends = {"off", "hold", "repeat", "back-and-forth"};
    put_path(t, travel.path);
    t.put("at_end", ends[static_cast<std::size_t>(travel.at_end)]);
    std::visit(overloaded{
                   [&](const ConstantSpeed& m) { t.put("speed_m_s", m.speed_m_s); },
                   [&](const OscillatingSpeed& m) {
                       t.put("speed_mean_m_s", m.mean_m_s);
                       t.put("speed_deviation_m_s", m.deviation_m_s);
                       t.put("speed_frequency_Hz", m.frequency_Hz);
                       t.put("speed_phase_rad", m.phase_rad);
                   },
               },
               travel.motion);
    if (travel.corners == CornerPace{}) return;
    t.put("corner_dwell_s", travel.corners.dwell_s);
    t.put("corner_slow_within_m", travel.corners.slow_within_m);
    t.put("corner_slow_to", travel.corners.slow_to);
}

void put_on(TomlText& t, GainOn on) {
    t.put("on", on == GainOn::force ? "force" : "pressure");
}

void put_mover(TomlText& t, const Mover& mover) {
    t.element("load.modulation.trajectory");
    std::visit(overloaded{
                   [&](const Hold& hold) {
                       t.put("mover", "hold");
                       t.put("at_m", hold.at_m);
                   },
                   [&](const Swing& swing) {
                       t.put("mover", "swing");
                       t.put("amplitude_m", swing.amplitude_m);
                       t.put("frequency_Hz", swing.frequency_Hz);
                       t.put("phase_rad", swing.phase_rad);
                       t.put("wave", swing.wave == SwingWave::sine ? "sine" : "triangle");
                   },
                   [&](const Travel& travel) { put_travel(t, travel); },
               },
               mover);
}

void put_gain(TomlText& t, const Gain& gain) {
    t.element("load.modulation.envelope");
    std::visit(overloaded{
                   [&](const SineGain& g) {
                       t.put("gain", "sine");
                       t.put("frequency_Hz", g.frequency_Hz);
                       t.put("depth", g.depth);
                       t.put("phase_rad", g.phase_rad);
                       put_on(t, g.on);
                   },
                   [&](const RampGain& g) {
                       t.put("gain", "ramp");
                       t.put("duration_s", g.duration_s);
                       if (g == RampGain{.duration_s = g.duration_s}) return;
                       t.put("start_s", g.start_s);
                       t.put("from", g.from);
                       t.put("to", g.to);
                       put_on(t, g.on);
                   },
                   [&](const SquareGain& g) {
                       t.put("gain", "square");
                       t.put("frequency_Hz", g.frequency_Hz);
                       t.put("duty", g.duty);
                       t.put("depth", g.depth);
                       t.put("phase_rad", g.phase_rad);
                       t.put("edge_s", g.edge_s);
                       put_on(t, g.on);
                   },
                   [&](const WindowGain& g) {
                       t.put("gain", "window");
                       t.put("from_s", g.from_s);
                       t.put("to_s", g.to_s);
                       t.put("edge_s", g.edge_s);
                       put_on(t, g.on);
                   },
               },
               gain);
}

void put_array(TomlText& t, const ArrayFootprint& array) {
    t.put("footprint", "array");
    t.put("columns", array.columns);
    t.put("rows", array.rows);
    t.put("pitch_m", array.pitch_m);
    t.put("radius_m", array.radius_m);
    t.put("distance_m", array.distance_m);
    t.put("center_m", array.center_m);
    t.put("frequency_Hz", array.frequency_Hz);
    t.put("sound_speed_m_s", array.sound_speed_m_s);
    t.put("missing", std::vector<double>(array.missing.begin(), array.missing.end()));
    t.put("phase_levels", static_cast<std::ptrdiff_t>(array.phase_levels));
    t.put("update_rate_Hz", array.update_rate_Hz);
    t.put("reach_m", array.reach_m);
}

} // namespace

void put_load(TomlText& t, const Load& load) {
    t.table("load");
    t.put("peak_Pa", load.peak_Pa);
    std::visit(overloaded{
                   [&](const GaussianFootprint& g) {
                       t.put("footprint", "gaussian");
                       t.put("fwhm_m", g.fwhm_m);
                   },
                   [&](const ArrayFootprint& array) { put_array(t, array); },
               },
               load.footprint);
    std::visit(overloaded{
                   [&](const AveragedCarrier&) { t.put("carrier", "averaged"); },
                   [&](const ResolvedCarrier& c) {
                       t.put("carrier", "resolved");
                       t.put("carrier_Hz", c.frequency_Hz);
                   },
               },
               load.carrier);
    t.table("load.modulation");
    t.put("kind", load.modulation.kind);
    if (!load.modulation.foci_m.empty()) {
        std::vector<double> xs, ys;
        for (const Vec2& p : load.modulation.foci_m) {
            xs.push_back(p.x);
            ys.push_back(p.y);
        }
        t.put("foci_x_m", xs);
        t.put("foci_y_m", ys);
    }
    for (const Mover& mover : load.modulation.trajectory.parts)
        put_mover(t, mover);
    for (const Gain& gain : load.modulation.envelope.gains)
        put_gain(t, gain);
}

} // namespace shearwake
