/*
 * The half of refusals.c that exists in both precisions: forces, kicks and drifts, runs.
 */

CALL_REAL(forces, (P(0), P(1), P(2), L(0), P(3), P(4), a->d[0], a->d[1], P(5), L(1), P(6)))
CALL_REAL(force, (P(0), P(1), L(0), P(2), L(2), P(3), a->d[0], a->d[1], P(4), L(1), P(5)))
CALL_REAL(potential, (P(0), L(0), P(1), P(2), a->d[0], a->d[1], P(3), L(1), P(4)))
CALL_REAL(kick_scratch, (P(0), P(1), L(0), a->i[0]))
CALL_REAL(kick, (P(0), P(1), P(2), P(3), P(4), L(0), P(5), a->d[0], a->i[0], a->d[1], a->d[2], a->d[3], a->d[4], a->d[5],
                 P(6), P(7), P(8), L(1), P(9)))
CALL_REAL(drift, (P(0), P(1), a->d[0], a->d[1], a->d[2], a->d[3], P(2), P(3), P(4)))
CALL_REAL(evolve_scratch, (P(0), P(1), L(0), a->i[0]))
CALL_REAL(evolve, (P(0), P(1), P(2), P(3), P(4), P(5), L(0), P(6), P(7), P(8), P(9), L(1), P(10), P(11), L(2), P(12), P(13)))

/* Triples to be written, at p[pointer]. */
static X(fixpair_components) *X(vectors_at)(int pointer, size_t count) {
    X(fixpair_components) *vectors = STRUCT(pointer, IN, X(fixpair_components));
    vectors->x = (REAL *)lay(3 * count * sizeof(REAL), OUT);
    vectors->y = vectors->x + 1;
    vectors->z = vectors->x + 2;
    vectors->stride = 3;
    vectors->length = count;
    return vectors;
}

/* Faults of what a function reads; `out` is some output. */
static void X(refuse_views)(X(fixpair_positions) *view, void *out) {
    REAL *x;
    restore();
    x = (REAL *)(uintptr_t)view->x;
    REFUSED(FIXPAIR_ERROR_NULL, view->x = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, view->z = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, view->y = (REAL *)(void *)((char *)x + sizeof(REAL) / 2));
    REFUSED(FIXPAIR_ERROR_OVERLAP, view->x = (REAL *)out);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, view->length = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, view->stride = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, view->stride = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, view->length--);
}

/* The box at d[0] and the mass at d[1] of forces. */
static void X(refuse_scales)(void) {
    int i;
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = -1.0);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 5e-324);
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[0] = 1e-200, t.a.d[1] = 1e200));
}

static void X(refuse_forces)(void) {
    fixpair_brick brick, *own;
    fixpair_force_law *law;
    fixpair_layout layout;
    size_t reals;
    int which, i;
    MUST(fixpair_brick_whole(&brick, SIDE, FIXPAIR_SPACE_FOURIER, PAD));
    MUST(fixpair_brick_reals(&reals, &brick));
    MUST(fixpair_force_scratch(&layout, SIDE));
    for (which = 0; which < 3; which++) {
        static const call_function calls[3] = {X(call_forces), X(call_force), X(call_potential)};
        static const char *const names[3] = {"forces" SUFFIX, "force" SUFFIX, "potential" SUFFIX};
        int meshes = 3 - which;
        begin(names[which], calls[which]);
        for (i = 0; i < meshes; i++) {
            ARRAY(i, which == 1 && i == 1 ? IN : OUT, REAL, reals);
        }
        own = STRUCT(meshes, IN, fixpair_brick);
        *own = brick;
        law = STRUCT(meshes + 1, IN, fixpair_force_law);
        MUST(fixpair_force_law_init(law));
        SCRATCH_OF(meshes + 2, layout.size);
        exec_at(meshes + 3);
        length(0, reals, LEAST);
        length(1, layout.size, SCRATCH);
        t.a.d[0] = BOX;
        t.a.d[1] = 100.0;
        refuse_pointers_and_lengths();
        ACCEPTED((own->count[0] = 0, t.a.n[0] = 0));
        refuse_bricks(own);
        refuse_laws(law);
        X(refuse_scales)();
        if (which == 1) {
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = 3);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = SIZE_MAX);
        }
    }
}

