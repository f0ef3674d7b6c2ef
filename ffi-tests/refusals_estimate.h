/*
 * The half of refusals.c that exists in both precisions: particles and meshes, spectra, correlation functions, bispectra.
 */

CALL_REAL(deposit_scratch, (P(0), P(1), L(0), a->i[0]))
CALL_REAL(read_out_scratch, (P(0), P(1), L(0), a->i[0]))
CALL_REAL(deposit, (P(0), L(0), P(1), P(2), P(3), L(1), a->d[0], a->i[0], a->d[1], P(4), L(2), P(5)))
CALL_REAL(read_out, (P(0), L(1), P(1), L(0), P(2), P(3), a->d[0], a->i[0], a->d[1], P(4), L(2), P(5)))
CALL_REAL(add_cells, (P(0), L(0), P(1), P(2), L(1), P(3), P(4)))
CALL_REAL(copy_cells, (P(0), L(0), P(1), P(2), L(1), P(3), P(4)))
CALL_REAL(interlace, (P(0), P(1), L(0), P(2), P(3)))
CALL_REAL(power_sums, (P(0), L(0), P(1), L(1), L(2), P(2), L(3), P(3), P(4), P(5), P(6), L(4), P(7)))
CALL_REAL(shot_noise, (P(0), P(1), L(1), L(0), a->d[0]))
CALL_REAL(compensate, (P(0), L(0), a->i[0], a->d[0], P(1), P(2), L(1), P(3)))
CALL_REAL(correlation_modes, (P(0), P(1), L(0), a->i[0], a->i[1], a->d[0], P(2), P(3), L(1), P(4)))
CALL_REAL(correlation_sums, (P(0), L(0), P(1), L(1), L(2), P(2), P(3), P(4), L(3), P(5)))
CALL_REAL(shell_modes, (P(0), P(1), L(0), P(2), a->u, L(1), P(3)))
CALL_REAL(bispectrum_sums_scratch, (P(0), P(1), L(0), L(1)))
CALL_REAL(bispectrum_sums, (P(0), L(4), P(1), L(0), P(2), L(1), L(2), P(3), P(4), L(3), P(5)))
CALL_REAL(bispectrum_meshes, (P(0), P(1), L(0)))
CALL_REAL(bispectrum_scratch, (P(0), P(1), L(0), L(1)))
CALL_REAL(bispectrum, (P(0), L(5), P(1), P(2), L(0), P(3), L(1), P(4), L(2), P(5), P(6), L(3), P(7), L(4), P(8)))

enum { X(FEW) = 7 };

/* A part of the mesh that runs over its edge, at p[pointer]: planes 4, 5, 0. */
static fixpair_brick *X(region_at)(int pointer) {
    fixpair_brick *region = STRUCT(pointer, IN, fixpair_brick), slab;
    MUST(fixpair_brick_slab(&slab, SIDE, FIXPAIR_SPACE_CONFIGURATION, 4, 2));
    MUST(fixpair_brick_with_ghosts(region, &slab, FIXPAIR_WINDOW_CIC, 0.0));
    return region;
}

/* Triples inside planes 4 and 5, at p[pointer]. */
static X(fixpair_positions) *X(positions_at)(int pointer) {
    X(fixpair_positions) *position = STRUCT(pointer, IN, X(fixpair_positions));
    REAL *triples = (REAL *)lay(3 * X(FEW) * sizeof(REAL), IN);
    size_t i;
    for (i = 0; i < 3 * X(FEW); i++) {
        triples[i] = (REAL)(BOX * (0.7 + 0.01 * (double)i));
    }
    position->x = triples;
    position->y = triples + 1;
    position->z = triples + 2;
    position->stride = 3;
    position->length = X(FEW);
    return position;
}

