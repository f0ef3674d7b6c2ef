/*
 * The half of conformance.c about the third order, shapes, species and the host's own positions that exists in both precisions.
 */

enum { X(OWN) = 500 };

/* A host's particle that knows where it begins. */
typedef struct {
    REAL mass;
    REAL begin[3];
    REAL position[3];
    REAL velocity[3];
} X(own_particle);

/* From positions all over the box and the one before it. */
static void X(universe_at)(const char *name, const fixpair_conditions *conditions, const X(fixpair_fft) *fft,
                           const X(fixpair_fft) *fine, const fixpair_exec *exec) {
    enum { REALS = sizeof(X(own_particle)) / sizeof(REAL) };
    fixpair_layout layout;
    void *scratch;
    int kind, axis, side;
    size_t i;
    MUST(X(fixpair_initial_conditions_at_scratch)(&layout, conditions, X(OWN), fft, fine));
    scratch = take_scratch(layout.size);
    for (kind = 0; kind < X(LAYOUTS); kind++) {
        /* Where the three triples begin, and from one component and one particle to the next. */
        size_t first = kind == X(MEMBERS) ? 1 : 0, apart = kind == X(MEMBERS) ? 3 : 3 * X(OWN);
        size_t step = kind == X(ARRAYS) ? X(OWN) : 1, stride = kind == X(ARRAYS) ? 1 : kind == X(TRIPLES) ? 3 : REALS;
        REAL *memory = X(reals)(REALS * X(OWN)), *begin = memory + first;
        X(fixpair_positions) pre_initial;
        X(fixpair_components) moved[2];
        uint64_t hash = hash_layout(HASH_START, layout);
        int untouched = 1;
        for (i = 0; i < 3 * X(OWN); i++) {
            begin[i / 3 * stride + i % 3 * step] = (REAL)(BOX * noise(i));
        }
        pre_initial.x = begin;
        pre_initial.y = begin + step;
        pre_initial.z = begin + 2 * step;
        pre_initial.stride = stride;
        pre_initial.length = X(OWN);
        for (side = 0; side < 2; side++) {
            moved[side].x = begin + (size_t)(side + 1) * apart;
            moved[side].y = moved[side].x + step;
            moved[side].z = moved[side].x + 2 * step;
            moved[side].stride = stride;
            moved[side].length = X(OWN);
        }
        MUST(X(fixpair_initial_conditions_at)(&moved[0], &moved[1], &pre_initial, conditions, fft, fine, scratch, layout.size,
                                              exec));
        for (side = 0; side < 2; side++) {
            for (i = 0; i < X(OWN); i++) {
                for (axis = 0; axis < 3; axis++) {
                    hash = hash_bytes(hash, moved[side].x + (size_t)axis * step + i * stride, sizeof(REAL));
                }
            }
        }
        check_named("initial_at.", name, SUFFIX, hash);
        for (i = 0; i < 3 * X(OWN); i++) {
            untouched &= begin[i / 3 * stride + i % 3 * step] == (REAL)(BOX * noise(i));
        }
        for (i = 0; kind == X(MEMBERS) && i < X(OWN); i++) {
            untouched &= ((X(own_particle) *)(void *)memory)[i].mass == 0;
        }
        CHECK(untouched);
        give_back(memory);
    }
    give_back(scratch);
}

/*
 * Particles that begin on the lattice of the mesh are those of the lattice, to rounding: in single precision a place is known to 1e-6 of
 * a cell, across which velocities change by some 100 km/s.
 */
static void X(lattice_of_its_own)(const fixpair_conditions *conditions, const X(fixpair_fft) *fft, const fixpair_exec *exec) {
    enum { PARTICLES = N * N * N };
    const double tolerance = sizeof(REAL) == 4 ? 1e-2 : 1e-10;
    REAL *memory = X(reals)(15 * PARTICLES);
    X(fixpair_components) of[4];
    X(fixpair_positions) lattice;
    fixpair_layout layout;
    void *scratch;
    size_t i;
    int near = 1;
    for (i = 0; i < 3 * PARTICLES; i++) {
        size_t particle = i / 3, cell = i % 3 == 0 ? particle / N / N : i % 3 == 1 ? particle / N % N : particle % N;
        memory[i] = (REAL)((double)cell * BOX / N);
    }
    lattice.x = memory;
    lattice.y = memory + 1;
    lattice.z = memory + 2;
    lattice.stride = 3;
    lattice.length = PARTICLES;
    for (i = 0; i < 4; i++) {
        of[i].x = memory + 3 * (i + 1) * PARTICLES;
        of[i].y = of[i].x + 1;
        of[i].z = of[i].x + 2;
        of[i].stride = 3;
        of[i].length = PARTICLES;
    }
    MUST(X(fixpair_initial_conditions_at_scratch)(&layout, conditions, PARTICLES, fft, NULL));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_initial_conditions)(&of[0], &of[1], conditions, fft, NULL, scratch, layout.size, exec));
    MUST(X(fixpair_initial_conditions_at)(&of[2], &of[3], &lattice, conditions, fft, NULL, scratch, layout.size, exec));
    for (i = 0; i < 6 * PARTICLES; i++) {
        double apart = fabs((double)of[0].x[i] - (double)of[2].x[i]);
        near &= apart <= tolerance || (i < 3 * PARTICLES && BOX - apart <= tolerance);
    }
    CHECK(near);
    give_back(scratch);
    give_back(memory);
}

static void X(beyond_second_order)(const fixpair_exec *exec) {
    fixpair_conditions local;
    fixpair_species species[2];
    double columns[COLUMNS][ROWS];
    X(built_in) transform, fine, finer;
    int i;
    fill_columns(columns);
    make_species(species, columns);
    X(open)(&transform, N, 0, exec);
    X(open)(&fine, FINE, 0, exec);
    X(open)(&finer, FINER, 0, exec);
    MUST(fixpair_conditions_init(&local, SEED));
    CHECK(local.shape == FIXPAIR_SHAPE_LOCAL && local.rows == NULL && local.rows_len == 0 && local.species == NULL);
    local.box_size = BOX;
    local.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    local.realisation.phase = FIXPAIR_PHASE_INVERTED;
    local.f_nl = 100.0;
    for (i = 0; i < UNIVERSES; i++) {
        const kind_of_universe *kind = &kinds_of_universes[i];
        const X(fixpair_fft) *work = kind->fine == 0 ? NULL : kind->fine == FINE ? &fine.fft : &finer.fft;
        fixpair_conditions conditions = local;
        conditions.order = kind->order;
        conditions.shape = kind->shape;
        conditions.rows = kernel;
        conditions.rows_len = kind->shape == FIXPAIR_SHAPE_ROWS ? sizeof kernel / sizeof *kernel : 0;
        conditions.g_nl = kind->g_nl;
        conditions.species = kind->species < 0 ? NULL : &species[kind->species];
        X(universe)(kind->name, &conditions, &transform.fft, work, exec);
        if (kind->at) {
            X(universe_at)(kind->name, &conditions, &transform.fft, work, exec);
        }
    }
    if (exec == NULL) {
        local.species = &species[1];
        X(lattice_of_its_own)(&local, &transform.fft, exec);
        local.order = FIXPAIR_ORDER_THIRD;
        X(lattice_of_its_own)(&local, &transform.fft, exec);
    }
    X(close)(&transform);
    X(close)(&fine);
    X(close)(&finer);
}
