// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/sweep.hpp"

#include "base/text.hpp"
#include "config/document/job_keys.hpp"
#include "config/files/files.hpp"
#include "config/sections/read_fields.hpp"
#include "sampling/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {

namespace {

constexpr std::size_t most_uncertain_keys = 30;

bool is_option(const std::string& key) {
    return key == "correlation" || described_field<UncertainTableKeys>(key);
}

/// The keys with their distributions.
struct UncertainKeys {
    Axis axis; // without values
    std::vector<sampling::Distribution> distributions;
};

UncertainKeys read_keys(const TableNode& table, const Sweep& sweep, const FileLoaders& files,
                        DiagnosticList& diagnostics) {
    UncertainKeys found;
    for (const Entry& entry : table.entries) {
        if (is_option(entry.key)) continue;
        const auto path = case_path(entry, "uncertain", diagnostics);
        if (!path) continue;
        if (sweep.contains(entry.key)) {
            diagnostics.error(entry.key_at, fmt::format("uncertain: {} is also swept; remove it "
                                                        "from one of the two tables",
                                                        entry.key));
            continue;
        }
        if (!std::holds_alternative<TableNode>(entry.value->value)) {
            diagnostics.error(entry.value->at,
                              fmt::format("uncertain: {} requires a distribution, for example {{ "
                                          "distribution = \"uniform\", min = 1.0, max = 2.0 }}",
                                          entry.key));
            continue;
        }
        const Reader reader(entry.value, fmt::format("uncertain.\"{}\"", entry.key), diagnostics);
        const auto distribution = read_distribution(reader, entry.key, files);
        if (!distribution) continue;
        found.axis.keys.push_back({entry.key, *path, entry.key_at, {}});
        found.distributions.push_back(*distribution);
    }
    return found;
}

sampling::Copula read_correlations(Reader& reader, const UncertainKeys& keys,
                                   const std::string& analysis) {
    sampling::Copula copula(keys.axis.keys.size());
    const auto place_of_key = [&](const std::string& key) {
        const auto found = std::ranges::find(keys.axis.keys, key, &SweptKey::key);
        return static_cast<std::size_t>(found - keys.axis.keys.begin());
    };
    if (!reader.has("correlation")) return copula;
    if (analysis != name_in_text(sampling::Analysis::distribution))
        reader.error("correlation", "is not possible with this analysis, whose indices are "
                                    "defined for independent keys");
    for (Reader& pair : reader.tables("correlation")) {
        const auto names = pair.find_words("keys");
        const double rank = pair.number("rank", range_of<CorrelationKeys>("rank"));
        pair.finish();
        const std::size_t end = keys.axis.keys.size();
        if (!names || names->size() != 2 || place_of_key(names->front()) == end ||
            place_of_key(names->back()) == end || names->front() == names->back())
            pair.error("keys", "must name two different uncertain keys");
        else
            copula.correlate(place_of_key(names->front()), place_of_key(names->back()), rank);
    }
    if (!copula.exists())
        reader.error("correlation", "contradicts itself: no numbers have these correlations (the "
                                    "matrix is not positive definite)");
    return copula;
}

std::vector<Threshold> read_thresholds(Reader& reader) {
    std::vector<Threshold> thresholds;
    Reader table = reader.optional_table("exceedance");
    for (const std::string& column : table.keys()) {
        const auto value = as_number(*table.node(column));
        if (value && std::isfinite(*value))
            thresholds.push_back({column, *value});
        else
            table.error(column, "must be a finite number, the threshold of this column");
    }
    return thresholds;
}

/// Whether the sample and the sweep together have a supported number of cases.
bool fits(const UncertainPlan& plan, const Sweep& sweep, Reader& reader) {
    double cases = static_cast<double>(plan.samples) *
                   static_cast<double>(sampling::rows_per_sample(sampling::design_of(plan)));
    for (const Axis& axis : sweep.axes)
        cases *= static_cast<double>(axis.size());
    if (cases <= static_cast<double>(most_cases)) return true;
    reader.error("samples", fmt::format("results in {:.0f} cases; at most {} are supported", cases,
                                        most_cases));
    return false;
}

/// Numbers with nine digits, as tables contain them: the last digits of a quantile may differ
/// between libraries, and ids must not.
double rounded_sample(double value) {
    return std::stod(fmt::format("{:.9g}", value));
}

void fill(UncertainKeys& keys, const sampling::Points& points) {
    for (std::size_t k = 0; k < keys.axis.keys.size(); ++k) {
        SweptKey& key = keys.axis.keys[k];
        for (const std::vector<double>& point : points)
            key.values.push_back(make_node(
                rounded_sample(sampling::quantile(keys.distributions[k], point[k])), key.at));
    }
}

void read_options(Reader& reader, UncertainPlan& plan) {
    UncertainTableKeys keys;
    read_fields(reader, keys);
    plan.samples = keys.samples;
    plan.sampling = name_in_text(keys.sampling);
    plan.analysis = name_in_text(keys.analysis);
    plan.seed = keys.seed;
    plan.exceedance = read_thresholds(reader);
}

} // namespace

