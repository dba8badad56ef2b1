// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/laboratory.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "config/sweep/sweep.hpp"
#include "parallel/agree.hpp"
#include "pipeline/provenance.hpp"
#include "sampling/distribution.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "studies/laboratory/observed_data.hpp"
#include "studies/laboratory/least_squares.hpp"
#include "studies/tables.hpp"

#include <cmath>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {
namespace {

/// A fit with a simpler material law. A negative change of the Bayesian information criterion means
/// that the simpler law suffices.
struct SimplerFit {
    std::string key, law;
    double change = 0.0;
};

struct FitOutput {
    const std::vector<Parameter>& parameters;
    const ConvertedData& data;
    std::span<const double> observed; // one row of samples per point
    std::size_t samples;
    const FitResult& result;
    const std::vector<SimplerFit>& simpler;
};

using Document = nlohmann::ordered_json;

constexpr double outlier_weight = 0.5;

long outliers(const FitResult& result) {
    return std::ranges::count_if(result.weights, [](double w) { return w < outlier_weight; });
}

Document estimates_of(const FitOutput& output) {
    Document estimates = Document::object();
    for (std::size_t i = 0; i < output.parameters.size(); ++i) {
        const Estimate& e = output.result.estimates[i];
        estimates[output.parameters[i].key] = {
            {"value", e.value},
            {"standard_error", e.standard_error},
            {"interval_95", {e.low_95, e.high_95}},
            {"bounds", {output.parameters[i].low, output.parameters[i].high}},
            {"at_bound", e.is_at_bound}};
    }
    return estimates;
}

Document correlations_of(const FitOutput& output) {
    const std::size_t count = output.parameters.size();
    Document rows = Document::array();
    for (std::size_t i = 0; i < count; ++i) {
        Document row = Document::array();
        for (std::size_t j = 0; j < count; ++j)
            row.push_back(output.result.correlations[i * count + j]);
        rows.push_back(row);
    }
    return rows;
}

Document simpler_of(const FitOutput& output) {
    Document list = Document::array();
    for (const SimplerFit& one : output.simpler)
        list.push_back({{"key", one.key},
                        {"law", one.law},
                        {"bic_change", one.change},
                        {"suffices", one.change < 0.0}});
    return list;
}

/// Writes fit.json and fit.h5. Not collective.
void write_fit(const std::filesystem::path& folder, const std::filesystem::path& job,
               const FitOutput& output) {
    const ConvertedData& data = output.data;
    const Document root = {{"schema", 1},
                           {"job", job.string()},
                           {"data", data.data},
                           {"sha256", data.sha256},
                           {"notes", data.notes},
                           {"converged", output.result.has_converged},
                           {"solver", output.result.report},
                           {"estimates", estimates_of(output)},
                           {"correlations", correlations_of(output)},
                           {"noise_m_s", output.result.noise},
                           {"points", data.points_m.size()},
                           {"outliers", outliers(output.result)},
                           {"is_line", data.is_line},
                           {"simpler_laws", simpler_of(output)}};
    storage::write_file(folder / "fit.json", root.dump(2) + "\n");
    std::vector<double> numbers(data.points_m.size()), x, y, times;
    std::iota(numbers.begin(), numbers.end(), 0.0);
    for (const Vec2 point : data.points_m) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    for (std::size_t n = 0; n < output.samples; ++n)
        times.push_back(data.start_s + static_cast<double>(n) / data.rate_Hz);
    VariableGroup group{"", {}};
    group.add("point", {"point"}, numbers, "1", "number of the point of the scan");
    group.add("time", {"time"}, times, "s", "time since the trigger");
    group.add("x", {"point"}, x, "m", "position of the point along x");
    group.add("y", {"point"}, y, "m", "position of the point along y");
    group.add("measured", {"point", "time"}, {output.observed.begin(), output.observed.end()},
              "m/s", "measured velocity along the line of sight");
    group.add("predicted", {"point", "time"}, output.result.predicted, "m/s",
              "velocity of the model with the estimates");
    group.add("residual_rms", {"point"}, output.result.residual_rms, "m/s",
              "root mean square of measured minus predicted velocity");
    group.add("weight", {"point"}, output.result.weights, "1",
              "weight of the point in the fit; below 0.5: an outlier");

    storage::write_record(folder / "fit.h5", {group}, pipeline::program_attributes());
}

/// Not collective.
void print_fit(const FitOutput& output) {
    const FitResult& result = output.result;
    for (const std::string& note : output.data.notes)
        fmt::print("{}\n", note);
    std::size_t width = 9;
    for (const Parameter& parameter : output.parameters)
        width = std::max(width, parameter.key.size());
    fmt::print("{:<{}} {:>12} {:>12} {:>26}\n", "parameter", width, "estimate", "std. error",
               "95 % interval");
    for (std::size_t i = 0; i < output.parameters.size(); ++i) {
        const Estimate& e = result.estimates[i];
        fmt::print("{:<{}} {:>12.6g} {:>12.3g} {:>12.6g} {:>13.6g}{}\n", output.parameters[i].key,
                   width, e.value, e.standard_error, e.low_95, e.high_95,
                   e.is_at_bound ? " (at its bound)" : "");
    }
    const std::size_t count = output.parameters.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
            fmt::print("correlation of {} and {}: {:.2f}\n", output.parameters[i].key,
                       output.parameters[j].key, result.correlations[i * count + j]);
    fmt::print("residual: {:.4g} um/s per sample; {} of {} points are outliers\n",
               1e6 * result.noise, outliers(result), output.data.points_m.size());
    for (const SimplerFit& one : output.simpler)
        fmt::print(
            "simpler law ({}, without {}): {} (change of the information criterion {:+.4g})\n",
            one.law, one.key, one.change < 0.0 ? "suffices" : "does not suffice", one.change);
    if (!result.has_converged)
        fmt::print(stderr, "warning: the fit has not converged: {}\n", result.report);
}

/// Beyond these quantiles of a distribution no value is tried.
constexpr double tail = 1e-9;
/// Job files contain 0 or larger magnitudes.
constexpr double least_magnitude = 1e-9;

/// A uniform or triangular distribution gives bounds alone.
std::optional<Prior> prior_of(const sampling::Distribution& distribution) {
    const double low = sampling::quantile(distribution, 0.158655),
                 high = sampling::quantile(distribution, 0.841345);
    const std::optional normal = Prior{0.5 * (low + high), 0.5 * (high - low), false};
    const auto log_normal = [&](const sampling::LogNormal& shape) {
        if (distribution.root_of != 0.0) return normal;
        return std::optional(Prior{std::log(shape.median), std::log(shape.geometric_sd), true});
    };
    return std::visit(overloaded{[](const sampling::Uniform&) { return std::optional<Prior>(); },
                                 [&](const sampling::Normal&) { return normal; }, log_normal,
                                 [](const sampling::Triangular&) { return std::optional<Prior>(); },
                                 [&](const sampling::Empirical&) { return normal; }},
                      distribution.shape);
}

/// The keys to estimate. The root warns of overrides of such keys. Not collective.
std::vector<Parameter> read_parameters(const ScanArguments& arguments, bool is_root) {
    config::DiagnosticList diagnostics;
    const auto overrides = schedule::parse_overrides(arguments.overrides);
    const config::NodePtr tree =
        config::job_tree(storage::read_file(arguments.job, storage::largest_user_text_B),
                         arguments.job.string(), overrides, diagnostics);
    std::vector<Parameter> parameters;
    std::vector<std::string> names;
    if (tree)
        for (const config::UncertainKey& key : config::uncertain_keys(tree, {}, diagnostics)) {
            names.push_back(key.key);
            parameters.push_back({key.key, sampling::quantile(key.distribution, 0.5),
                                  sampling::quantile(key.distribution, tail),
                                  sampling::quantile(key.distribution, 1.0 - tail),
                                  prior_of(key.distribution)});
        }
    if (diagnostics.errors() > 0) throw config::BadJob(diagnostics.sorted());
    config::check_overrides(tree, overrides, names, diagnostics);
    if (is_root)
        for (const config::Diagnostic& diagnostic : diagnostics.sorted())
            fmt::print(stderr, "{}\n", coloured(config::text(diagnostic), stderr));
    if (parameters.empty())
        throw UsageError(arguments.job.string() + ": [uncertain] names no key to be estimated",
                         ExitCode::bad_job);
    return parameters;
}

/// The model as all ranks compute it together: the root asks, the others follow.
class SharedModel {
public:
    SharedModel(const schedule::JobArguments& arguments, const std::vector<Parameter>& parameters,
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

    const schedule::JobArguments& arguments_; // without overrides of [uncertain]
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
            const std::optional<std::vector<double>> predicted =
                others.empty()
                    ? reduced({})
                    : fit(others, rows, rows.size() / samples, reduced, full.noise).predicted;
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
    schedule::JobArguments of_case = arguments;
    std::erase_if(of_case.overrides,
                  [](const auto& text) { return text.starts_with("uncertain"); });
    const config::Job job =
        schedule::load_job(of_case.job, studies::one_case_overrides(of_case.overrides), world);
    const Case& c = job.plan.cases.front().physics;
    if (!std::holds_alternative<LayeredOptions>(c.solver))
        throw UsageError("solver.engine: fit computes with engine \"layered\" only",
                         ExitCode::bad_job);
    const std::filesystem::path folder =
        schedule::output_folder(arguments.out, job.plan.name + ".fit").root;
    const std::filesystem::path prefix = folder / "scan";
    together(world, [&] { parameters = read_parameters(arguments, world.is_root()); });
    on_root(world, [&] {
        storage::make_directory(folder);
        warn_of_overrides(arguments, true);
        convert_scan(arguments.data, scan_request(arguments, c), prefix);
    });
    ConvertedData data;
    together(world, [&] { data = read_velocities(prefix); });
    SharedModel model(of_case, parameters, data, world);
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
