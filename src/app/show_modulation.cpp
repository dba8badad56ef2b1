// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"
#include "base/python_module.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/job_source.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <unistd.h>

namespace shearwake::app {
namespace {

/// Position, speed and gain of the focus, sampled from t = 0 on, as JSON in SI units.
std::string samples(const Modulation& modulation, double span_s) {
    constexpr int count = 4000; // finer than the width of a printed line for up to 40 periods
    std::vector<double> t, x, y, speed, strength;
    for (int n = 0; n <= count; ++n) {
        const double t_s = span_s * n / count;
        const Vec2 at = position(modulation.trajectory, t_s);
        t.push_back(t_s);
        x.push_back(at.x);
        y.push_back(at.y);
        speed.push_back(norm(velocity(modulation.trajectory, t_s)));
        strength.push_back(gain(modulation.envelope, t_s));
    }
    return fmt::format(R"({{"t_s": [{:.9g}], "x_m": [{:.9g}], "y_m": [{:.9g}], )"
                       R"("speed_m_s": [{:.9g}], "gain": [{:.9g}]}})",
                       fmt::join(t, ","), fmt::join(x, ","), fmt::join(y, ","),
                       fmt::join(speed, ","), fmt::join(strength, ","));
}

std::string description(const Case& c) {
    const Modulation& modulation = c.scene().load.modulation;
    const double run_s = std::min(c.time.duration_s(), off_time_s(modulation.trajectory));
    const double frequency_Hz = modulation_frequency_Hz(modulation).value_or(0.0);
    const double period_s = frequency_Hz > 0.0 ? std::min(run_s, 1.0 / frequency_Hz) : run_s;
    std::vector<double> foci_x, foci_y;
    for (const Vec2 focus : modulation.foci_m) {
        foci_x.push_back(focus.x);
        foci_y.push_back(focus.y);
    }
    return fmt::format("{{\"kind\": \"{}\", \"frequency_Hz\": {:.9g}, \"foci_x_m\": [{}], "
                       "\"foci_y_m\": [{}],\n\"run\": {},\n\"period\": {}}}\n",
                       modulation.kind, frequency_Hz, fmt::join(foci_x, ","),
                       fmt::join(foci_y, ","), samples(modulation, run_s),
                       samples(modulation, period_s));
}

} // namespace

ExitCode show_modulation_command(const ShowModulationArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    on_root(world, [&] {
        std::filesystem::path picture = arguments.picture;
        if (picture.empty()) picture = arguments.job.stem().string() + ".modulation.png";
        const std::filesystem::path data = picture.string() + fmt::format(".{}.json", ::getpid());
        std::ofstream file(data);
        file << description(job.plan.cases.at(0).physics);
        file.close();
        if (!file)
            throw UsageError("cannot write " + data.string() +
                                 "; use --picture to choose another folder",
                             ExitCode::environment);
        int status = -1;
        try {
            status =
                run_python_module("shearwake.report.modulation", {data.string(), picture.string()});
        } catch (...) {
            std::filesystem::remove(data);
            throw;
        }
        std::filesystem::remove(data);
        if (status != 0)
            throw UsageError(fmt::format("drawing the picture failed (exit {})", status),
                             ExitCode::environment);
        fmt::print("picture: {}\n", picture.string());
    });
    return ExitCode::done;
}

} // namespace shearwake::app
