/*
 * The part of conformance.c about shapes of primordial non-Gaussianity, in one precision.
 */

/* f_NL = 5000 of the given rows on a work mesh of the given side, added to a copy of Phi. */
static void X(shape)(const char *name, const REAL *phi, const fixpair_brick *brick, size_t length,
                     const fixpair_shape_row *rows, size_t count, size_t side, const fixpair_exec *exec) {
    X(built_in) work;
    fixpair_layout layout;
    REAL *modes = X(reals)(length);
    void *scratch;
    X(open)(&work, side, 0, exec);
    MUST(X(fixpair_add_shape_scratch)(&layout, brick, &work.fft));
    scratch = take_scratch(layout.size);
    memcpy(modes, phi, length * sizeof(REAL));
    MUST(X(fixpair_add_shape)(modes, length, brick, 5000.0, 0.96, rows, count, &work.fft, scratch, layout.size, exec));
    check_named("add_shape.", name, SUFFIX,
                hash_brick(hash_layout(HASH_START, layout), modes, brick, sizeof(REAL)));
    MUST(X(fixpair_add_shape)(modes, length, brick, 5000.0, 0.96, NULL, 0, &work.fft, scratch, layout.size, exec));
    MUST(X(fixpair_add_shape)(modes, length, brick, 0.0, 0.96, rows, count, &work.fft, scratch, layout.size, exec));
    check_named("add_shape.", name, SUFFIX,
                hash_brick(hash_layout(HASH_START, layout), modes, brick, sizeof(REAL)));
    give_back(modes);
    give_back(scratch);
    X(close)(&work);
}

static void X(shapes)(const fixpair_exec *exec) {
    static const char *const names[] = {"local", "equilateral", "orthogonal", "orthogonal_lss", "folded"};
    static const fixpair_shape_row own[3] = {
        {1.5, 0.5, -1.25, 0.75}, {-2.0, 0.5, -1.0, 0.5}, {0.25, 1.0, -0.5, -0.5}};
    fixpair_brick brick;
    fixpair_realisation normal;
    fixpair_shape_row rows[8];
    uint64_t hash = HASH_START;
    size_t length, count;
    int32_t shape;
    REAL *phi;
    MUST(fixpair_brick_whole(&brick, N, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_realisation_init(&normal, SEED));
    phi = X(array_of)(&brick, &length);
    MUST(X(fixpair_white_modes)(phi, length, &brick, &normal, amplitude_table, table_length, exec));
    for (shape = FIXPAIR_SHAPE_LOCAL; shape <= FIXPAIR_SHAPE_FOLDED; shape++) {
        count = 0;
        CHECK(fixpair_shape_rows(NULL, 0, &count, shape) == FIXPAIR_ERROR_LENGTH && count > 0 && count <= 8);
        MUST(fixpair_shape_rows(rows, 8, &count, shape));
        hash = hash_bytes(hash, rows, count * sizeof *rows);
        X(shape)(names[shape], phi, &brick, length, rows, count, FINE, exec);
    }
    check_case("shape_rows", hash);
    X(shape)("own", phi, &brick, length, own, 3, N, exec);
    give_back(phi);
}
