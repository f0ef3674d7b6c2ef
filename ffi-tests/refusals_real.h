/*
 * The half of refusals.c that exists in both precisions: transform and random modes. The rest is in refusals_stages.h and
 * refusals_estimate.h.
 */

#define CALL_REAL(name, arguments_of_it) \
    static fixpair_status_t X(call_##name)(const arguments *a) { return X(fixpair_##name) arguments_of_it; }

CALL_REAL(fft_tables_scratch, (P(0), L(0)))
CALL_REAL(fft_scratch, (P(0), L(0)))
CALL_REAL(fft_tables_init, (P(0), L(0), L(1)))
CALL_REAL(fft_init, (P(0), P(1), L(0), L(2), P(2), L(1), P(3)))
CALL_REAL(fft_self_test, (P(0), P(1), L(0)))
CALL_REAL(white_modes, (P(0), L(0), P(1), P(2), P(3), L(1), P(4)))
CALL_REAL(impose, (P(0), L(0), P(1), P(2), P(3)))
CALL_REAL(modes_from_field, (P(0), L(0), P(1), P(2), P(3)))

/* A built-in transform in the arena. */
static void X(make_hook)(X(fixpair_fft) *fft, size_t side, size_t padding) {
    fixpair_layout tables, scratch;
    void *table_memory, *scratch_memory;
    MUST(X(fixpair_fft_tables_scratch)(&tables, side));
    MUST(X(fixpair_fft_scratch)(&scratch, side));
    table_memory = lay(tables.size, IN);
    scratch_memory = lay(scratch.size, WORK);
    MUST(X(fixpair_fft_tables_init)(table_memory, tables.size, side));
    MUST(X(fixpair_fft_init)(fft, table_memory, tables.size, padding, scratch_memory, scratch.size, NULL));
}

/* The same, at p[pointer]. */
static X(fixpair_fft) *X(hook_at)(int pointer, size_t side, size_t padding) {
    X(fixpair_fft) *fft = STRUCT(pointer, IN, X(fixpair_fft));
    X(make_hook)(fft, side, padding);
    return fft;
}

static int32_t X(failing_pass)(void *context, REAL *data) {
    (void)context, (void)data;
    return 3;
}

static int32_t X(idle_pass)(void *context, REAL *data) {
    (void)context, (void)data;
    return 0;
}

static void X(refuse_hooks)(X(fixpair_fft) *fft) {
    fixpair_brick other;
    MUST(fixpair_brick_whole(&other, 4, FIXPAIR_SPACE_FOURIER, 0));
    REFUSED(FIXPAIR_ERROR_VERSION, fft->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, fft->struct_size++);
    REFUSED(FIXPAIR_ERROR_NULL, fft->forward = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, fft->inverse = NULL);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, fft->configuration.n = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, fft->fourier.n = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, fft->fourier.n = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_CHOICE, fft->configuration.space = 7);
    REFUSED(FIXPAIR_ERROR_BRICK, fft->configuration = fft->fourier);
    REFUSED(FIXPAIR_ERROR_BRICK, fft->fourier = fft->configuration);
    REFUSED(FIXPAIR_ERROR_BRICK, fft->fourier = other);
    REFUSED(FIXPAIR_ERROR_BRICK, fft->fourier.count[0]++);
    REFUSED(FIXPAIR_ERROR_LENGTH, fft->length = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, fft->length = fft->fourier.stride[0] * 2 * (fft->fourier.n - 1));
}

