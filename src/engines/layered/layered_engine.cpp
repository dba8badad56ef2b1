#include "engines/layered/layered_engine.hpp"

#include "base/error.hpp"
#include "engines/layered/load_spectrum.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace shearwake {
namespace {

using Complex = std::complex<double>;

/// The spectra of all frames at once may be large: above this the time transforms are done again
/// for each batch of frames.
constexpr double largest_batch_B = 200e6;
/// Lines (kx) that are turned from time order to frame order together: two cache lines a frame.
constexpr std::ptrdiff_t lines_together = 8;

TransferKey key_of(const Case& c, const LayeredOptions& options) {
    return {.medium = c.medium,
            .depths_m = c.measure.depths_m,
            .nx = c.domain.nx,
            .ny = c.domain.ny,
            .spacing_m = c.domain.spacing_m,
            .time = time_transform(c, options),
            .tolerance = options.interpolation_tolerance};
}

/// The same for the stress at receptors.
TransferKey stress_key_of(const Case& c, const LayeredOptions& options) {
    TransferKey key = key_of(c, options);
    key.depths_m = stress_depths_m(c);
    key.quantity = StackQuantity::compression;
    return key;
}

std::ptrdiff_t frames_per_batch(const Case& c, std::ptrdiff_t ky_count) {
    const double frame_B =
        static_cast<double>(c.domain.nx) * static_cast<double>(ky_count) * sizeof(Complex);
    const auto fitting = static_cast<std::ptrdiff_t>(largest_batch_B / std::max(frame_B, 1.0));
    return std::clamp<std::ptrdiff_t>(fitting, 1, c.time.frames);
}

/// Spectra of the surface field, u_z(ky, kx) of this rank's rows, at a batch of frames.
class FieldSpectra {
public:
    FieldSpectra(const Case& c, const TransferKey& key, const SlabShare& share,
                 std::ptrdiff_t most_frames, AlignedVector<Complex>& memory)
        : case_(c), time_(key.time), share_(share), per_frame_(samples_per_frame(c, key.time)),
          coarse_(key.time.samples / per_frame_),
          load_(c, key.time, share.ky_start, share.ky_count),
          backward_(coarse_, Direction::backward),
          lines_(static_cast<std::size_t>(coarse_ * lines_together)), spectra_(memory) {
        const auto needed = static_cast<std::size_t>(most_frames * plane());
        if (spectra_.size() < needed) spectra_.resize(needed);
    }

    std::ptrdiff_t plane() const { return share_.ky_count * case_.domain.nx; }
    const Complex* frame(std::ptrdiff_t in_batch) const {
        return spectra_.data() + in_batch * plane();
    }

    void compute(TransferTable& table, std::size_t depth, std::ptrdiff_t first,
                 std::ptrdiff_t count) {
        const std::ptrdiff_t nx = case_.domain.nx;
        for (std::ptrdiff_t ky = 0; ky < share_.ky_count; ++ky) {
            const auto h = table.row(ky, depth);
            for (std::ptrdiff_t kx = 0; kx < nx; kx += lines_together) {
                const std::ptrdiff_t lines = std::min(lines_together, nx - kx);
                for (std::ptrdiff_t l = 0; l < lines; ++l)
                    respond(kx + l, ky, h, lines_.data() + l * coarse_);
                scatter(ky, kx, lines, first, count);
            }
        }
    }

private:
    /// One wave vector: load times H, back to time at the frames only.
    void respond(std::ptrdiff_t kx, std::ptrdiff_t ky, std::span<const Complex> h_row,
                 Complex* line) {
        const std::ptrdiff_t nx = case_.domain.nx, ny = case_.domain.ny;
        const std::ptrdiff_t global_ky = share_.ky_start + ky;
        std::fill_n(line, coarse_, Complex(0.0));
        if (2 * kx == nx || 2 * global_ky == ny) return; // Nyquist modes carry no load

        const Complex pattern = load_.factor(kx, global_ky);
        if (pattern == 0.0) return;
        const auto load = load_.line(kx, global_ky);
        const std::ptrdiff_t samples = time_.samples, frequencies = samples / 2 + 1;
        const Complex* h = h_row.data() + std::min(kx, nx - kx) * frequencies;
        // Frequencies above the frames' own fold onto them: sampled at the frames the sum is exact.
        // H(-omega*) = H(omega)*; the Nyquist frequency of the load is dropped.
        for (std::ptrdiff_t block = 0; block < samples; block += coarse_) {
            const std::ptrdiff_t end = block + coarse_;
            for (std::ptrdiff_t m = block; m < std::min(end, samples / 2); ++m)
                line[m - block] += h[m] * load[static_cast<std::size_t>(m)];
            for (std::ptrdiff_t m = std::max(block, samples / 2 + 1); m < end; ++m)
                line[m - block] += std::conj(h[samples - m]) * load[static_cast<std::size_t>(m)];
        }
        backward_.execute(line);

        const Complex scale =
            case_.load.peak_Pa * pattern /
            (case_.domain.extent_x_m() * case_.domain.extent_y_m() * static_cast<double>(samples));
        for (std::ptrdiff_t n = 0; n < coarse_; ++n)
            line[n] *= scale;
    }

    /// Frames of a few neighbouring lines to their places in the batch, grown by e^{+decay t}.
    void scatter(std::ptrdiff_t ky, std::ptrdiff_t kx, std::ptrdiff_t lines, std::ptrdiff_t first,
                 std::ptrdiff_t count) {
        for (std::ptrdiff_t n = 0; n < count; ++n) {
            const double growth = std::exp(time_.decay_rad_s * case_.time.frame_s(first + n));
            Complex* out = spectra_.data() + n * plane() + ky * case_.domain.nx + kx;
            for (std::ptrdiff_t l = 0; l < lines; ++l)
                out[l] = growth * lines_[static_cast<std::size_t>(l * coarse_ + first + n + 1)];
        }
    }

