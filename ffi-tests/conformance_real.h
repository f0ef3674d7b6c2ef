/*
 * The half of conformance.c that exists in both precisions. REAL is the element, X(name) the function, SUFFIX the end of a case's name.
 */

/* The built-in transform with the memory that it lives in. */
typedef struct {
    X(fixpair_fft) fft;
    void *tables, *scratch;
} X(built_in);

static void X(open)(X(built_in) *transform, size_t n, size_t padding, const fixpair_exec *exec) {
    fixpair_layout tables, scratch;
    MUST(X(fixpair_fft_tables_scratch)(&tables, n));
    MUST(X(fixpair_fft_scratch)(&scratch, n));
    transform->tables = take(tables.size);
    transform->scratch = take_scratch(scratch.size);
    MUST(X(fixpair_fft_tables_init)(transform->tables, tables.size, n));
    MUST(X(fixpair_fft_init)(&transform->fft, transform->tables, tables.size, padding, transform->scratch,
                             scratch.size, exec));
}

static void X(close)(X(built_in) *transform) {
    give_back(transform->tables);
    give_back(transform->scratch);
}

static REAL *X(reals)(size_t count) {
    return (REAL *)take(count * sizeof(REAL));
}

/* Exactly as many as the brick needs. */
static REAL *X(array_of)(const fixpair_brick *brick, size_t *length) {
    MUST(fixpair_brick_reals(length, brick));
    return X(reals)(*length);
}

static void X(transforms)(const fixpair_exec *exec) {
    uint64_t padding[300];
    fixpair_layout size, scratch;
    void *tables;
    size_t n, i;
    int padded;
    for (n = 0; n < 300; n++) {
        padding[n] = X(fixpair_fft_padding)(n);
    }
    check_named("fft_padding", "", SUFFIX, hash_bytes(HASH_START, padding, sizeof padding));
    MUST(X(fixpair_fft_tables_scratch)(&size, N));
    MUST(X(fixpair_fft_scratch)(&scratch, N));
    check_named("fft_sizes", "", SUFFIX, hash_layout(hash_layout(HASH_START, size), scratch));
    tables = take(size.size);
    MUST(X(fixpair_fft_tables_init)(tables, size.size, N));
    check_named("fft_tables", "", SUFFIX, hash_bytes(HASH_START, tables, size.size));
    give_back(tables);
    for (padded = 0; padded < 2; padded++) {
        X(built_in) transform;
        REAL *data;
        uint64_t hash;
        X(open)(&transform, N, padded ? PADDING : 0, exec);
        data = X(reals)(transform.fft.length);
        CHECK(X(fixpair_fft_self_test)(&transform.fft, data, transform.fft.length) == FIXPAIR_OK);
        for (i = 0; i < transform.fft.length; i++) {
            data[i] = (REAL)noise(i);
        }
        CHECK(transform.fft.forward(transform.fft.context, data) == 0);
        hash = hash_brick(HASH_START, data, &transform.fft.fourier, sizeof(REAL));
        CHECK(transform.fft.inverse(transform.fft.context, data) == 0);
        hash = hash_brick(hash, data, &transform.fft.configuration, sizeof(REAL));
        check_named("fft_pair", padded ? "_padded" : "", SUFFIX, hash);
        give_back(data);
        X(close)(&transform);
    }
}

