/*
 * The part of host.cpp about the third order, shapes, species and glasses: a host that builds what it wants from vectors, and two
 * ranks.
 */

/* Columns of a Boltzmann code that live as long as the species that borrows them. */
class Columns {
public:
    explicit Columns(bool with_reference) {
        fixpair_species both[2];
        fill_columns(columns_);
        make_species(both, columns_);
        species_ = both[with_reference ? 1 : 0];
    }
    Columns(const Columns &) = delete;
    Columns &operator=(const Columns &) = delete;
    const fixpair_species *get() const { return &species_; }

private:
    double columns_[COLUMNS][ROWS];
    fixpair_species species_;
};

/* Particles with velocities from positions of their own, which are the host's triples. */
template <class T>
fixpair_layout make_at(std::vector<Particle<T>> &particles, const std::vector<T> &glass, const fixpair_conditions &conditions,
                       const typename Names<T>::Fft *fft, const typename Names<T>::Fft *fine, const fixpair_exec *exec) {
    fixpair_layout layout;
    must(Names<T>::at_scratch(&layout, &conditions, particles.size(), fft, fine));
    Memory scratch(layout.size);
    const typename Names<T>::Positions begin = {glass.data(), glass.data() + 1, glass.data() + 2, 3, glass.size() / 3};
    const auto position = member(particles, &Particle<T>::position);
    const auto velocity = member(particles, &Particle<T>::velocity);
    must(Names<T>::at(&position, &velocity, &begin, &conditions, fft, fine, scratch.data(), scratch.size(), exec));
    return layout;
}

template <class T>
void beyond_second_order(const fixpair_exec *exec) {
    const Transform<T> fft(N, exec), fine(FINE, exec), finer(FINER, exec);
    const Columns alone(false), with_reference(true);
    const std::vector<fixpair_shape_row> kernel = {{2.0, 0.0, 0.0, 0.0}, {-1.5, -1.0, 0.0, 1.0}, {0.5, 1.0, -0.5, -0.5}};
    std::vector<T> glass;
    for (std::size_t i = 0; i < 3 * 500; i++) {
        glass.push_back(static_cast<T>(BOX * noise(i)));
    }
    const auto with = [&](std::int32_t order, std::int32_t shape, double g_nl, const fixpair_species *species) {
        auto conditions = universe(100, g_nl);
        conditions.order = order;
        conditions.shape = shape;
        conditions.rows = kernel.data();
        conditions.rows_len = kernel.size();
        conditions.species = species;
        return conditions;
    };
    struct {
        const char *name;
        fixpair_conditions conditions;
        const Transform<T> *fine;
        bool at;
    } const runs[] = {
        {"third", with(FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_LOCAL, 0, nullptr), nullptr, true},
        {"equilateral_exact", with(FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_EQUILATERAL, 0, nullptr), &fine, true},
        {"rows", with(FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_ROWS, 0, nullptr), nullptr, false},
        {"species", with(FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, 0, alone.get()), nullptr, false},
        {"species_first", with(FIXPAIR_ORDER_FIRST, FIXPAIR_SHAPE_LOCAL, 0, alone.get()), nullptr, true},
        {"everything", with(FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_ROWS, 1e5, with_reference.get()), &finer, true},
    };
    for (const auto &run : runs) {
        const auto *work = run.fine ? run.fine->get() : nullptr;
        std::vector<Particle<T>> lattice(N * N * N), own(glass.size() / 3);
        const auto check = [&](const char *call, const fixpair_layout &layout, const std::vector<Particle<T>> &particles) {
            const std::uint64_t sizes[2] = {layout.size, layout.align};
            const auto name = std::string(call) + run.name + Names<T>::ending();
            check_case(name.c_str(), hash_of(hash_bytes(HASH_START, sizes, sizeof sizes), particles));
        };
        check("initial.", make(lattice, run.conditions, fft.get(), work, exec), lattice);
        if (run.at) {
            check("initial_at.", make_at(own, glass, run.conditions, fft.get(), work, exec), own);
        }
    }
}

/* Slabs have the bits of the whole mesh, at third order and for any shape and species. */
template <class T>
void two_ranks_beyond_second_order() {
    const Columns species(true);
    const Transform<T> whole(N, nullptr);
    auto conditions = universe(100, 0);
    conditions.order = FIXPAIR_ORDER_THIRD;
    conditions.shape = FIXPAIR_SHAPE_EQUILATERAL;
    conditions.species = species.get();
    std::vector<Particle<T>> expected(N * N * N), together;
    make<T>(expected, conditions, whole.get(), nullptr, nullptr);
    Mesh<T> mesh(whole);
    Rank<T> low(mesh, 0), high(mesh, 1);
    std::thread other([&] { high.run(conditions); });
    low.run(conditions);
    other.join();
    together = low.particles;
    together.insert(together.end(), high.particles.begin(), high.particles.end());
    CHECK(hash_of(HASH_START, together) == hash_of(HASH_START, expected));
}
