/*
 * The half of refusals.c that exists in both precisions: groups, halos and spherical overdensities.
 */

CALL_REAL(fof_labels_scratch, (P(0), L(0)))
CALL_REAL(spheres_scratch, (P(0), L(0)))
CALL_REAL(fof_labels, (P(0), L(0), P(1), P(2), L(1), a->d[0], a->d[1], P(3), L(2), P(4)))
CALL_REAL(halos, (P(0), L(0), P(1), P(2), L(1), P(3), P(4), a->d[0], a->u, a->d[1], P(5), L(2), P(6)))
CALL_REAL(halo_sums, (P(0), L(0), P(1), P(2), L(1), P(3), P(4), a->d[0], a->u, P(5), L(2), P(6), L(3), P(7)))
CALL_REAL(spheres, (P(0), L(0), P(1), L(1), P(2), L(2), P(3), a->d[0], L(7), a->d[1], a->u, P(4), L(3), P(5)))
CALL_REAL(refine_centres, (P(0), L(0), P(1), P(2), a->d[0], a->d[1], a->u, P(3), L(1), P(4)))

/* The box at d[0]. */
static void X(refuse_boxes)(void) {
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1e101);
}

static void X(refuse_groups)(void) {
    X(fixpair_positions) *position;
    fixpair_layout layout;
    uint64_t *ids;
    REAL *x;
    size_t i;
    int which;
    for (which = 0; which < 2; which++) {
        begin(which ? "spheres_scratch" SUFFIX : "fof_labels_scratch" SUFFIX,
              which ? X(call_spheres_scratch) : X(call_fof_labels_scratch));
        STRUCT(0, OUT, fixpair_layout);
        length(0, 100, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED(t.a.n[0] = 0);
        REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX >> (sizeof(size_t) * 8 - 33));
    }
    MUST(X(fixpair_fof_labels_scratch)(&layout, X(FEW)));
    begin("fof_labels" SUFFIX, X(call_fof_labels));
    ARRAY(0, OUT, uint64_t, X(FEW));
    position = X(positions_at)(1);
    ids = ARRAY(2, IN, uint64_t, X(FEW));
    SCRATCH_OF(3, layout.size);
    exec_at(4);
    length(0, X(FEW), EXACT);
    length(1, X(FEW), EXACT);
    length(2, layout.size, SCRATCH);
    t.a.d[0] = BOX;
    t.a.d[1] = 5.0;
    for (i = 0; i < X(FEW); i++) {
        ids[i] = 100 - i;
    }
    refuse_pointers_and_lengths();
    x = (REAL *)(uintptr_t)position->x;
    ACCEPTED((t.a.p[2] = NULL, t.a.n[1] = 0));
    ACCEPTED((t.a.p[0] = t.a.p[2] = NULL, t.a.n[0] = t.a.n[1] = 0, position->length = 0, position->x = NULL));
    X(refuse_views)(position, t.good.p[0]);
    X(refuse_boxes)();
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = -5.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.51 * BOX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.99e-6 * BOX);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, x[0] = -(REAL)INFINITY);
    ACCEPTED(x[0] = (REAL)(-3.5 * BOX));
}