/* Factors of displacements at d[from] and after, displacements at p[psi] and after. */
static void X(refuse_displacements)(int from, int psi, void *out) {
    int i;
    for (i = 0; i < 2; i++) {
        X(fixpair_positions) *order = (X(fixpair_positions) *)t.good.p[psi + i];
        REAL *x = (REAL *)(uintptr_t)order->x;
        X(refuse_views)(order, out);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[from + i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[from + i] = (double)INFINITY);
        SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
        SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[2] = (REAL)INFINITY);
    }
    ACCEPTED((t.a.d[from + 1] = 0.0, t.a.p[psi + 1] = NULL));
    ACCEPTED((t.a.d[from] = t.a.d[from + 1] = 0.0, t.a.p[psi] = t.a.p[psi + 1] = NULL));
}

static void X(refuse_kicks)(void) {
    const size_t length_of_mesh = 3 * SIDE * SIDE;
    fixpair_brick *region;
    fixpair_layout layout;
    X(fixpair_components) *moved;
    X(fixpair_positions) *position;
    REAL *mesh, *x;
    int i;
    begin("kick_scratch" SUFFIX, X(call_kick_scratch));
    STRUCT(0, OUT, fixpair_layout);
    region = X(region_at)(1);
    t.a.i[0] = FIXPAIR_WINDOW_CIC;
    t.a.n[0] = X(FEW);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.n[0] = 0);
    refuse_regions(region);
    refuse_windows();
    restore();
    MUST(X(fixpair_kick_scratch)(&layout, region, X(FEW), FIXPAIR_WINDOW_PCS));

    begin("kick" SUFFIX, X(call_kick));
    moved = X(vectors_at)(0, X(FEW));
    position = X(positions_at)(1);
    for (i = 2; i < 5; i++) {
        ARRAY(i, IN, REAL, length_of_mesh);
    }
    mesh = (REAL *)t.a.p[3];
    region = X(region_at)(5);
    X(positions_at)(6);
    X(positions_at)(7);
    SCRATCH_OF(8, layout.size);
    exec_at(9);
    length(0, length_of_mesh, LEAST);
    length(1, layout.size, SCRATCH);
    t.a.i[0] = FIXPAIR_WINDOW_CIC;
    t.a.d[0] = BOX;
    t.a.d[2] = t.a.d[3] = t.a.d[4] = t.a.d[5] = 1.0;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.d[4] = t.a.d[5] = 0.0, t.a.p[6] = t.a.p[7] = NULL, moved->length = position->length = 0));
    X(refuse_positions)(position, moved->x);
    REFUSED(FIXPAIR_ERROR_LENGTH, position->length--);
    REFUSED(FIXPAIR_ERROR_LENGTH, moved->length--);
    REFUSED(FIXPAIR_ERROR_RANGE, moved->stride = 0);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[3] = moved->x);
    REFUSED(FIXPAIR_ERROR_OVERLAP, t.a.p[8] = moved->x);
    refuse_regions(region);
    X(refuse_displacements)(4, 6, moved->x);
    for (i = 2; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = -(double)INFINITY);
    }
    for (i = 0; (size_t)i < length_of_mesh; i++) {
        mesh[i] = (REAL)NAN;
    }
    memcpy(t.pristine, t.memory, ARENA);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, (void)0);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, (memset(mesh, 0, length_of_mesh * sizeof(REAL)), moved->x[5] = (REAL)NAN));

    begin("drift" SUFFIX, X(call_drift));
    moved = X(vectors_at)(0, X(FEW));
    position = X(positions_at)(1);
    X(positions_at)(2);
    X(positions_at)(3);
    exec_at(4);
    t.a.d[0] = BOX;
    t.a.d[1] = t.a.d[2] = t.a.d[3] = 1.0;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.d[2] = t.a.d[3] = 0.0, t.a.p[2] = t.a.p[3] = NULL, moved->length = position->length = 0));
    x = (REAL *)(uintptr_t)position->x;
    X(refuse_views)(position, moved->x);
    X(refuse_displacements)(2, 2, moved->x);
    REFUSED(FIXPAIR_ERROR_LENGTH, moved->length--);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = 1e10);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, moved->x[4] = (REAL)INFINITY);
}