NodePtr flattened_uncertain(const NodePtr& uncertain) {
    return flattened(uncertain, [](const std::string& key, const Node& node) {
        const auto& table = std::get<TableNode>(node.value);
        return is_option(key) || std::ranges::none_of(table.entries, [](const Entry& entry) {
                   return std::holds_alternative<TableNode>(entry.value->value);
               });
    });
}

std::vector<UncertainKey> uncertain_keys(const NodePtr& job, const FileLoaders& files,
                                         DiagnosticList& diagnostics) {
    const NodePtr given = find(job, {{"uncertain"}});
    if (!given || !std::holds_alternative<TableNode>(given->value)) return {};
    const UncertainKeys found =
        read_keys(std::get<TableNode>(given->value), Sweep{}, files, diagnostics);
    std::vector<UncertainKey> keys;
    for (std::size_t i = 0; i < found.axis.keys.size(); ++i)
        keys.push_back({found.axis.keys[i].key, found.distributions[i]});
    return keys;
}

std::optional<UncertainPlan> read_uncertain(const NodePtr& uncertain, Sweep& sweep,
                                            const FileLoaders& files, DiagnosticList& diagnostics) {
    const std::size_t before = diagnostics.errors();
    const auto* table = std::get_if<TableNode>(&uncertain->value);
    if (!table) {
        diagnostics.error(uncertain->at, "uncertain must be a table");
        return std::nullopt;
    }
    if (table->entries.empty()) return std::nullopt;
    UncertainKeys keys = read_keys(*table, sweep, files, diagnostics);
    UncertainPlan plan;
    for (const SweptKey& key : keys.axis.keys)
        plan.keys.push_back(key.key);
    Reader reader(uncertain, "uncertain", diagnostics);
    std::vector<std::string> names;
    for (const std::string& name : reader.keys())
        if (!is_option(name)) names.push_back(name);
    reader.allow(names);
    read_options(reader, plan);
    const sampling::Copula copula = read_correlations(reader, keys, plan.analysis);
    reader.finish();
    if (names.empty() || names.size() > most_uncertain_keys)
        diagnostics.error(uncertain->at,
                          fmt::format("uncertain has {} keys with a distribution; between 1 and "
                                      "{} are supported",
                                      names.size(), most_uncertain_keys));
    if (diagnostics.errors() != before || !sweep.sound || !fits(plan, sweep, reader))
        return std::nullopt;
    sampling::Points points = sampling::design_points(sampling::design_of(plan));
    if (reader.has("correlation")) copula.apply(points);
    fill(keys, points);
    sweep.sampled_axis = sweep.axes.size();
    sweep.axes.push_back(std::move(keys.axis));
    return plan;
}

