// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/fit.hpp"

#include "base/python_module.hpp"
#include "config/sweep/uncertain.hpp"
#include "parallel/agree.hpp"
#include "sampling/distribution.hpp"
#include "schedule/run/job_source.hpp"
#include "storage/files.hpp"
#include "studies/evaluate.hpp"
#include "studies/laboratory/converted_scan.hpp"
#include "studies/laboratory/fit_output.hpp"
#include "studies/laboratory/observed_model.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::laboratory {
namespace {

/// Beyond these quantiles of a distribution no value is tried.
constexpr double tail = 1e-9;
/// Job files contain 0 or larger magnitudes.
constexpr double least_magnitude = 1e-9;

/// A uniform or triangular distribution gives bounds alone.
std::optional<Prior> prior_of(const sampling::Distribution& distribution) {
    if (std::holds_alternative<sampling::Uniform>(distribution.shape) ||
        std::holds_alternative<sampling::Triangular>(distribution.shape))
        return std::nullopt;
    if (const auto* shape = std::get_if<sampling::LogNormal>(&distribution.shape))
        if (distribution.root_of == 0.0)
            return Prior{std::log(shape->median), std::log(shape->geometric_sd), true};
    const double low = sampling::quantile(distribution, 0.158655),
                 high = sampling::quantile(distribution, 0.841345);
    return Prior{0.5 * (low + high), 0.5 * (high - low), false};
}

std::vector<Parameter> read_parameters(const std::filesystem::path& job) {
    config::DiagnosticList diagnostics;
    const config::NodePtr tree = config::parse_toml(
        storage::read_file(job, storage::largest_user_text_B), job.string(), diagnostics);
    std::vector<Parameter> parameters;
    if (tree)
        for (const config::UncertainKey& key : config::uncertain_keys(tree, {}, diagnostics))
            parameters.push_back({key.key, sampling::quantile(key.distribution, 0.5),
                                  sampling::quantile(key.distribution, tail),
                                  sampling::quantile(key.distribution, 1.0 - tail),
                                  prior_of(key.distribution)});
    if (diagnostics.errors() > 0) throw config::BadJob(diagnostics.sorted());
    if (parameters.empty())
        throw UsageError(job.string() + ": [uncertain] names no key; it lists the numbers to be "
                                        "estimated with their bounds and priors",
                         ExitCode::bad_job);
    return parameters;
}

/// The model as all ranks compute it together: the root asks, the others follow.
class SharedModel {
public:
    SharedModel(const ScanArguments& arguments, const std::vector<Parameter>& parameters,
                const ConvertedData& data, const Comm& world)
        : arguments_(arguments), parameters_(parameters), world_(world),
          samples_(covered_samples(observed_case(case_at(start_of(parameters)), data), data)),
          model_(data, samples_, world) {
        if (samples_ < 8)
            throw UsageError("the scan and the simulated time have fewer than 8 samples in common: "
                             "compare vibrometer.trigger_delay_ms and time.duration_ms");
    }

    std::size_t samples() const { return samples_; }

    /// Runs `work` on the root, which may call ask(). Collective.
    void run(const std::function<void()>& work) {
        std::exception_ptr thrown;
        if (world_.is_root()) {
            try {
                work();
            } catch (...) {
                thrown = std::current_exception();
            }
            std::vector<double> end;
            world_.broadcast(end);
        } else {
            for (std::vector<double> values;; evaluate(values)) {
                world_.broadcast(values);
                if (values.empty()) break;
            }
        }
        on_root(world_, [&] {
            if (thrown) std::rethrow_exception(thrown);
        });
    }

    /// On the root, inside run().
    std::optional<std::vector<double>> ask(std::span<const double> values) {
        std::vector<double> sent(values.begin(), values.end());
        world_.broadcast(sent);
        return evaluate(sent);
    }

private:
    static std::vector<double> start_of(const std::vector<Parameter>& parameters) {
        std::vector<double> values;
        for (const Parameter& parameter : parameters)
            values.push_back(parameter.start);
        return values;
    }

    Case case_at(std::span<const double> values) const {
        std::vector<std::string> overrides = studies::one_case_overrides(arguments_.overrides);
        for (std::size_t i = 0; i < parameters_.size(); ++i)
            overrides.push_back(
                fmt::format("{}={:.17g}", parameters_[i].key,
                            std::abs(values[i]) < least_magnitude ? 0.0 : values[i]));
        return schedule::load_job(arguments_.job, overrides, world_).plan.cases.front().physics;
    }

    std::optional<std::vector<double>> evaluate(std::span<const double> values) {
        try {
            return model_.velocities_m_s(case_at(values));
        } catch (const UsageError&) { // on all ranks: a case that is not valid
            return std::nullopt;
        } catch (const CaseFailure&) {
            return std::nullopt;
        }
    }

