/*
 * The part of bits.c about meshes, in one precision: transforms, and meshes that are taken apart into the bricks of a cut and put together again.
 */

/* The built-in transform with the memory that it lives in. */
typedef struct {
    X(fixpair_fft) fft;
    void *tables, *scratch;
} X(built_in);

static void X(open)(X(built_in) *transform, size_t n) {
    fixpair_layout tables, scratch;
    MUST(X(fixpair_fft_tables_scratch)(&tables, n));
    MUST(X(fixpair_fft_scratch)(&scratch, n));
    transform->tables = take(tables.size);
    transform->scratch = take(scratch.size);
    MUST(X(fixpair_fft_tables_init)(transform->tables, tables.size, n));
    MUST(X(fixpair_fft_init)(&transform->fft, transform->tables, tables.size, X(fixpair_fft_padding)(n), transform->scratch,
                             scratch.size, exec));
}

static void X(close)(X(built_in) *transform) {
    give_back(transform->tables);
    give_back(transform->scratch);
}

static REAL *X(reals)(size_t count) {
    return (REAL *)take(count * sizeof(REAL));
}

static void X(line_of_reals)(int promise, const char *name, double period, const REAL *data, size_t count) {
    X(line_of)(promise, name, SUFFIX, period, data, count);
}

/* Reals of a mesh without gaps: the form in which results are compared. */
static size_t X(volume)(size_t n, int32_t space) {
    return space == FIXPAIR_SPACE_FOURIER ? n * n * (n + 2) : n * n * n;
}

/* Between such a mesh and a brick's array. */
static void X(exchange)(REAL *mesh, REAL *data, const fixpair_brick *brick, int into_mesh) {
    const size_t width = brick->space == FIXPAIR_SPACE_FOURIER ? 2 : 1;
    const size_t row = brick->space == FIXPAIR_SPACE_FOURIER ? brick->n / 2 + 1 : brick->n;
    size_t a, b, c;
    for (a = 0; a < brick->count[0]; a++) {
        for (b = 0; b < brick->count[1]; b++) {
            for (c = 0; c < brick->count[2]; c++) {
                REAL *here = data + width * (a * brick->stride[0] + b * brick->stride[1] + c * brick->stride[2]);
                size_t x = brick->start[0] + a, y = brick->start[1] + b, z = brick->start[2] + c;
                REAL *there = mesh + width * ((x * brick->n + y) * row + z);
                memcpy(into_mesh ? there : here, into_mesh ? here : there, width * sizeof(REAL));
            }
        }
    }
}

/* The brick's part of a mesh, in the layout of the brick. */
static REAL *X(part)(REAL *mesh, const fixpair_brick *brick, size_t *length) {
    REAL *data;
    MUST(fixpair_brick_reals(length, brick));
    data = X(reals)(*length);
    X(exchange)(mesh, data, brick, 0);
    return data;
}

typedef void X(kernel)(REAL *data, size_t length, const fixpair_brick *brick, const void *context);

/* Hands each brick's part of a mesh to a kernel that changes it. */
static void X(each)(REAL *mesh, size_t n, int32_t space, int turned, X(kernel) *kernel, const void *context) {
    fixpair_brick bricks[MOST_PIECES];
    size_t pieces = pieces_of(bricks, n, space, turned), i, length;
    for (i = 0; i < pieces; i++) {
        REAL *data = X(part)(mesh, &bricks[i], &length);
        kernel(data, length, &bricks[i], context);
        X(exchange)(mesh, data, &bricks[i], 1);
        give_back(data);
    }
}

/* Numbers that look random and come from no transform and no elementary function. As modes they are not Hermitian, which the kernels here need not know. */
static REAL *X(numbers)(size_t count, size_t sequence, double scale) {
    REAL *data = X(reals)(count);
    size_t i;
    for (i = 0; i < count; i++) {
        data[i] = (REAL)(scale * random_number(i + 1000000 * sequence));
    }
    return data;
}

/*
 * Noise and what is done to modes one by one
 */

typedef struct {
    fixpair_realisation realisation;
    const double *table;
    size_t table_len;
} X(choice);

static void X(draw)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    const X(choice) *choice = (const X(choice) *)context;
    MUST(X(fixpair_white_modes)(data, length, brick, &choice->realisation, choice->table, choice->table_len, exec));
}

static void X(impose)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    MUST(X(fixpair_impose)(data, length, brick, &((const X(choice) *)context)->realisation, exec));
}

static void X(scale)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    const X(choice) *choice = (const X(choice) *)context;
    MUST(X(fixpair_scale_modes)(data, length, brick, choice->table, choice->table_len, exec));
}

static void X(compensate)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    fixpair_layout layout;
    void *scratch;
    MUST(fixpair_compensate_scratch(&layout, brick));
    scratch = take(layout.size);
    MUST(X(fixpair_compensate)(data, length, *(const int32_t *)context, 0.75, brick, scratch, layout.size, exec));
    give_back(scratch);
}

static void X(shell)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    REAL *modes = X(reals)(length);
    (void)context;
    memcpy(modes, data, length * sizeof(REAL));
    MUST(X(fixpair_shell_modes)(data, modes, length, brick, 30, 200, exec));
    give_back(modes);
}

static void X(interlace)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    REAL *second = X(part)((REAL *)(uintptr_t)context, brick, &length);
    MUST(X(fixpair_interlace)(data, second, length, brick, exec));
    give_back(second);
}

/* Force components and potential of one law; the component in the first member. */
typedef struct {
    int component;
    fixpair_force_law law;
} X(pull);

