// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/rates.hpp"

#include "base/cache.hpp"
#include "base/error.hpp"
#include "pipeline/provenance.hpp"
#include "simd/instruction_set.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace shearwake::cost {
namespace {

using Json = nlohmann::ordered_json;

/// More rates are not stored: the oldest are dropped.
constexpr std::size_t most_rates = 500;
/// Sizes whose binary logarithms differ by less share a rate, or have rates that replace each
/// other.
constexpr double similar_size = 0.5, same_size = 0.25;
/// The rate of unknown kinds.
constexpr double arbitrary_s = 1e-9;

double octaves(double a, double b) {
    return std::abs(std::log2(a / b));
}

/// The kind without the hash of bodies.
std::string family(const std::string& kind) {
    return kind.substr(0, kind.find('#'));
}

/// The part after the hash, such as ", steps".
std::string part_of(const std::string& kind) {
    const std::size_t hash = kind.find('#');
    return hash == std::string::npos ? ""
                                     : kind.substr(std::min(kind.find(',', hash), kind.size()));
}

/// Determined once, since it queries the version of HDF5, which must not be called from several
/// threads.
const std::string& program() {
    static const std::string text = pipeline::version_text();
    return text;
}

Json json_of(const Rates& rates) {
    Json all = Json::array();
    for (const Rate& rate : rates.all())
        all.push_back({{"kind", rate.kind},
                       {"size", rate.size},
                       {"ranks", rate.ranks},
                       {"core_s", rate.core_s},
                       {"is_probed", rate.is_probed}});
    return {{"processor", processor_key()}, {"program", program()}, {"rates", all}};
}

/// Rejects values that an edited file could contain and that would make estimates meaningless.
double positive(const Json& value) {
    const double number = value;
    if (!std::isfinite(number) || number <= 0.0) throw Error("not positive");
    return number;
}

Rates rates_in(const Json& json) {
    Rates rates;
    for (const Json& one : json.at("rates"))
        rates.add({.kind = one.at("kind"),
                   .size = positive(one.at("size")),
                   .ranks = static_cast<int>(positive(one.at("ranks"))),
                   .core_s = positive(one.at("core_s")),
                   .is_probed = one.at("is_probed")});
    return rates;
}

} // namespace

void Rates::add(const engines::TimedWork& part, int ranks, bool is_probed) {
    const double amount = part.work.amount();
    if (!(amount > 0.0) || !(part.seconds > 0.0)) return;
    add({part.work.kind, part.work.size, ranks, part.seconds * ranks / amount, is_probed});
}

void Rates::add(Rate rate) {
    const auto same = std::ranges::find_if(all_, [&](const Rate& other) {
        return other.kind == rate.kind && other.ranks == rate.ranks &&
               octaves(other.size, rate.size) < same_size;
    });
    if (same != all_.end()) {
        if (rate.is_probed && !same->is_probed) return;
        if (rate.is_probed == same->is_probed) rate.core_s = 0.5 * (rate.core_s + same->core_s);
        all_.erase(same);
    }
    all_.push_back(std::move(rate));
    if (all_.size() > most_rates) all_.erase(all_.begin());
}

Rates::Found Rates::of(const engines::Work& part, int ranks) const {
    const Rate* best = nullptr;
    double best_distance = std::numeric_limits<double>::infinity();
    const std::string its_family = family(part.kind), its_part = part_of(part.kind);
    for (const Rate& rate : all_) {
        const bool same = rate.kind == part.kind;
        if (!same && (family(rate.kind) != its_family || part_of(rate.kind) != its_part)) continue;
        const double distance = octaves(rate.size, part.size) + 0.25 * octaves(rate.ranks, ranks) +
                                (same ? 0.0 : 100.0);
        if (distance > best_distance) continue; // of equal ones, the newest
        best = &rate;
        best_distance = distance;
    }
    if (!best) return {arbitrary_s, Origin::unknown};
    const bool fits = best->kind == part.kind && best->ranks == ranks &&
                      octaves(best->size, part.size) < similar_size;
    return {best->core_s, !fits             ? Origin::similar
                          : best->is_probed ? Origin::probed
                                            : Origin::measured};
}

std::optional<std::filesystem::path> rates_file(int ranks) {
    return cache_file(fmt::format("rates-{}-{}-{}.json", processor_key(),
                                  simd::name_of(simd::instruction_set()), ranks));
}

Rates read_rates(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return {};
    try {
        const Json json = Json::parse(storage::read_file(file));
        if (json.at("processor") != processor_key() || json.at("program") != program()) return {};
        return rates_in(json);
    } catch (const std::exception&) {
        return {};
    }
}

bool save_rates(const Rates& rates, const std::filesystem::path& file) {
    Rates all = read_rates(file); // which other processes may have extended
    for (const Rate& rate : rates.all())
        all.add(rate);
    return replace_cached(file, json_of(all).dump(1) + "\n");
}

Rates rates_of_root(const Rates& rates, const Comm& world) {
    // Processors may differ between hosts, so the processor is not compared: rank 0 decides.
    const std::string text = world.broadcast(world.is_root() ? json_of(rates).dump() : "");
    return rates_in(Json::parse(text));
}

Rates known_rates(int ranks, const Comm& world) {
    Rates known;
    if (world.is_root())
        for (const int of : {ranks, world.size()}) {
            const auto file = rates_file(of);
            if (file) known = read_rates(*file);
            if (!known.all().empty()) break;
        }
    return rates_of_root(known, world);
}

} // namespace shearwake::cost
