/*
 * The part of bits.c about what goes through transforms, in one precision: initial conditions, runs, and what is measured in them.
 */

enum { X(SIDE) = 36, X(FINE) = 72, X(CROWD) = X(SIDE) * X(SIDE) * X(SIDE) };

typedef struct {
    const char *name;
    int32_t order, shape, amplitude, phase, scheme;
    double f_nl, g_nl;
    int fine;
} X(kind);

static void X(initial)(const X(kind) *kind, REAL *places, REAL *speeds, const X(built_in) *transform, const X(built_in) *fine) {
    X(fixpair_components) position = X(triples)(places, X(CROWD)), velocity = X(triples)(speeds, X(CROWD));
    fixpair_conditions conditions;
    fixpair_layout layout;
    void *scratch;
    MUST(fixpair_conditions_init(&conditions, SEED));
    conditions.realisation.amplitude = kind->amplitude;
    conditions.realisation.phase = kind->phase;
    conditions.realisation.scheme = kind->scheme;
    conditions.box_size = BOX;
    conditions.redshift = 9.0;
    conditions.order = kind->order;
    conditions.shape = kind->shape;
    conditions.f_nl = kind->f_nl;
    conditions.g_nl = kind->g_nl;
    MUST(X(fixpair_initial_conditions_scratch)(&layout, &conditions, &transform->fft, kind->fine ? &fine->fft : NULL));
    scratch = take(layout.size);
    MUST(X(fixpair_initial_conditions)(&position, &velocity, &conditions, &transform->fft, kind->fine ? &fine->fft : NULL, scratch,
                                       layout.size, exec));
    give_back(scratch);
}

static void X(initials)(const X(built_in) *transform, const X(built_in) *fine) {
    static const X(kind) kinds[] = {
        {"first", FIXPAIR_ORDER_FIRST, FIXPAIR_SHAPE_LOCAL, 0, 0, FIXPAIR_SCHEME_NATIVE, 0, 0, 0},
        {"second.ngenic", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, 1, 0, FIXPAIR_SCHEME_NGENIC, 0, 0, 0},
        {"second.local", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, 1, 1, FIXPAIR_SCHEME_NATIVE, 100, 1e5, 1},
        {"second.equilateral", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_EQUILATERAL, 1, 0, FIXPAIR_SCHEME_NATIVE, 1000, 0, 1},
        {"third", FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_LOCAL, 1, 0, FIXPAIR_SCHEME_NATIVE, 0, 0, 0},
    };
    REAL *places = X(reals)(3 * X(CROWD)), *speeds = X(reals)(3 * X(CROWD));
    char name[40];
    size_t i;
    for (i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        X(initial)(&kinds[i], places, speeds, transform, fine);
        snprintf(name, sizeof name, "initial.%s.position", kinds[i].name);
        X(line_of_reals)(TRANSFORM, name, BOX, places, 3 * X(CROWD));
        snprintf(name, sizeof name, "initial.%s.velocity", kinds[i].name);
        X(line_of_reals)(TRANSFORM, name, 0, speeds, 3 * X(CROWD));
    }
    give_back(places);
    give_back(speeds);
}

/* Density of the particles, its spectrum, and their groups. */
static void X(measured)(const REAL *places, REAL *mesh, const X(built_in) *transform) {
    static const uint64_t edges[6] = {1, 9, 25, 64, 144, 324};
    const X(fixpair_fft) *fft = &transform->fft;
    const X(fixpair_positions) position = X(view)(places, X(CROWD));
    const REAL *fields[1];
    const size_t pair[2] = {0, 0};
    fixpair_binning binning;
    fixpair_layout layout;
    fixpair_bin bins[5];
    double power[5];
    size_t bins_len, values_len, words;
    int64_t *sums;
    void *scratch;
    memset(mesh, 0, fft->length * sizeof(REAL));
    MUST(X(fixpair_deposit_scratch)(&layout, &fft->configuration, X(CROWD), FIXPAIR_WINDOW_TSC));
    scratch = take(layout.size);
    MUST(X(fixpair_deposit)(mesh, fft->length, &fft->configuration, &position, NULL, 0, BOX, FIXPAIR_WINDOW_TSC, 0.0, scratch, layout.size,
                            exec));
    give_back(scratch);
    MUST(fft->forward(fft->context, mesh));
    MUST(fixpair_binning_init(&binning, edges, 6));
    MUST(fixpair_binning_lengths(&bins_len, &values_len, &words, &binning, 1));
    sums = (int64_t *)take(words * sizeof *sums);
    MUST(fixpair_power_sums_scratch(&layout, &fft->fourier, &binning, 1));
    scratch = take(layout.size);
    fields[0] = mesh;
    MUST(X(fixpair_power_sums)(sums, words, fields, 1, fft->length, pair, 1, NULL, &fft->fourier, &binning, scratch, layout.size, exec));
    MUST(fixpair_binning_read(bins, bins_len, power, values_len, sums, words, &binning, 1));
    line_of_doubles(TRANSFORM, "evolved.power", SUFFIX, 0, power, 5);
    give_back(scratch);
    give_back(sums);
}