static void X(refuse_positions)(X(fixpair_positions) *position, void *out) {
    REAL *x = (REAL *)(uintptr_t)position->x;
    REFUSED(FIXPAIR_ERROR_NULL, position->x = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, position->y = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, position->z = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, position->y = (REAL *)(void *)((char *)x + sizeof(REAL) / 2));
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->x = (REAL *)out);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, position->length = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, position->stride = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, position->stride = 0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    refuse_shifts(1);
    refuse_windows();
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[0] = (REAL)INFINITY);
    SPOILED(FIXPAIR_ERROR_OUTSIDE, x[9] = (REAL)(BOX / 2));
    SPOILED(FIXPAIR_ERROR_OUTSIDE, t.a.i[0] = FIXPAIR_WINDOW_PCS);
    ACCEPTED(x[9] -= (REAL)(7 * BOX));
}

static void X(refuse_particles)(void) {
    fixpair_brick *region, *other;
    fixpair_layout layout;
    X(fixpair_positions) *position;
    REAL *weights, *mesh;
    size_t length_of_mesh = 3 * SIDE * SIDE, reals;
    int which;
    for (which = 0; which < 2; which++) {
        begin(which ? "read_out_scratch" SUFFIX : "deposit_scratch" SUFFIX,
              which ? X(call_read_out_scratch) : X(call_deposit_scratch));
        STRUCT(0, OUT, fixpair_layout);
        region = X(region_at)(1);
        t.a.i[0] = FIXPAIR_WINDOW_CIC;
        t.a.n[0] = X(FEW);
        refuse_pointers_and_lengths();
        ACCEPTED(t.a.n[0] = 0);
        refuse_regions(region);
        refuse_windows();
        restore();
        MUST(X(fixpair_deposit_scratch)(&layout, region, X(FEW), FIXPAIR_WINDOW_PCS));
    }
    begin("deposit" SUFFIX, X(call_deposit));
    ARRAY(0, OUT, REAL, length_of_mesh);
    region = X(region_at)(1);
    position = X(positions_at)(2);
    weights = ARRAY(3, IN, REAL, 2 * X(FEW));
    t.slots[3].optional = 1;
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    length(0, length_of_mesh, LEAST);
    length(2, layout.size, SCRATCH);
    t.a.n[1] = 2;
    t.a.d[0] = BOX;
    t.a.i[0] = FIXPAIR_WINDOW_CIC;
    refuse_pointers_and_lengths();
    ACCEPTED((position->length = 0, position->x = position->y = position->z = NULL));
    refuse_regions(region);
    X(refuse_positions)(position, t.a.p[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX);
#ifndef FIXPAIR_MEMCHECK
    /* Valgrind 3.19 takes NaN for finite: it gets VCMPPD's predicate NEQ_OQ wrong. */
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, weights[2] = (REAL)NAN);
#endif
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, weights[0] = (REAL)INFINITY);
    REFUSED(FIXPAIR_OK, weights[1] = (REAL)NAN);

    begin("read_out" SUFFIX, X(call_read_out));
    ARRAY(0, OUT, REAL, 2 * X(FEW));
    /* How far the values reach depends on the positions: what overlaps them is tried below. */
    t.slots[0].size = 0;
    mesh = ARRAY(1, IN, REAL, length_of_mesh);
    region = X(region_at)(2);
    position = X(positions_at)(3);
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    length(0, length_of_mesh, LEAST);
    length(2, layout.size, SCRATCH);
    t.a.n[1] = 2;
    t.a.d[0] = BOX;
    t.a.i[0] = FIXPAIR_WINDOW_CIC;
    refuse_pointers_and_lengths();
    refuse_regions(region);
    X(refuse_positions)(position, t.a.p[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[0] = mesh);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[0] = region);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[0] = position);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[0] = (REAL *)(uintptr_t)position->x + 5);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[4] = t.a.p[0]);

    for (which = 0; which < 2; which++) {
        begin(which ? "copy_cells" SUFFIX : "add_cells" SUFFIX, which ? X(call_copy_cells) : X(call_add_cells));
        region = STRUCT(1, IN, fixpair_brick);
        MUST(fixpair_brick_slab(region, SIDE, FIXPAIR_SPACE_CONFIGURATION, 1, 4));
        MUST(fixpair_brick_reals(&reals, region));
        ARRAY(0, OUT, REAL, reals);
        ARRAY(2, IN, REAL, length_of_mesh);
        other = X(region_at)(3);
        exec_at(4);
        length(0, reals, LEAST);
        length(1, length_of_mesh, LEAST);
        refuse_pointers_and_lengths();
        refuse_regions(region);
        refuse_regions(other);
        REFUSED(FIXPAIR_ERROR_BRICK, region->n = 8);
    }
}