namespace {

using sampling::Distribution;

/// c_s = sqrt(mu / rho) with mu in kPa, and mu = E / 3 for an incompressible material.
constexpr double shear_modulus_factor(double density_kg_m3) {
    return 1000.0 / density_kg_m3;
}
constexpr double youngs_modulus_factor(double density_kg_m3) {
    return 1000.0 / (3.0 * density_kg_m3);
}
constexpr double tissue_kg_m3 = DistributionKeys{}.density_kg_m3;

struct DistributionPreset {
    const char* name;
    const char* ending; // of the keys that it fits
    Distribution distribution;
};

/// The reference ranges of Young's modulus of skin over 90 healthy volunteers by shear-wave
/// elastography (Yang et al., J Ultrasound Med 2018): means and percentiles 2.5 and 97.5 in kPa.
/// The percentiles are symmetric about the means. Ours: the normal distribution with sd = (97.5th
/// - 2.5th percentile) / (2 x 1.96), truncated to above 1 kPa; mu = E / 3; 1000 kg/m3.
Distribution skin_of(double mean_kPa, double low_kPa, double high_kPa) {
    return {.shape = sampling::Normal{mean_kPa, (high_kPa - low_kPa) / 3.92},
            .least = 1.0,
            .root_of = youngs_modulus_factor(tissue_kg_m3)};
}

const std::array presets = {
    DistributionPreset{"finger-skin", "c_s_m_s", skin_of(30.3, 12.1, 48.4)},
    DistributionPreset{"forearm-skin", "c_s_m_s", skin_of(14.8, 3.5, 26.0)},
    DistributionPreset{"chest-skin", "c_s_m_s", skin_of(17.8, 6.6, 28.9)},
    DistributionPreset{"abdomen-skin", "c_s_m_s", skin_of(9.5, 3.5, 15.5)},
    // Surface waves of 100 to 400 Hz on the forearm, Zhang 2011 (PMID 20888282): shear elasticity
    // 7.86 +- 1.86 kPa, shear viscosity 5.03 +- 0.60 Pa s. Ours: normal distributions, truncated to
    // above 1 kPa and 0.1 Pa s; 1000 kg/m3.
    DistributionPreset{"forearm-surface-waves",
                       "c_s_m_s",
                       {.shape = sampling::Normal{7.86, 1.86},
                        .least = 1.0,
                        .root_of = shear_modulus_factor(tissue_kg_m3)}},
    DistributionPreset{"forearm-viscosity",
                       "viscosity_Pa_s",
                       {.shape = sampling::Normal{5.03, 0.60}, .least = 0.1}},
    // Biopsies of the dorsal forearm of 71 volunteers, Sandby-Moller 2003 (doi
    // 10.1080/00015550310015419): stratum corneum 18.3 (SD 4.9) um and cellular epidermis 56.6 (SD
    // 11.5) um. Ours: their sum with independent normal distributions, truncated to above 0.02 mm.
    DistributionPreset{"forearm-epidermis",
                       "thickness_mm",
                       {.shape = sampling::Normal{0.0749, 0.0125}, .least = 0.02}},
};

const std::vector<std::string> shapes = {"uniform", "normal", "lognormal", "triangular", "csv"};
const std::vector<std::string> moduli = {"youngs_modulus_kPa", "shear_modulus_kPa"};

constexpr std::size_t most_observations = 1'000'000;

/// The numbers of a column of a CSV file in ascending order, or the reason why it was rejected.
struct Column {
    std::vector<double> values;
    std::string problem;
};

Column column_of(std::string_view csv, const std::string& name) {
    Column column;
    std::optional<std::size_t> place;
    column.problem = first_problem(csv, [&](const CsvReader& row) -> std::string {
        const auto& cells = row.cells();
        if (!place) {
            const auto found = std::ranges::find(cells, name);
            if (found == cells.end())
                return fmt::format("has no column \"{}\"; it must name the columns", excerpt(name));
            place = static_cast<std::size_t>(found - cells.begin());
            return "";
        }
        const auto value = *place < cells.size() ? finite_number_in(cells[*place]) : std::nullopt;
        if (!value)
            return fmt::format("has no finite number in the column \"{}\": \"{}\"", excerpt(name),
                               excerpt(row.text()));
        if (column.values.size() == most_observations)
            return fmt::format("has more than {} values", most_observations);
        column.values.push_back(*value);
        return "";
    });
    if (!column.problem.empty()) return column;
    if (!place) return {{}, "is empty; its first line must name the columns"};
    if (column.values.size() < 2)
        return {{}, fmt::format("has fewer than two values in the column \"{}\"", excerpt(name))};
    std::ranges::sort(column.values);
    return column;
}

sampling::Empirical read_samples(Reader& reader, const FileLoaders& files) {
    const std::string file = reader.word("file"), name = reader.word("column");
    const auto text = load_named(reader, "file", files.load_text);
    if (!text || name.empty()) return {{0.0, 1.0}};
    Column column = column_of(*text, name);
    if (column.problem.empty()) return {std::move(column.values)};
    reader.error("file", fmt::format("{} {}", excerpt(file), column.problem));
    return {{0.0, 1.0}};
}

/// Uniform and triangular distributions have ends of their own; others are truncated.
std::optional<Distribution> read_shape(Reader& reader, const FileLoaders& files) {
    const auto shape = reader.find_choice("distribution", shapes);
    reader.report_missing("distribution");
    if (!shape) return std::nullopt;
    const auto number = [&](const char* key) { return reader.number(key, Range::any()); };
    if (shape == "uniform")
        return Distribution{.shape = sampling::Uniform{number("min"), number("max")}};
    if (shape == "triangular")
        return Distribution{.shape =
                                sampling::Triangular{number("min"), number("mode"), number("max")}};
    Distribution d;
    if (shape == "normal")
        d.shape = sampling::Normal{number("mean"), number("sd")};
    else if (shape == "lognormal")
        d.shape = sampling::LogNormal{number("median"), number("geometric_sd")};
    else
        d.shape = read_samples(reader, files);
    if (const auto least = reader.find_number("min", Range::any())) d.least = *least;
    if (const auto most = reader.find_number("max", Range::any())) d.most = *most;
    return d;
}

/// `of`: the numbers are moduli, from which the shear-wave speed follows.
void read_modulus(Reader& reader, const std::string& key, Distribution& d) {
    const auto modulus = reader.find_choice("of", moduli);
    const double density = reader.number_or("density_kg_m3", tissue_kg_m3,
                                            range_of<DistributionKeys>("density_kg_m3"));
    if (!modulus) return;
    if (!key.ends_with("c_s_m_s"))
        reader.error("of", fmt::format("is only possible for keys that end in c_s_m_s, not for {}",
                                       excerpt(key)));
    d.root_of =
        *modulus == moduli.front() ? youngs_modulus_factor(density) : shear_modulus_factor(density);
}

std::optional<Distribution> preset_of(Reader& reader, const std::string& key) {
    const std::string name = reader.choice("preset", distribution_preset_names());
    for (const DistributionPreset& preset : presets) {
        if (preset.name != name) continue;
        if (!key.ends_with(preset.ending))
            reader.error("preset", fmt::format("\"{}\" is a distribution of {}, not of {}", name,
                                               preset.ending, excerpt(key)));
        return preset.distribution;
    }
    return std::nullopt;
}

} // namespace

std::vector<std::string> distribution_preset_names() {
    std::vector<std::string> names;
    for (const DistributionPreset& preset : presets)
        names.emplace_back(preset.name);
    return names;
}

std::optional<Distribution> read_distribution(Reader reader, const std::string& key,
                                              const FileLoaders& files) {
    const std::size_t before = reader.diagnostics().errors();
    std::optional<Distribution> d;
    if (reader.has("preset")) {
        d = preset_of(reader, key);
    } else if (d = read_shape(reader, files); d) {
        read_modulus(reader, key, *d);
    }
    if (!d) return std::nullopt;
    reader.finish();
    if (reader.diagnostics().errors() != before) return std::nullopt;
    const auto problem = sampling::problem_of(*d);
    if (!problem) return d;
    reader.diagnostics().error(reader.place("distribution"),
                               fmt::format("uncertain: the distribution of {} {}", key, *problem));
    return std::nullopt;
}

} // namespace shearwake::config
