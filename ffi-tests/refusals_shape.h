/*
 * The part of refusals.c about shapes of primordial non-Gaussianity, in one precision.
 */

CALL_REAL(add_shape_scratch, (P(0), P(1), P(2)))
CALL_REAL(add_shape, (P(0), L(0), P(1), a->d[0], a->d[1], P(2), L(1), P(3), P(4), L(2), P(5)))

static void X(refuse_shapes)(void) {
    fixpair_brick brick, *own;
    fixpair_shape_row *rows;
    fixpair_layout layout;
    X(fixpair_fft) *fft, *near;
    double *numbers[4];
    size_t reals, count;
    int i;
    MUST(fixpair_brick_whole(&brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_reals(&reals, &brick));

    begin("add_shape_scratch" SUFFIX, X(call_add_shape_scratch));
    STRUCT(0, OUT, fixpair_layout);
    own = STRUCT(1, IN, fixpair_brick);
    *own = brick;
    fft = X(hook_at)(2, WORK_SIDE, PAD);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, own->n = 7);
    REFUSED(FIXPAIR_ERROR_BRICK, own->count[0]++);
    restore();
    MUST(X(fixpair_add_shape_scratch)(&layout, own, fft));

    begin("add_shape" SUFFIX, X(call_add_shape));
    ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    *own = brick;
    rows = (fixpair_shape_row *)argument(2, IN, 4 * sizeof *rows, sizeof(double));
    MUST(fixpair_shape_rows(rows, 4, &count, FIXPAIR_SHAPE_EQUILATERAL));
    fft = X(hook_at)(3, WORK_SIDE, PAD);
    near = (X(fixpair_fft) *)lay(sizeof *near, IN);
    X(make_hook)(near, 8, 0);
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    t.a.d[0] = 1.0;
    t.a.d[1] = 0.96;
    length(0, reals, LEAST);
    length(1, count, FREE);
    length(2, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[1] = 0, t.a.p[2] = NULL));
    refuse_bricks(own);
    X(refuse_hooks)(fft);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = -(double)INFINITY);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 10.5);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = -10.5);
    numbers[0] = &rows[3].coefficient;
    numbers[1] = &rows[3].s_out;
    numbers[2] = &rows[3].s_a;
    numbers[3] = &rows[3].s_b;
    for (i = 0; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)INFINITY);
    }
    for (i = 1; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_RANGE, *numbers[i] += 1e-9);
        REFUSED(FIXPAIR_ERROR_RANGE, *numbers[i] = 1e300);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, (rows[0].s_a = 8.5, rows[0].s_b = -8.5));
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[1] = -10.0, rows[0].s_a = 8.0, rows[0].s_b = -8.0));
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.p[3] = near);
    /* Phi is written once, by the last pass: a transform that fails comes before it. */
    REFUSED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    REFUSED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
}