static void X(force)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    const X(pull) *pull = (const X(pull) *)context;
    fixpair_layout layout;
    void *scratch;
    REAL *out;
    MUST(fixpair_force_scratch(&layout, brick->n));
    scratch = take(layout.size);
    if (pull->component == 3) {
        MUST(X(fixpair_potential)(data, length, brick, &pull->law, BOX, 500.0, scratch, layout.size, exec));
    } else {
        out = X(reals)(length);
        MUST(X(fixpair_force)(out, data, length, brick, (size_t)pull->component, &pull->law, BOX, 500.0, scratch, layout.size, exec));
        memcpy(data, out, length * sizeof(REAL));
        give_back(out);
    }
    give_back(scratch);
}

/* A kernel on modes of its own. */
static void X(one)(const char *name, X(kernel) *kernel, const void *context) {
    const size_t volume = X(volume)(MESH, FIXPAIR_SPACE_FOURIER);
    REAL *mesh = X(numbers)(volume, 5, 3.0);
    X(each)(mesh, MESH, FIXPAIR_SPACE_FOURIER, 1, kernel, context);
    X(line_of_reals)(EXACT, name, 0, mesh, volume);
    give_back(mesh);
}

static void X(modes)(const double *amplitudes, const double *alpha, size_t table_len) {
    static const struct {
        const char *name;
        int32_t scheme, amplitude, phase, nyquist, selection;
        uint32_t sample;
        int coloured;
    } kinds[] = {
        {"noise.native.normal", 0, 0, 0, 0, 0, 0, 0},           {"noise.native.fixed_filled_inverted", 0, 1, 1, 1, 0, 0, 0},
        {"noise.native.fixed_to_mean_sphere", 0, 2, 0, 0, 1, 40, 0}, {"noise.native.coloured", 0, 0, 0, 0, 0, 0, 1},
        {"noise.ngenic.normal", 1, 0, 0, 0, 0, 0, 0},           {"noise.ngenic.fixed_coloured", 1, 1, 1, 0, 1, 30, 1},
        {"noise.fastpm.normal_filled", 2, 0, 0, 1, 0, 0, 0},    {"noise.fastpm.fixed_coloured", 2, 1, 0, 0, 0, 0, 1}};
    static const int32_t compensations[2] = {FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC,
                                             FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_PCS};
    static const char *const components[] = {"force.x", "force.y", "force.z", "potential"};
    const size_t volume = X(volume)(MESH, FIXPAIR_SPACE_FOURIER);
    REAL *mesh = X(reals)(volume), *second;
    X(choice) choice;
    X(pull) pull;
    size_t i;
    for (i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        MUST(fixpair_realisation_init(&choice.realisation, SEED));
        choice.realisation.scheme = kinds[i].scheme;
        choice.realisation.amplitude = kinds[i].amplitude;
        choice.realisation.phase = kinds[i].phase;
        choice.realisation.nyquist = kinds[i].nyquist;
        choice.realisation.selection = kinds[i].selection;
        choice.realisation.sample = kinds[i].sample;
        choice.table = kinds[i].coloured ? amplitudes : NULL;
        choice.table_len = kinds[i].coloured ? table_len : 0;
        X(each)(mesh, MESH, FIXPAIR_SPACE_FOURIER, 1, X(draw), &choice);
        X(line_of_reals)(EXACT, kinds[i].name, 0, mesh, volume);
    }
    give_back(mesh);
    choice.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    choice.realisation.phase = FIXPAIR_PHASE_INVERTED;
    choice.table = alpha;
    choice.table_len = table_len;
    MUST(fixpair_force_law_init(&pull.law));
    pull.law.gradient = FIXPAIR_DIFFERENCE_FOUR_POINT;
    pull.law.window = FIXPAIR_WINDOW_CIC;
    pull.law.split_scale = 1.25 * BOX / MESH;
    second = X(numbers)(volume, 6, 2.0);
    X(one)("impose", X(impose), &choice);
    X(one)("scale_modes", X(scale), &choice);
    X(one)("interlace", X(interlace), second);
    X(one)("compensate.window", X(compensate), &compensations[0]);
    X(one)("compensate.aliased", X(compensate), &compensations[1]);
    X(one)("shell_modes", X(shell), NULL);
    for (pull.component = 0; pull.component < 4; pull.component++) {
        X(one)(components[pull.component], X(force), &pull);
    }
    give_back(second);
}

/* Transforms there and back, of a power of two, with a 5, with a 7. */
static void X(transforms)(void) {
    static const size_t sides[3] = {64, 60, 56};
    X(built_in) transform;
    char name[32];
    size_t i, back;
    for (i = 0; i < 3; i++) {
        const size_t n = sides[i];
        REAL *data, *mesh;
        X(open)(&transform, n);
        mesh = X(reals)(X(volume)(n, FIXPAIR_SPACE_FOURIER));
        data = X(numbers)(transform.fft.length, 7, 1.0);
        for (back = 0; back < 2; back++) {
            const fixpair_brick *brick = back ? &transform.fft.configuration : &transform.fft.fourier;
            int32_t (*run)(void *, REAL *) = back ? transform.fft.inverse : transform.fft.forward;
            MUST(run(transform.fft.context, data));
            X(exchange)(mesh, data, brick, 1);
            snprintf(name, sizeof name, "fft.%s.%d", back ? "inverse" : "forward", (int)n);
            X(line_of_reals)(TRANSFORM, name, 0, mesh, X(volume)(n, brick->space));
        }
        give_back(data);
        give_back(mesh);
        X(close)(&transform);
    }
}