/* Pairs of particles are groups of label i/2; halos or sums: out, count, labels, position, velocity, ... */
static void X(refuse_catalogues)(void) {
    int which;
    for (which = 0; which < 2; which++) {
        X(fixpair_positions) *position, *velocity;
        fixpair_layout layout;
        uint64_t *labels, *map = NULL;
        REAL *x, *v;
        size_t i;
        begin(which ? "halo_sums" SUFFIX : "halos" SUFFIX, which ? X(call_halo_sums) : X(call_halos));
        /* The seventh particle is alone, and in the map. */
        argument(0, OUT, which ? 4 * sizeof(fixpair_halo_sums) : 3 * sizeof(fixpair_halo), sizeof(void *));
        ARRAY(1, OUT, size_t, 1);
        labels = ARRAY(2, IN, uint64_t, X(FEW));
        position = X(positions_at)(3);
        velocity = X(positions_at)(4);
        t.slots[4].optional = 1;
        if (which) {
            map = ARRAY(5, IN, uint64_t, 4);
            map[2] = 3;
            map[3] = 1;
            length(2, 2, FREE);
        }
        MUST(fixpair_halos_scratch(&layout, X(FEW)));
        SCRATCH_OF(5 + which, layout.size);
        exec_at(6 + which);
        length(0, which ? 4 : 3, LEAST);
        length(1, X(FEW), EXACT);
        length(2 + which, layout.size, SCRATCH);
        for (i = 0; i < X(FEW); i++) {
            labels[i] = i / 2;
        }
        t.a.d[0] = BOX;
        t.a.d[1] = 1e10;
        t.a.u = 2;
        refuse_pointers_and_lengths();
        x = (REAL *)(uintptr_t)position->x;
        v = (REAL *)(uintptr_t)velocity->x;
        ACCEPTED(t.a.p[4] = NULL);
        X(refuse_views)(position, t.good.p[0]);
        X(refuse_views)(velocity, t.good.p[0]);
        X(refuse_boxes)();
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, v[4] = (REAL)INFINITY);
        if (which) {
            ACCEPTED((t.a.p[5] = NULL, t.a.n[2] = 0));
            REFUSED(FIXPAIR_ERROR_TABLE, map[2] = 0);
            REFUSED(FIXPAIR_ERROR_TABLE, map[0] = 4);
        } else {
            REFUSED(FIXPAIR_ERROR_LENGTH, t.a.u = 1);
            ACCEPTED((t.a.u = UINT64_MAX, t.a.p[0] = NULL, t.a.n[0] = 0));
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)NAN);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.0);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = -1e10);
        }
    }
}

static void X(refuse_spheres)(void) {
    X(fixpair_positions) *position;
    fixpair_layout layout;
    double *centres, *densities, *radii;
    REAL *x;
    MUST(X(fixpair_spheres_scratch)(&layout, X(FEW)));
    begin("spheres" SUFFIX, X(call_spheres));
    argument(0, OUT, 4 * sizeof(fixpair_sphere), sizeof(void *));
    centres = ARRAY(1, IN, double, 6);
    densities = ARRAY(2, IN, double, 2);
    position = X(positions_at)(3);
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    length(0, 4, EXACT);
    length(1, 2, EXACT);
    /* What lies behind is read as densities before their number is found to be wrong. */
    length(2, 2, LEAST);
    length(3, layout.size, SCRATCH);
    densities[0] = 200.0;
    densities[1] = 100.0;
    t.a.d[0] = BOX;
    t.a.d[1] = 1e10;
    t.a.n[7] = 100;
    t.a.u = 2;
    refuse_pointers_and_lengths();
    x = (REAL *)(uintptr_t)position->x;
    ACCEPTED((t.a.n[0] = t.a.n[1] = 0, t.a.p[0] = t.a.p[1] = NULL));
    ACCEPTED((t.a.n[0] = t.a.n[2] = 0, t.a.p[0] = t.a.p[2] = NULL));
    ACCEPTED(centres[2] = -7.0 * BOX);
    REFUSED(FIXPAIR_ERROR_NULL, position->y = NULL);
    REFUSED(FIXPAIR_ERROR_RANGE, position->stride = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, position->length = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->x = (REAL *)t.a.p[0]);
    X(refuse_boxes)();
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, centres[2] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, densities[1] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, densities[1] = 1.9);
    REFUSED(FIXPAIR_ERROR_RANGE, densities[0] = -200.0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[7] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[7] = X(FEW) - 1);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);

    begin("refine_centres" SUFFIX, X(call_refine_centres));
    centres = ARRAY(0, OUT, double, 6);
    radii = ARRAY(1, IN, double, 2);
    position = X(positions_at)(2);
    SCRATCH_OF(3, layout.size);
    exec_at(4);
    length(0, 2, FREE);
    length(1, layout.size, SCRATCH);
    radii[0] = 10.0;
    t.a.d[0] = BOX;
    t.a.d[1] = 0.975;
    t.a.u = 1;
    refuse_pointers_and_lengths();
    x = (REAL *)(uintptr_t)position->x;
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = t.a.p[1] = NULL));
    ACCEPTED(centres[4] = 1e6 * BOX);
    X(refuse_boxes)();
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->x = (REAL *)t.a.p[0]);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, centres[4] = -(double)INFINITY);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, radii[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, radii[1] = -1.0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.45);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, x[4] = (REAL)NAN);
}