    const Case& case_;
    TimeTransform time_;
    SlabShare share_;
    std::ptrdiff_t per_frame_, coarse_;
    LoadSpectrum load_;
    LineTransform backward_;
    AlignedVector<Complex> lines_;
    AlignedVector<Complex>& spectra_;
};

} // namespace

Estimate LayeredEngine::estimate(const Case& c, int ranks) const {
    const auto& options = std::get<LayeredOptions>(c.solver);
    const TransferKey key = key_of(c, options);
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    const double depths =
        static_cast<double>(c.measure.depths_m.size() + stress_depths_m(c).size());
    const std::ptrdiff_t modes = c.domain.ny / 2 + 1;
    const std::ptrdiff_t ky_count = (modes + ranks - 1) / ranks;
    const double batch = static_cast<double>(frames_per_batch(c, ky_count) * ky_count) *
                         static_cast<double>(c.domain.nx) * sizeof(Complex);
    const double table = TransferTable::expanded_bytes(key, ky_count) +
                         TransferTable::expanded_bytes(stress_key_of(c, options), ky_count);
    const bool kept = table <= TransferTable::largest_expansion_B;
    Estimate e;
    // The program itself, spectra, H, the load's phases, the plane that is transformed.
    e.memory_per_rank_B = 60e6 + batch + (kept ? table : 0.0) + points * sizeof(double) / ranks +
                          static_cast<double>(c.domain.nx * key.time.samples) * sizeof(Complex) +
                          LoadSpectrum::memory_B(c, key.time, ky_count);
    // Seconds per point and time sample, per point and frame, and per layer and frequency, as
    // `shearwake bench layered` finds them on one core of a 2020s server.
    e.seconds = depths * points *
                (1.5e-9 * static_cast<double>(key.time.samples) * (kept ? 1.0 : 3.0) +
                 7e-9 * static_cast<double>(c.time.frames));
    e.shared_seconds = static_cast<double>(key.time.samples) *
                       (1.8e-4 * static_cast<double>(c.medium.layers.size()) + 2.5e-9 * points);
    e.useful_ranks = static_cast<int>(std::min(c.domain.nx, modes));
    return e;
}

void LayeredEngine::prepare(const Case& c, const Comm& team) {
    if (!slabs_ || slabs_nx_ != c.domain.nx || slabs_ny_ != c.domain.ny) {
        slabs_ = std::make_unique<SlabTransform>(c.domain.nx, c.domain.ny, team);
        slabs_nx_ = c.domain.nx;
        slabs_ny_ = c.domain.ny;
        table_.reset();
    }
    const auto& options = std::get<LayeredOptions>(c.solver);
    keep_table(table_, key_of(c, options), team);
    const TransferKey stress = stress_key_of(c, options);
    if (stress.depths_m.empty())
        stress_table_.reset();
    else
        keep_table(stress_table_, stress, team);
}

void LayeredEngine::keep_table(std::unique_ptr<TransferTable>& table, const TransferKey& key,
                               const Comm& team) {
    if (table && table->key() == key) return;
    table.reset(); // before the next one: two would not fit where one does
    const SlabShare& share = slabs_->share();
    table = std::make_unique<TransferTable>(key, share.ky_start, share.ky_count, team);
}

void LayeredEngine::run(const Case& c, const Comm& team, Observer& observer,
                        Checkpoints* /*checkpoints*/) {
    prepare(c, team);
    const SlabShare& share = slabs_->share();
    // The batch is the same on all ranks: the largest slab decides.
    const auto largest = static_cast<std::ptrdiff_t>(team.max(static_cast<int>(share.ky_count)));
    const std::ptrdiff_t batch = frames_per_batch(c, largest);
    std::optional<FieldSpectra> spectra;
    AlignedVector<double> plane;
    together(team, [&] {
        spectra.emplace(c, table_->key(), share, batch, batch_);
        plane.resize(static_cast<std::size_t>(share.reals));
    });

    observer.begin({share.x_start, share.x_count});
    const auto each_frame = [&](TransferTable& table, std::size_t depths, const auto& give) {
        for (std::size_t depth = 0; depth < depths; ++depth) {
            for (std::ptrdiff_t first = 0; first < c.time.frames; first += batch) {
                const std::ptrdiff_t count = std::min(batch, c.time.frames - first);
                spectra->compute(table, depth, first, count);
                for (std::ptrdiff_t n = 0; n < count; ++n) {
                    std::copy_n(reinterpret_cast<const double*>(spectra->frame(n)),
                                2 * spectra->plane(), plane.data());
                    slabs_->to_physical(plane.data());
                    give(first + n, depth,
                         View2<const double>(plane.data(), share.x_count, c.domain.ny,
                                             share.padded_ny));
                }
            }
        }
    };
    each_frame(*table_, c.measure.depths_m.size(),
               [&](std::ptrdiff_t n, std::size_t depth, View2<const double> values) {
                   observer.frame({.number = n, .depth = depth, .u_z_m = values});
               });
    if (!stress_table_) return;
    each_frame(*stress_table_, stress_depths_m(c).size(),
               [&](std::ptrdiff_t n, std::size_t depth, View2<const double> values) {
                   observer.stress({.number = n, .depth = depth, .compression_Pa = values});
               });
}

} // namespace shearwake