static void X(runs)(const X(built_in) *transform, const X(built_in) *fine) {
    static const char *const steppers[] = {"fastpm", "leapfrog", "cola"};
    static const X(kind) start = {"", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, 1, 0, FIXPAIR_SCHEME_NATIVE, 0, 0, 0};
    const X(fixpair_fft) *fft = &transform->fft;
    REAL *places = X(reals)(3 * X(CROWD)), *speeds = X(reals)(3 * X(CROWD)), *mesh[3], *psi[2];
    double steps[6];
    char name[40];
    int i;
    MUST(fixpair_linear_steps(steps, 6, 0.1, 1.0));
    for (i = 0; i < 3; i++) {
        mesh[i] = X(reals)(fft->length);
    }
    for (i = 0; i < 2; i++) {
        psi[i] = X(numbers)(3 * X(CROWD), 16 + (size_t)i, i == 0 ? 0.5 : 0.0625);
    }
    for (i = 0; i < 3; i++) {
        X(fixpair_components) position = X(triples)(places, X(CROWD)), velocity = X(triples)(speeds, X(CROWD));
        X(fixpair_displacements) displacements;
        fixpair_epoch epoch = {0.1, 0.1};
        fixpair_gravity gravity;
        fixpair_layout layout;
        void *scratch;
        X(initial)(&start, places, speeds, transform, fine);
        MUST(fixpair_gravity_init(&gravity));
        gravity.box_size = BOX;
        gravity.stepper = i;
        displacements.first = X(view)(psi[0], X(CROWD));
        displacements.second = X(view)(psi[1], X(CROWD));
        displacements.scale_factor = 0.1;
        MUST(X(fixpair_evolve_scratch)(&layout, fft, X(CROWD), gravity.window));
        scratch = take(layout.size);
        MUST(X(fixpair_evolve)(&position, &velocity, &epoch, &gravity, i == FIXPAIR_STEPPER_COLA ? &displacements : NULL, steps, 6, NULL,
                               mesh[0], mesh[1], mesh[2], fft->length, fft, scratch, layout.size, NULL, exec));
        give_back(scratch);
        snprintf(name, sizeof name, "evolve.%s.position", steppers[i]);
        X(line_of_reals)(TRANSFORM, name, BOX, places, 3 * X(CROWD));
        snprintf(name, sizeof name, "evolve.%s.velocity", steppers[i]);
        X(line_of_reals)(TRANSFORM, name, 0, speeds, 3 * X(CROWD));
        if (i == 0) {
            X(measured)(places, mesh[0], transform);
        }
    }
    for (i = 0; i < 3; i++) {
        give_back(mesh[i]);
    }
    give_back(psi[0]);
    give_back(psi[1]);
    give_back(places);
    give_back(speeds);
}

/* Whole meshes alone: the built-in transform is that of one process. */
static void X(universes)(void) {
    X(built_in) transform, fine;
    if (cut != WHOLE) {
        return;
    }
    X(transforms)();
    X(open)(&transform, X(SIDE));
    X(open)(&fine, X(FINE));
    X(initials)(&transform, &fine);
    X(runs)(&transform, &fine);
    X(close)(&transform);
    X(close)(&fine);
}