static void X(refuse_compensations)(int32_t *value) {
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = FIXPAIR_COMPENSATION_WINDOW);
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = FIXPAIR_COMPENSATION_ALIASED + 5);
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = FIXPAIR_WINDOW_CIC);
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = 48 + FIXPAIR_WINDOW_CIC);
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = -1);
    REFUSED(FIXPAIR_ERROR_CHOICE, *value = INT32_MIN);
}

/* Two meshes of a brick, and the array of pointers to them, at p[pointer]. */
static const REAL **X(fields_at)(int pointer, size_t reals) {
    const REAL **fields = ARRAY(pointer, IN, const REAL *, 2);
    fields[0] = (REAL *)lay(reals * sizeof(REAL), IN);
    fields[1] = (REAL *)lay(reals * sizeof(REAL), IN);
    return fields;
}

static void X(refuse_fields)(const REAL **fields, void *out) {
    REFUSED(FIXPAIR_ERROR_NULL, fields[0] = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, fields[1] = (const REAL *)(const void *)((const char *)fields[1] + 1));
    REFUSED(FIXPAIR_ERROR_OVERLAP, fields[1] = (REAL *)out);
    ACCEPTED(fields[1] = fields[0]);
}

static void X(refuse_spectra)(void) {
    fixpair_brick modes_brick, cells, *own;
    fixpair_binning *binning;
    fixpair_layout layout;
    REAL *weights;
    const REAL **fields;
    size_t reals, bins, values, words, *pairs;
    int32_t *compensation;
    MUST(fixpair_brick_whole(&modes_brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_whole(&cells, SIDE, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_brick_reals(&reals, &modes_brick));

    begin("interlace" SUFFIX, X(call_interlace));
    ARRAY(0, OUT, REAL, reals);
    ARRAY(1, IN, REAL, reals);
    own = STRUCT(2, IN, fixpair_brick);
    *own = modes_brick;
    exec_at(3);
    length(0, reals, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);

    begin("power_sums" SUFFIX, X(call_power_sums));
    binning = binning_at(5);
    MUST(fixpair_binning_lengths(&bins, &values, &words, binning, 2));
    MUST(fixpair_power_sums_scratch(&layout, &modes_brick, binning, 2));
    ARRAY(0, OUT, int64_t, words);
    fields = X(fields_at)(1, reals);
    pairs = ARRAY(2, IN, size_t, 4);
    pairs[1] = 1;
    compensation = ARRAY(3, IN, int32_t, 2);
    t.slots[3].optional = 1;
    own = STRUCT(4, IN, fixpair_brick);
    *own = modes_brick;
    SCRATCH_OF(6, layout.size);
    exec_at(7);
    length(0, words, EXACT);
    t.a.n[1] = 2;
    length(2, reals, LEAST);
    length(3, 2, FREE);
    length(4, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[3] = 1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[3] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 9);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, pairs[1] = 2);
    REFUSED(FIXPAIR_ERROR_RANGE, pairs[2] = SIZE_MAX);
    refuse_bricks(own);
    refuse_binnings(binning, t.a.p[0]);
    X(refuse_fields)(fields, t.a.p[0]);
    X(refuse_compensations)(&compensation[1]);
    /* A field that is not finite is counted in the sums, and refused by fixpair_binning_read. */
    ACCEPTED(((REAL *)(uintptr_t)fields[1])[2] = (REAL)NAN);
    CHECK(t.call(&t.a) == FIXPAIR_OK);
    {
        fixpair_bin *read_bins = (fixpair_bin *)take(bins * sizeof *read_bins);
        double *read_values = (double *)take(values * sizeof *read_values);
        CHECK(fixpair_binning_read(read_bins, bins, read_values, values, (int64_t *)t.a.p[0], words, binning, 2)
              == FIXPAIR_ERROR_NOT_FINITE);
        CHECK(read_bins[0].count == 0);
        give_back(read_bins);
        give_back(read_values);
    }

    begin("shot_noise" SUFFIX, X(call_shot_noise));
    ARRAY(0, OUT, double, 1);
    weights = ARRAY(1, IN, REAL, 2 * X(FEW) - 1);
    t.slots[1].optional = 1;
    weights[0] = weights[6] = 1;
    length(0, X(FEW), FREE);
    t.a.n[1] = 2;
    t.a.d[0] = BOX;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.p[1] = NULL, t.a.n[1] = 0));
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, weights[2] = (REAL)NAN);
    ACCEPTED(weights[1] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, weights[6] = -1);

    begin("compensate" SUFFIX, X(call_compensate));
    MUST(fixpair_compensate_scratch(&layout, &modes_brick));
    ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    *own = modes_brick;
    SCRATCH_OF(2, layout.size);
    exec_at(3);
    length(0, reals, LEAST);
    length(1, layout.size, SCRATCH);
    t.a.i[0] = FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC;
    t.a.d[0] = 0.5;
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_compensations)(&t.a.i[0]);
    ACCEPTED(t.a.i[0] = FIXPAIR_COMPENSATION_NONE);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)INFINITY);

    begin("correlation_modes" SUFFIX, X(call_correlation_modes));
    MUST(fixpair_correlation_modes_scratch(&layout, &modes_brick));
    ARRAY(0, OUT, REAL, reals);
    ARRAY(1, IN, REAL, reals);
    t.slots[1].optional = 1;
    own = STRUCT(2, IN, fixpair_brick);
    *own = modes_brick;
    SCRATCH_OF(3, layout.size);
    exec_at(4);
    length(0, reals, LEAST);
    length(1, layout.size, SCRATCH);
    t.a.d[0] = 1.0;
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_compensations)(&t.a.i[0]);
    X(refuse_compensations)(&t.a.i[1]);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = -(double)INFINITY);

    begin("correlation_sums" SUFFIX, X(call_correlation_sums));
    binning = binning_at(3);
    MUST(fixpair_correlation_sums_scratch(&layout, &cells, binning, 2));
    MUST(fixpair_brick_reals(&reals, &cells));
    ARRAY(0, OUT, int64_t, words);
    fields = X(fields_at)(1, reals);
    own = STRUCT(2, IN, fixpair_brick);
    *own = cells;
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    length(0, words, EXACT);
    t.a.n[1] = 2;
    length(2, reals, LEAST);
    length(3, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 9);
    refuse_bricks(own);
    refuse_binnings(binning, t.a.p[0]);
    X(refuse_fields)(fields, t.a.p[0]);
}

