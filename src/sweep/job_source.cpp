#include "sweep/job_source.hpp"

#include "base/error.hpp"
#include "io/files.hpp"
#include "parallel/agree.hpp"

namespace shearwake {

Override parse_override(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UsageError("-S wants key=value, as in -S load.peak_Pa=200; it got \"" + text + "\"");
    return {text.substr(0, equals), text.substr(equals + 1)};
}

Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
             const Comm& world) {
    std::vector<Override> parsed;
    for (const std::string& text : overrides)
        parsed.push_back(parse_override(text));
    std::string text;
    on_root(world, [&] { text = read_file(path); });
    return read_job(world.broadcast(std::move(text)), path.string(), parsed);
}

} // namespace shearwake