static void X(refuse_transforms)(void) {
    fixpair_layout tables, scratch;
    X(fixpair_fft) *fft;
    fixpair_exec *exec;
    uint64_t *header;
    int which;
    for (which = 0; which < 2; which++) {
        begin(which ? "fft_scratch" SUFFIX : "fft_tables_scratch" SUFFIX,
              which ? X(call_fft_scratch) : X(call_fft_tables_scratch));
        STRUCT(0, OUT, fixpair_layout);
        t.a.n[0] = SIDE;
        refuse_pointers_and_lengths();
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 0);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 7);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 11);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 22);
        REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX - 1);
    }
    MUST(X(fixpair_fft_tables_scratch)(&tables, SIDE));
    MUST(X(fixpair_fft_scratch)(&scratch, SIDE));

    begin("fft_tables_init" SUFFIX, X(call_fft_tables_init));
    argument(0, OUT, tables.size, 64);
    length(0, tables.size, SCRATCH);
    t.a.n[1] = SIDE;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 11);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 22);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_SCRATCH, t.a.n[1] = 12);

    begin("fft_init" SUFFIX, X(call_fft_init));
    fft = STRUCT(0, OUT, X(fixpair_fft));
    header = (uint64_t *)argument(1, IN, tables.size, 64);
    SCRATCH_OF(2, scratch.size);
    MUST(X(fixpair_fft_tables_init)(header, tables.size, SIDE));
    length(0, tables.size, SCRATCH);
    length(1, scratch.size, SCRATCH);
    exec = (fixpair_exec *)lay(sizeof *exec, IN);
    exec->parallel_for = serial_for;
    t.a.p[3] = exec;
    refuse_pointers_and_lengths();
    CHECK(fft->struct_size == 0);
    ACCEPTED(t.a.p[3] = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, exec->parallel_for = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, t.a.p[3] = (char *)exec + 1);
    REFUSED(FIXPAIR_ERROR_VERSION, header[0]++);
    REFUSED(FIXPAIR_ERROR_VERSION, header[1] = 64);
    REFUSED(FIXPAIR_ERROR_VERSION, header[1] = 11);
    REFUSED(FIXPAIR_ERROR_VERSION, header[2] = 12 - header[2]);
    REFUSED(FIXPAIR_ERROR_VERSION, memset(header, 0, tables.size));
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[2] = SIZE_MAX / 8);

    begin("fft_self_test" SUFFIX, X(call_fft_self_test));
    fft = X(hook_at)(0, SIDE, PAD);
    ARRAY(1, OUT, REAL, fft->length);
    length(0, fft->length, EXACT);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(idle_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(idle_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = fft->inverse);
}

static void X(refuse_modes)(void) {
    fixpair_brick brick, *own;
    fixpair_realisation *realisation;
    X(fixpair_fft) *fft;
    REAL *modes;
    double *table;
    size_t reals, entries;
    MUST(fixpair_brick_whole(&brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_reals(&reals, &brick));
    MUST(fixpair_mode_table_length(&entries, SIDE));

    begin("white_modes" SUFFIX, X(call_white_modes));
    ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    realisation = STRUCT(2, IN, fixpair_realisation);
    table = ARRAY(3, IN, double, entries);
    exec_at(4);
    *own = brick;
    MUST(fixpair_realisation_init(realisation, SEED));
    length(0, reals, LEAST);
    length(1, entries, LEAST);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.p[3] = NULL, t.a.n[1] = 0));
    ACCEPTED((own->count[1] = 0, t.a.p[0] = NULL, t.a.n[0] = 0));
    refuse_bricks(own);
    refuse_realisations(realisation);
    REFUSED(FIXPAIR_ERROR_CHOICE,
            (realisation->scheme = FIXPAIR_SCHEME_NGENIC, realisation->nyquist = FIXPAIR_NYQUIST_FILLED));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, table[4] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, table[4] = -(double)INFINITY);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, table[4] = DBL_MAX);

    begin("impose" SUFFIX, X(call_impose));
    modes = ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    realisation = STRUCT(2, IN, fixpair_realisation);
    exec_at(3);
    *own = brick;
    MUST(fixpair_realisation_init(realisation, SEED));
    length(0, reals, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    refuse_realisations(realisation);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[20] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[0] = (REAL)INFINITY);

    begin("modes_from_field" SUFFIX, X(call_modes_from_field));
    modes = ARRAY(0, OUT, REAL, reals + 2 * SIDE * PAD);
    fft = X(hook_at)(1, SIDE, PAD);
    realisation = STRUCT(2, IN, fixpair_realisation);
    exec_at(3);
    MUST(fixpair_realisation_init(realisation, SEED));
    length(0, fft->length, EXACT);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    refuse_realisations(realisation);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[20] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[0] = -(REAL)INFINITY);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
}
