// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/study.hpp"

#include "base/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::optimise {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Eigen::VectorXd& values) {
    return std::vector<double>(values.begin(), values.end());
}

Json json_of(const Eigen::MatrixXd& matrix) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        rows.push_back(json_of(Eigen::VectorXd(matrix.row(i))));
    return rows;
}

Json json_of(const Envelope& envelope) {
    return {{"values", json_of(envelope.values)},
            {"eta", envelope.eta},
            {"strength", envelope.strength}};
}

Eigen::VectorXd vector_of(const Json& json) {
    const auto values = json.get<std::vector<double>>();
    return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

Eigen::MatrixXd matrix_of(const Json& json) {
    const auto size = static_cast<Eigen::Index>(json.size());
    Eigen::MatrixXd matrix(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        matrix.row(i) = vector_of(json.at(static_cast<std::size_t>(i)));
    return matrix;
}

Envelope envelope_of(const Json& json) {
    return {.values = vector_of(json.at("values")),
            .eta = json.at("eta").get<double>(),
            .strength = json.at("strength").get<double>()};
}

/// What `use` reads from the JSON text.
auto read(const std::string& text, const std::string& name, const auto& use) {
    try {
        return use(Json::parse(text));
    } catch (const Json::exception& error) {
        throw UsageError(
            fmt::format("{} is damaged ({}); remove it, and rerun the command", name, error.what()),
            ExitCode::environment);
    }
}

} // namespace

std::string forms_text(const std::string& id, const Knots& knots, const Forms& forms) {
    Json path = Json::array();
    for (const Eigen::MatrixXd& form : forms.path)
        path.push_back(json_of(form));
    return Json({{"schema", 1},
                 {"case", id},
                 {"knots",
                  {{"count", knots.count},
                   {"interval_s", knots.interval_s},
                   {"repeat", knots.repeat}}},
                 {"numerator", json_of(forms.numerator)},
                 {"denominator", json_of(forms.denominator)},
                 {"focal", json_of(forms.focal)},
                 {"reference", forms.reference_energy()},
                 {"path", std::move(path)}})
               .dump() +
           "\n";
}

Forms read_forms(const std::string& text, const std::string& name) {
    return read(text, name, [](const Json& json) {
        Forms forms{.numerator = matrix_of(json.at("numerator")),
                    .denominator = matrix_of(json.at("denominator")),
                    .focal = matrix_of(json.at("focal")),
                    .reference = json.at("reference").get<double>()};
        for (const Json& form : json.value("path", Json::array()))
            forms.path.push_back(matrix_of(form));
        return forms;
    });
}

std::string optimum_text(const std::string& id, const std::string& forms_id,
                         const Optimum& optimum) {
    return Json({{"schema", 1},
                 {"case", id},
                 {"forms", forms_id},
                 {"strength_at_least", optimum.strength},
                 {"motion",
                  {{"size", optimum.change.size},
                   {"speed", optimum.change.speed},
                   {"periods", optimum.change.periods},
                   {"sine", optimum.change.sine},
                   {"cosine", optimum.change.cosine}}},
                 {"found", json_of(optimum.found)},
                 {"ceiling",
                  {{"eta", optimum.ceiling.eta},
                   {"mu", optimum.ceiling.mu},
                   {"tau", optimum.ceiling.tau},
                   {"weights", json_of(optimum.ceiling.weights)}}},
                 {"am",
                  {{"frequency_Hz", optimum.am.frequency_Hz},
                   {"depth", optimum.am.depth},
                   {"phase_rad", optimum.am.phase_rad},
                   {"envelope", json_of(optimum.am.envelope)}}},
                 {"eta_unmodulated", optimum.eta_unmodulated}})
               .dump() +
           "\n";
}

Optimum read_optimum(const std::string& text, const std::string& name) {
    return read(text, name, [](const Json& json) {
        const Json &ceiling = json.at("ceiling"), &am = json.at("am"), &motion = json.at("motion");
        const double strength = json.at("strength_at_least").get<double>();
        return Optimum{.strength = strength,
                       .change = {.size = motion.at("size").get<double>(),
                                  .speed = motion.at("speed").get<double>(),
                                  .periods = motion.at("periods").get<int>(),
                                  .sine = motion.at("sine").get<double>(),
                                  .cosine = motion.at("cosine").get<double>()},
                       .found = envelope_of(json.at("found")),
                       .ceiling = {.strength = strength,
                                   .eta = ceiling.at("eta").get<double>(),
                                   .mu = ceiling.at("mu").get<double>(),
                                   .tau = ceiling.at("tau").get<double>(),
                                   .weights = vector_of(ceiling.at("weights"))},
                       .am = {.frequency_Hz = am.at("frequency_Hz").get<double>(),
                              .depth = am.at("depth").get<double>(),
                              .phase_rad = am.at("phase_rad").get<double>(),
                              .envelope = envelope_of(am.at("envelope"))},
                       .eta_unmodulated = json.at("eta_unmodulated").get<double>()};
    });
}

} // namespace shearwake::optimise
