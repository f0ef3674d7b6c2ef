/*
 * The part of host.cpp about spectra: vectors for memory, exceptions for statuses, the bits of Rust; and the shot noise of particles.
 */

/* A binning that keeps its own edges. */
class Shells {
public:
    explicit Shells(std::vector<std::uint64_t> edges) : edges_(std::move(edges)) {
        must(fixpair_binning_init(&binning, edges_.data(), edges_.size()));
    }
    Shells(const Shells &) = delete;
    Shells &operator=(const Shells &) = delete;
    const std::vector<std::uint64_t> &edges() const { return edges_; }
    fixpair_binning binning;

private:
    std::vector<std::uint64_t> edges_;
};

/* Sums of spectra, and what is read from them. */
struct Spectra {
    std::vector<std::int64_t> sums;
    std::vector<fixpair_bin> bins;
    std::vector<double> values;
    fixpair_layout layout;
};

template <class T>
Spectra spectra(const std::vector<const T *> &fields, std::size_t length, const std::vector<std::size_t> &pairs,
                const std::vector<std::int32_t> &compensation, const fixpair_brick &brick, const fixpair_binning &binning,
                const fixpair_exec *exec) {
    std::size_t bins, values, words;
    Spectra result;
    must(fixpair_binning_lengths(&bins, &values, &words, &binning, pairs.size() / 2));
    result.sums.resize(words);
    result.bins.resize(bins);
    result.values.resize(values);
    must(fixpair_power_sums_scratch(&result.layout, &brick, &binning, pairs.size() / 2));
    Memory scratch(result.layout.size);
    must(Names<T>::power_sums(result.sums.data(), words, fields.data(), fields.size(), length, pairs.data(), pairs.size() / 2,
                              compensation.data(), &brick, &binning, scratch.data(), scratch.size(), exec));
    must(fixpair_binning_read(result.bins.data(), bins, result.values.data(), values, result.sums.data(), words, &binning,
                              pairs.size() / 2));
    return result;
}

/* Particles at random have the power V/N, aliased or not. */
template <class T>
void shot_noise(const Transform<T> &fft, const fixpair_exec *exec) {
    const std::size_t count = 20000;
    std::vector<Particle<T>> particles(count);
    for (std::size_t i = 0; i < count; i++) {
        for (std::size_t axis = 0; axis < 3; axis++) {
            /* Neighbours of one multiplicative sequence are no random triples: every axis has its own. */
            std::uint64_t z = (3 * i + axis + 1) * UINT64_C(0x9e3779b97f4a7c15);
            z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
            z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
            particles[i].position[axis] = static_cast<T>(BOX * (static_cast<double>((z ^ (z >> 31)) >> 11) / 9007199254740992.0));
        }
    }
    const auto *hook = fft.get();
    const T *first = particles[0].position;
    const typename Names<T>::Positions places = {first, first + 1, first + 2, sizeof(Particle<T>) / sizeof(T), count};
    fixpair_layout layout;
    must(Names<T>::deposit_scratch(&layout, &hook->configuration, count, FIXPAIR_WINDOW_TSC));
    Memory scratch(layout.size), mesh(hook->length * sizeof(T));
    T *data = static_cast<T *>(mesh.data());
    must(Names<T>::deposit(data, hook->length, &hook->configuration, &places, nullptr, 0, BOX, FIXPAIR_WINDOW_TSC, 0.0,
                           scratch.data(), scratch.size(), exec));
    CHECK(hook->forward(hook->context, data) == 0);
    const Shells shells({1, 36});
    auto found = spectra<T>({data}, hook->length, {0, 0}, {FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_TSC},
                            hook->fourier, shells.binning, exec);
    must(fixpair_binning_normalise(found.values.data(), 1, found.bins.data(), 1, 1,
                                   BOX * BOX * BOX / (static_cast<double>(count) * static_cast<double>(count))));
    /* Half of the modes are independent: five standard deviations. */
    const double noise = BOX * BOX * BOX / count, error = noise * std::sqrt(2.0 / static_cast<double>(found.bins[0].count));
    CHECK(std::abs(found.values[0] - noise) < 5 * error);
}

template <class T>
void estimates(const fixpair_exec *exec) {
    const Transform<T> fft(N, exec);
    const auto *hook = fft.get();
    fixpair_realisation realisation;
    must(fixpair_realisation_init(&realisation, SEED));
    std::vector<T> f(hook->length), g(hook->length);
    must(Names<T>::white_modes(f.data(), f.size(), &hook->fourier, &realisation, nullptr, 0, exec));
    realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    realisation.phase = FIXPAIR_PHASE_INVERTED;
    must(Names<T>::white_modes(g.data(), g.size(), &hook->fourier, &realisation, nullptr, 0, exec));
    Shells shells({1, 4, 9, 16, 25, 36, 49});
    shells.binning.axis[2] = 2;
    shells.binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4;
    const auto power = spectra<T>({f.data(), g.data()}, f.size(), {0, 0, 0, 1},
                                  {FIXPAIR_COMPENSATION_NONE, FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_CIC},
                                  hook->fourier, shells.binning, exec);
    const std::uint64_t sizes[2] = {power.layout.size, power.layout.align};
    check_case((std::string("power_sums") + Names<T>::ending()).c_str(),
               hash_bytes(hash_bytes(HASH_START, sizes, sizeof sizes), power.sums.data(),
                          power.sums.size() * sizeof power.sums[0]));

    const auto &edges = shells.edges();
    const std::size_t edges_len = 6;
    std::size_t count, reals, transforms;
    must(fixpair_closed_triangle_count(&count, edges.data(), edges_len, nullptr));
    std::vector<std::uint32_t> triangles(3 * count);
    must(fixpair_closed_triangles(triangles.data(), count, edges.data(), edges_len, nullptr));
    must(Names<T>::bispectrum_meshes(&reals, hook, 4));
    fixpair_layout layout;
    must(Names<T>::bispectrum_scratch(&layout, hook, edges_len - 1, count));
    Memory fields(reals * sizeof(T)), scratch(layout.size);
    std::vector<std::int64_t> sums(count * FIXPAIR_BISPECTRUM_WORDS);
    must(Names<T>::bispectrum(sums.data(), sums.size(), &transforms, triangles.data(), count, edges.data(), edges_len, f.data(), f.size(),
                              hook, static_cast<T *>(fields.data()), reals, scratch.data(), scratch.size(), exec));
    CHECK(transforms >= edges_len - 1);
    check_case((std::string("bispectrum_sums") + Names<T>::ending()).c_str(),
               hash_bytes(HASH_START, sums.data(), sums.size() * sizeof sums[0]));
    shot_noise<T>(fft, exec);
}