static void X(refuse_bispectra)(void) {
    fixpair_brick brick, cells, *own;
    fixpair_layout layout;
    X(fixpair_fft) *fft;
    REAL *modes;
    const REAL **fields;
    uint64_t *edges;
    uint32_t *triangles;
    size_t reals, fields_len, i;
    MUST(fixpair_brick_whole(&brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_whole(&cells, SIDE, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_brick_reals(&reals, &brick));

    begin("shell_modes" SUFFIX, X(call_shell_modes));
    ARRAY(0, OUT, REAL, reals);
    ARRAY(1, IN, REAL, reals);
    own = STRUCT(2, IN, fixpair_brick);
    *own = brick;
    exec_at(3);
    length(0, reals, LEAST);
    t.a.u = 1;
    t.a.n[1] = 4;
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.u = 4);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.u = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 10);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = SIZE_MAX);

    begin("bispectrum_sums_scratch" SUFFIX, X(call_bispectrum_sums_scratch));
    STRUCT(0, OUT, fixpair_layout);
    own = STRUCT(1, IN, fixpair_brick);
    *own = cells;
    length(0, SHELLS, FREE);
    length(1, TRIANGLES, FREE);
    refuse_pointers_and_lengths();
    refuse_bricks(own);

    begin("bispectrum_sums" SUFFIX, X(call_bispectrum_sums));
    MUST(X(fixpair_bispectrum_sums_scratch)(&layout, &cells, SHELLS, TRIANGLES));
    MUST(fixpair_brick_reals(&reals, &cells));
    ARRAY(0, OUT, int64_t, SUM * TRIANGLES);
    triangles = triangles_at(1);
    fields = ARRAY(2, IN, const REAL *, SHELLS);
    own = STRUCT(3, IN, fixpair_brick);
    *own = cells;
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    modes = NULL;
    for (i = 0; i < SHELLS; i++) {
        fields[i] = modes = (REAL *)lay(reals * sizeof(REAL), IN);
    }
    length(0, TRIANGLES, EXACT);
    length(4, SUM * TRIANGLES, EXACT);
    length(1, SHELLS, FREE);
    length(2, reals, LEAST);
    length(3, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_fields)(fields, t.a.p[0]);
    REFUSED(FIXPAIR_ERROR_OVERLAP, fields[2] = (REAL *)t.a.p[4]);
    ACCEPTED((t.a.n[0] = 1, t.a.n[4] = SUM, fields[2] = NULL));
    REFUSED(FIXPAIR_ERROR_RANGE, triangles[0] = SHELLS);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 2);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[3] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[0] = (REAL)INFINITY);

    begin("bispectrum_meshes" SUFFIX, X(call_bispectrum_meshes));
    ARRAY(0, OUT, size_t, 1);
    fft = X(hook_at)(1, SIDE, PAD);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    restore();
    MUST(X(fixpair_bispectrum_meshes)(&fields_len, fft, 3));

    begin("bispectrum_scratch" SUFFIX, X(call_bispectrum_scratch));
    STRUCT(0, OUT, fixpair_layout);
    fft = X(hook_at)(1, SIDE, PAD);
    length(0, SHELLS, FREE);
    length(1, TRIANGLES, FREE);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    restore();
    MUST(X(fixpair_bispectrum_scratch)(&layout, fft, SHELLS, TRIANGLES));

    begin("bispectrum" SUFFIX, X(call_bispectrum));
    ARRAY(0, OUT, int64_t, SUM * TRIANGLES);
    ARRAY(1, OUT, size_t, 1);
    t.slots[1].optional = 1;
    triangles = triangles_at(2);
    edges = edges_at(3);
    fft = X(hook_at)(5, SIDE, PAD);
    MUST(fixpair_brick_reals(&reals, &fft->fourier));
    modes = ARRAY(4, IN, REAL, reals);
    ARRAY(6, WORK, REAL, fields_len);
    SCRATCH_OF(7, layout.size);
    exec_at(8);
    length(0, TRIANGLES, EXACT);
    length(5, SUM * TRIANGLES, EXACT);
    length(1, EDGES, FREE);
    length(2, reals, LEAST);
    length(3, fields_len, LEAST);
    length(4, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[1] = NULL);
    ACCEPTED((t.a.n[0] = t.a.n[5] = 0, t.a.p[0] = NULL, t.a.p[2] = NULL));
    X(refuse_hooks)(fft);
    refuse_shells(edges, 1);
    REFUSED(FIXPAIR_ERROR_RANGE, edges[3] = 10);
    REFUSED(FIXPAIR_ERROR_RANGE, triangles[5] = SHELLS);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = EDGES - 1);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, modes[2] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
}