static void X(whites)(const fixpair_exec *exec) {
    fixpair_brick bricks[BRICKS];
    fixpair_realisation normal, fixed, mean, ngenic, fastpm;
    X(built_in) transform;
    REAL *modes;
    size_t length, i;
    int b;
    make_bricks(bricks);
    MUST(fixpair_realisation_init(&normal, SEED));
    fixed = mean = normal;
    fixed.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    mean.amplitude = FIXPAIR_AMPLITUDE_FIXED_TO_MEAN;
    mean.phase = FIXPAIR_PHASE_INVERTED;
    mean.nyquist = FIXPAIR_NYQUIST_FILLED;
    ngenic = normal;
    ngenic.scheme = FIXPAIR_SCHEME_NGENIC;
    ngenic.selection = FIXPAIR_SELECTION_SPHERE;
    ngenic.sample = N - 3;
    fastpm = fixed;
    fastpm.scheme = FIXPAIR_SCHEME_FASTPM;
    fastpm.nyquist = FIXPAIR_NYQUIST_FILLED;
    for (b = 0; b < BRICKS; b++) {
        modes = X(array_of)(&bricks[b], &length);
        memset(modes, CANARY_BYTE, length * sizeof(REAL));
        MUST(X(fixpair_white_modes)(modes, length, &bricks[b], &normal, NULL, 0, exec));
        check_named("white_modes.", brick_names[b], SUFFIX, hash_brick(HASH_START, modes, &bricks[b], sizeof(REAL)));
        MUST(X(fixpair_white_modes)(modes, length, &bricks[b], &fixed, amplitude_table, table_length, exec));
        check_named("white_modes.coloured_", brick_names[b], SUFFIX,
                    hash_brick(HASH_START, modes, &bricks[b], sizeof(REAL)));
        MUST(X(fixpair_white_modes)(modes, length, &bricks[b], &ngenic, NULL, 0, exec));
        check_named("white_modes.ngenic_", brick_names[b], SUFFIX,
                    hash_brick(HASH_START, modes, &bricks[b], sizeof(REAL)));
        MUST(X(fixpair_white_modes)(modes, length, &bricks[b], &fastpm, amplitude_table, table_length, exec));
        check_named("white_modes.fastpm_", brick_names[b], SUFFIX,
                    hash_brick(HASH_START, modes, &bricks[b], sizeof(REAL)));
        MUST(X(fixpair_impose)(modes, length, &bricks[b], &fixed, exec));
        MUST(X(fixpair_scale_modes)(modes, length, &bricks[b], alpha_table, table_length, exec));
        CHECK(gaps_untouched(modes, length * sizeof(REAL), &bricks[b], sizeof(REAL)));
        give_back(modes);
    }
    modes = X(array_of)(&bricks[0], &length);
    MUST(X(fixpair_white_modes)(modes, length, &bricks[0], &mean, NULL, 0, exec));
    check_named("white_modes.mean", "", SUFFIX, hash_brick(HASH_START, modes, &bricks[0], sizeof(REAL)));
    MUST(X(fixpair_white_modes)(modes, length, &bricks[0], &normal, NULL, 0, exec));
    mean.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    MUST(X(fixpair_impose)(modes, length, &bricks[0], &mean, exec));
    check_named("impose", "", SUFFIX, hash_brick(HASH_START, modes, &bricks[0], sizeof(REAL)));
    give_back(modes);
    X(open)(&transform, N, 0, exec);
    modes = X(reals)(transform.fft.length);
    for (i = 0; i < transform.fft.length; i++) {
        modes[i] = (REAL)noise(i);
    }
    normal.phase = FIXPAIR_PHASE_INVERTED;
    MUST(X(fixpair_modes_from_field)(modes, transform.fft.length, &transform.fft, &normal, exec));
    check_named("modes_from_field", "", SUFFIX,
                hash_brick(HASH_START, modes, &transform.fft.fourier, sizeof(REAL)));
    give_back(modes);
    X(close)(&transform);
}

/* f_NL = 5000 and g_NL on a work mesh of the given side, added to a copy of Phi. */
static void X(local)(const char *name, const REAL *phi, const fixpair_brick *brick, size_t length, size_t side,
                     double g_nl, const fixpair_exec *exec) {
    X(built_in) work;
    fixpair_layout layout;
    REAL *modes = X(reals)(length), *mesh;
    void *scratch;
    X(open)(&work, side, 0, exec);
    MUST(X(fixpair_add_local_scratch)(&layout, &work.fft));
    scratch = take_scratch(layout.size);
    mesh = X(reals)(work.fft.length);
    memcpy(modes, phi, length * sizeof(REAL));
    MUST(X(fixpair_add_local)(modes, length, brick, 5000.0, g_nl, &work.fft, mesh, work.fft.length, scratch,
                              layout.size, exec));
    check_named("add_local.", name, SUFFIX, hash_brick(HASH_START, modes, brick, sizeof(REAL)));
    give_back(modes);
    give_back(mesh);
    give_back(scratch);
    X(close)(&work);
}