    const ScanArguments& arguments_;
    const std::vector<Parameter>& parameters_;
    const Comm& world_;
    std::size_t samples_;
    ObservedModel model_;
};

/// The first `samples` of each point.
std::vector<double> observed(const std::filesystem::path& prefix, const ConvertedData& data,
                             std::size_t samples) {
    std::vector<double> rows(data.points_m.size() * samples);
    for (std::size_t point = 0; point < data.points_m.size(); ++point)
        read_numbers(prefix, point * data.samples,
                     std::span(rows).subspan(point * samples, samples));
    return rows;
}

/// Values at which a material law is a simpler one.
struct SimplerLaw {
    const char* ending;
    double value;
    const char* name;
};
constexpr SimplerLaw simpler_laws[] = {{"viscosity_Pa_s", 0.0, "no loss"},
                                       {"exponent", 1.0 - 1e-9, "Kelvin-Voigt"},
                                       {"strength", 1e-9, "no loss"}};

double chi_squared(const std::vector<double>& predicted, std::span<const double> rows,
                   std::size_t samples, double noise) {
    double sum = 0.0;
    for (std::size_t first = 0; first < rows.size(); first += samples) {
        double squares = 0.0;
        for (std::size_t n = first; n < first + samples; ++n)
            squares += (predicted[n] - rows[n]) * (predicted[n] - rows[n]);
        sum += robust_chi_squared(squares / static_cast<double>(samples), samples, noise);
    }
    return sum;
}

/// Repeats the fit with each law that has fewer parameters. On the root.
std::vector<SimplerFit> simpler_fits(const std::vector<Parameter>& parameters,
                                     const FitResult& full, std::span<const double> rows,
                                     std::size_t samples, const Model& model) {
    std::vector<SimplerFit> fits;
    for (std::size_t fixed = 0; fixed < parameters.size(); ++fixed)
        for (const SimplerLaw& law : simpler_laws) {
            if (!parameters[fixed].key.ends_with(law.ending)) continue;
            std::vector<Parameter> others = parameters;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(fixed));
            for (std::size_t i = 0; i < others.size(); ++i) // near the solution
                others[i].start = full.estimates[i < fixed ? i : i + 1].value;
            const Model reduced = [&](std::span<const double> values) {
                std::vector<double> all(values.begin(), values.end());
                all.insert(all.begin() + static_cast<std::ptrdiff_t>(fixed), law.value);
                return model(all);
            };
            std::optional<std::vector<double>> predicted;
            if (others.empty())
                predicted = reduced({});
            else
                predicted = fit(others, rows, rows.size() / samples, reduced, full.noise).predicted;
            if (!predicted) continue;
            const double change = chi_squared(*predicted, rows, samples, full.noise) -
                                  full.chi_squared - std::log(static_cast<double>(rows.size()));
            fits.push_back({parameters[fixed].key, law.name, change});
        }
    return fits;
}

} // namespace

ExitCode fit_job(const ScanArguments& arguments, const Comm& world) {
    std::vector<Parameter> parameters;
    const config::Job job =
        schedule::load_job(arguments.job, studies::one_case_overrides(arguments.overrides), world);
    const Case& c = job.plan.cases.front().physics;
    if (!std::holds_alternative<LayeredOptions>(c.solver))
        throw UsageError("solver.engine: fit computes with engine \"layered\" only",
                         ExitCode::bad_job);
    const std::filesystem::path folder =
        schedule::output_folder(arguments.out, job.plan.name + ".fit").root;
    const std::filesystem::path prefix = folder / "scan";
    together(world, [&] { parameters = read_parameters(arguments.job); });
    on_root(world, [&] {
        storage::make_directory(folder);
        convert_scan(arguments.data, scan_request(arguments, c), prefix);
    });
    ConvertedData data;
    together(world, [&] { data = read_velocities(prefix); });
    SharedModel model(arguments, parameters, data, world);
    model.run([&] {
        const std::vector<double> rows = observed(prefix, data, model.samples());
        const Model ask = [&](std::span<const double> values) { return model.ask(values); };
        const FitResult result = fit(parameters, rows, data.points_m.size(), ask);
        const auto simpler = simpler_fits(parameters, result, rows, model.samples(), ask);
        const FitOutput output{parameters, data, rows, model.samples(), result, simpler};
        write_fit(folder, arguments.job, output);
        print_fit(output);
        remove_converted(prefix);
    });
    on_root(world, [&] {
        if (run_python_module("shearwake.laboratory.fit_figures", {folder.string()},
                              scan_packages) != 0)
            throw UsageError("the figures of the fit cannot be drawn", ExitCode::environment);
        fmt::print("files: {}\n", folder.string());
    });
    return ExitCode::done;
}

} // namespace shearwake::laboratory