static void X(stages)(const fixpair_exec *exec) {
    fixpair_brick brick, cells, fine;
    fixpair_realisation normal;
    X(built_in) transform, work;
    X(fixpair_components) position, velocity;
    REAL *density, *source, *copy, *mesh[3], *psi[2], *particles[2];
    size_t length, fine_length, i;
    uint64_t hash = HASH_START;
    MUST(fixpair_brick_whole(&brick, N, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_whole(&cells, N, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_brick_whole(&fine, FINE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_realisation_init(&normal, SEED));
    density = X(array_of)(&brick, &length);
    MUST(X(fixpair_white_modes)(density, length, &brick, &normal, amplitude_table, table_length, exec));
    X(local)("aliased", density, &brick, length, N, 0.0, exec);
    X(local)("exact", density, &brick, length, FINER, 1e7, exec);
    MUST(X(fixpair_scale_modes)(density, length, &brick, alpha_table, table_length, exec));
    check_named("scale_modes", "", SUFFIX, hash_brick(HASH_START, density, &brick, sizeof(REAL)));
    copy = X(array_of)(&fine, &fine_length);
    MUST(X(fixpair_copy_modes)(copy, fine_length, &fine, density, length, &brick, exec));
    check_named("copy_modes", "", SUFFIX, hash_brick(HASH_START, copy, &fine, sizeof(REAL)));
    give_back(copy);

    X(open)(&work, FINE, 0, exec);
    for (i = 0; i < 3; i++) {
        mesh[i] = X(reals)(work.fft.length);
    }
    source = X(reals)(length);
    MUST(X(fixpair_second_order_source)(source, length, density, length, &brick, &work.fft, mesh[0], mesh[1],
                                        mesh[2], work.fft.length, exec));
    check_named("second_order_source", "", SUFFIX, hash_brick(HASH_START, source, &brick, sizeof(REAL)));
    for (i = 0; i < 3; i++) {
        give_back(mesh[i]);
    }
    X(close)(&work);

    X(open)(&transform, N, 0, exec);
    for (i = 0; i < 2; i++) {
        psi[i] = X(reals)(transform.fft.length);
        particles[i] = X(reals)(3 * N * N * N);
        MUST(X(fixpair_displacement)(psi[i], transform.fft.length, i == 0 ? density : source, length, &brick, 1,
                                     i == 0 ? 32.0 : 13.5, &transform.fft, exec));
        hash = hash_brick(hash, psi[i], &cells, sizeof(REAL));
    }
    check_named("displacement", "", SUFFIX, hash);
    position.x = particles[0];
    position.stride = 3;
    position.length = N * N * N;
    velocity = position;
    velocity.x = particles[1];
    position.y = position.x + 1;
    position.z = position.x + 2;
    velocity.y = velocity.x + 1;
    velocity.z = velocity.x + 2;
    MUST(X(fixpair_displace)(&position, &velocity, psi[0], psi[1], transform.fft.length, &cells, 1, BOX, 600.0,
                             1200.0, exec));
    hash = HASH_START;
    for (i = 0; i < 2; i++) {
        hash = hash_bytes(hash, particles[i], 3 * N * N * N * sizeof(REAL));
        give_back(psi[i]);
        give_back(particles[i]);
    }
    check_named("displace", "", SUFFIX, hash);
    X(close)(&transform);
    give_back(density);
    give_back(source);
}

/* A host's particle: position and velocity somewhere in its middle, in the element of the interface. */
typedef struct {
    REAL mass;
    REAL position[3];
    REAL velocity[3];
    REAL potential;
} X(particle);

/* Where particles lie: triples, an array a component, members of a struct. */
enum X(layout_of_particles) { X(TRIPLES), X(ARRAYS), X(MEMBERS), X(LAYOUTS) };

static void X(universe)(const char *name, const fixpair_conditions *conditions, const X(fixpair_fft) *fft,
                        const X(fixpair_fft) *fine, const fixpair_exec *exec) {
    enum { PARTICLES = N * N * N };
    fixpair_layout layout;
    void *scratch;
    int kind, side, axis;
    size_t i;
    MUST(X(fixpair_initial_conditions_scratch)(&layout, conditions, fft, fine));
    scratch = take_scratch(layout.size);
    for (kind = 0; kind < X(LAYOUTS); kind++) {
        REAL *memory = X(reals)(8 * PARTICLES);
        X(fixpair_components) both[2];
        uint64_t hash = hash_layout(HASH_START, layout);
        for (side = 0; side < 2; side++) {
            X(particle) *particles = (X(particle) *)memory;
            REAL *first = kind == X(MEMBERS)  ? side == 0 ? particles->position : particles->velocity
                          : kind == X(ARRAYS) ? memory + (size_t)side * 3 * PARTICLES
                                              : memory + (size_t)side * 3 * PARTICLES;
            size_t step = kind == X(ARRAYS) ? PARTICLES : 1;
            both[side].x = first;
            both[side].y = first + step;
            both[side].z = first + 2 * step;
            both[side].length = PARTICLES;
            both[side].stride = kind == X(ARRAYS) ? 1 : kind == X(TRIPLES) ? 3 : sizeof(X(particle)) / sizeof(REAL);
        }
        MUST(X(fixpair_initial_conditions)(&both[0], &both[1], conditions, fft, fine, scratch, layout.size, exec));
        for (side = 0; side < 2; side++) {
            const REAL *component[3];
            component[0] = both[side].x;
            component[1] = both[side].y;
            component[2] = both[side].z;
            for (i = 0; i < PARTICLES; i++) {
                for (axis = 0; axis < 3; axis++) {
                    hash = hash_bytes(hash, component[axis] + i * both[side].stride, sizeof(REAL));
                }
            }
        }
        check_named("initial.", name, SUFFIX, hash);
        if (kind == X(MEMBERS)) {
            int untouched = 1;
            for (i = 0; i < PARTICLES; i++) {
                untouched &= ((X(particle) *)memory)[i].mass == 0 && ((X(particle) *)memory)[i].potential == 0;
            }
            CHECK(untouched);
        }
        give_back(memory);
    }
    give_back(scratch);
}

/* A host's transform whose modes lie transposed, as FFTW-MPI leaves them: the built-in one, and a copy. */
static int32_t X(transposed_forward)(void *context, REAL *data) {
    X(built_in) *inner = (X(built_in) *)context;
    const size_t row = N + 2;
    REAL *copy = X(reals)(inner->fft.length);
    size_t x, y;
    int32_t status = inner->fft.forward(inner->fft.context, data);
    memcpy(copy, data, inner->fft.length * sizeof(REAL));
    for (x = 0; x < N; x++) {
        for (y = 0; y < N; y++) {
            memcpy(data + (y * N + x) * row, copy + (x * N + y) * row, row * sizeof(REAL));
        }
    }
    give_back(copy);
    return status;
}

static int32_t X(transposed_inverse)(void *context, REAL *data) {
    X(built_in) *inner = (X(built_in) *)context;
    const size_t row = N + 2;
    REAL *copy = X(reals)(inner->fft.length);
    size_t x, y;
    memcpy(copy, data, inner->fft.length * sizeof(REAL));
    for (x = 0; x < N; x++) {
        for (y = 0; y < N; y++) {
            memcpy(data + (x * N + y) * row, copy + (y * N + x) * row, row * sizeof(REAL));
        }
    }
    give_back(copy);
    return inner->fft.inverse(inner->fft.context, data);
}

static void X(universes)(const fixpair_exec *exec) {
    fixpair_conditions gaussian, local, cubic, first;
    X(built_in) transform, fine, finer;
    X(fixpair_fft) host;
    double k[ROWS], power[ROWS], transfer[ROWS];
    REAL *data;
    fill_rows(k, power, transfer);
    X(open)(&transform, N, 0, exec);
    X(open)(&fine, FINE, 0, exec);
    X(open)(&finer, FINER, X(fixpair_fft_padding)(FINER), exec);
    MUST(fixpair_conditions_init(&gaussian, SEED));
    gaussian.box_size = BOX;
    local = gaussian;
    local.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    local.realisation.phase = FIXPAIR_PHASE_INVERTED;
    local.f_nl = 100.0;
    cubic = first = local;
    cubic.g_nl = 1e5;
    first.order = FIXPAIR_ORDER_FIRST;
    first.redshift = 49.0;
    first.convention = FIXPAIR_CONVENTION_LSS;
    first.linear.source = FIXPAIR_LINEAR_POWER;
    first.linear.normalisation = FIXPAIR_NORMALISE_AS_GIVEN;
    first.linear.k = k;
    first.linear.value = power;
    first.linear.rows = ROWS;
    X(universe)("gaussian", &gaussian, &transform.fft, NULL, exec);
    X(universe)("local", &local, &transform.fft, &fine.fft, exec);
    X(universe)("cubic", &cubic, &transform.fft, &finer.fft, exec);
    X(universe)("first", &first, &transform.fft, NULL, exec);

    host = transform.fft;
    host.context = &transform;
    host.forward = X(transposed_forward);
    host.inverse = X(transposed_inverse);
    MUST(fixpair_brick_transposed_slab(&host.fourier, N, 0, N));
    data = X(reals)(host.length);
    CHECK(X(fixpair_fft_self_test)(&host, data, host.length) == FIXPAIR_OK);
    give_back(data);
    X(universe)("gaussian", &gaussian, &host, NULL, exec);
    X(universe)("local", &local, &host, &fine.fft, exec);
    X(universe)("first", &first, &host, NULL, exec);
    X(close)(&transform);
    X(close)(&fine);
    X(close)(&finer);
}
