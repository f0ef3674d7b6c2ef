/*
 * The half of refusals.c that exists in both precisions: shapes, species and the host's own positions in the one call, and the
 * stages of the third order.
 */

CALL_REAL(initial_conditions_at_scratch, (P(0), P(1), L(0), P(2), P(3)))
CALL_REAL(initial_conditions_at, (P(0), P(1), P(2), P(3), P(4), P(5), P(6), L(0), P(7)))
CALL_REAL(third_order_sources_scratch, (P(0), P(1)))
CALL_REAL(third_order_sources, (P(0), P(1), P(2), P(3), P(4), P(5), P(6), L(0), P(7), P(8), L(1), P(9)))
CALL_REAL(transverse_displacement, (P(0), L(0), P(1), P(2), P(3), L(1), L(2), a->d[0], P(4), P(5)))

enum { X(SOME) = 20 };

/* A species at third order, with a kernel of the caller's own, all of it in the arena. */
static fixpair_conditions *X(conditions_at)(int pointer) {
    static const fixpair_shape_row kernel[] = {{2.0, 0.0, 0.0, 0.0}, {-1.5, -1.0, 0.0, 1.0}};
    fixpair_conditions *conditions = STRUCT(pointer, IN, fixpair_conditions);
    fixpair_species *species = (fixpair_species *)lay(sizeof *species, IN);
    fixpair_shape_row *rows = (fixpair_shape_row *)lay(sizeof kernel, IN);
    MUST(fixpair_conditions_init(conditions, SEED));
    memcpy(rows, kernel, sizeof kernel);
    lay_columns(species);
    conditions->box_size = BOX;
    conditions->f_nl = 100.0;
    conditions->order = FIXPAIR_ORDER_THIRD;
    conditions->shape = FIXPAIR_SHAPE_ROWS;
    conditions->rows = rows;
    conditions->rows_len = sizeof kernel / sizeof *kernel;
    conditions->species = species;
    return conditions;
}

/* The scratch queries of both calls, and what they answer. */
static void X(refuse_queries)(fixpair_layout *layouts) {
    X(fixpair_fft) *fft;
    fixpair_conditions *conditions;
    int at;
    for (at = 0; at < 2; at++) {
        begin(at ? "initial_conditions_at_scratch" SUFFIX : "initial_conditions_scratch" SUFFIX,
              at ? X(call_initial_conditions_at_scratch) : X(call_initial_conditions_scratch));
        STRUCT(0, OUT, fixpair_layout);
        conditions = X(conditions_at)(1);
        fft = X(hook_at)(2, SIDE, PAD);
        X(hook_at)(3, WORK_SIDE, 0);
        t.slots[3].optional = 1;
        t.a.n[0] = X(SOME);
        refuse_pointers_and_lengths();
        ACCEPTED(t.a.p[3] = NULL);
        ACCEPTED(t.a.n[0] = 0);
        ACCEPTED(conditions->species = NULL);
        X(refuse_conditions)(conditions);
        refuse_lists_of_rows(conditions, t.a.p[0]);
        X(refuse_hooks)(fft);
        X(refuse_hooks)((X(fixpair_fft) *)t.a.p[3]);
        if (at) {
            REFUSED(FIXPAIR_ERROR_BRICK, X(part_of_mesh)(fft));
        }
        restore();
        MUST(t.call(&t.a));
        layouts[at] = *(fixpair_layout *)t.a.p[0];
    }
}

static void X(refuse_places)(X(fixpair_positions) *view, REAL *out) {
    REAL *places = (REAL *)(uintptr_t)view->x;
    X(refuse_views)(view, out);
    REFUSED(FIXPAIR_ERROR_LENGTH, view->length = 0);
    /* Particles do not move in place: where they end is apart from where they begin. */
    REFUSED(FIXPAIR_ERROR_OVERLAP, (view->x = out, view->y = out + 1, view->z = out + 2));
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, places[4] = (REAL)NAN);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, places[3 * X(SOME) - 1] = (REAL)INFINITY);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, places[0] = (REAL)-1e30);
    ACCEPTED((places[0] = (REAL)-1e6, places[4] = (REAL)1e6));
}

/* Both calls: `at` says whether particles begin at positions of the host's own. */
static void X(refuse_beyond)(int at, size_t bytes) {
    const int after = at ? 3 : 2;
    X(fixpair_components) *position, *velocity;
    X(fixpair_positions) *pre_initial = NULL;
    X(fixpair_fft) *fft, *fine, *near;
    fixpair_conditions *conditions;
    fixpair_species *one;
    begin(at ? "initial_conditions_at" SUFFIX : "initial_conditions" SUFFIX,
          at ? X(call_initial_conditions_at) : X(call_initial_conditions));
    position = X(vectors_at)(0, at ? X(SOME) : SIDE * SIDE * SIDE);
    velocity = X(vectors_at)(1, at ? X(SOME) : SIDE * SIDE * SIDE);
    if (at) {
        REAL *places = (REAL *)lay(3 * X(SOME) * sizeof(REAL), IN);
        size_t i;
        for (i = 0; i < 3 * X(SOME); i++) {
            places[i] = (REAL)(BOX * noise(i));
        }
        pre_initial = STRUCT(2, IN, X(fixpair_positions));
        pre_initial->x = places;
        pre_initial->y = places + 1;
        pre_initial->z = places + 2;
        pre_initial->stride = 3;
        pre_initial->length = X(SOME);
    }
    conditions = X(conditions_at)(after);
    one = (fixpair_species *)(uintptr_t)conditions->species;
    fft = X(hook_at)(after + 1, SIDE, PAD);
    fine = X(hook_at)(after + 2, WORK_SIDE, 0);
    near = (X(fixpair_fft) *)lay(sizeof *near, IN);
    X(make_hook)(near, 8, 0);
    t.slots[after + 2].optional = 1;
    SCRATCH_OF(after + 3, bytes);
    exec_at(after + 4);
    length(0, bytes, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[after + 2] = NULL);
    ACCEPTED(conditions->order = FIXPAIR_ORDER_FIRST);
    ACCEPTED((conditions->order = FIXPAIR_ORDER_SECOND, conditions->species = NULL));
    X(refuse_components)(position, velocity);
    X(refuse_conditions)(conditions);
    refuse_lists_of_rows(conditions, position->x);
    refuse_rows(conditions);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, conditions->species = (fixpair_species *)(void *)((char *)one + 4));
    REFUSED(FIXPAIR_ERROR_OVERLAP, conditions->species = (fixpair_species *)(void *)position->x);
    refuse_species(one, &conditions->box_size, position->x);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->convention = 2);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, conditions->f_nl = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, conditions->redshift = -1.0);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.p[after + 2] = near);
    REFUSED(FIXPAIR_ERROR_BRICK, conditions->g_nl = 1.0);
    X(refuse_hooks)(fft);
    X(refuse_hooks)(fine);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fine->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fine->inverse = X(failing_pass));
    if (at) {
        X(refuse_places)(pre_initial, position->x);
        REFUSED(FIXPAIR_ERROR_BRICK, X(part_of_mesh)(fft));
        ACCEPTED(position->length = velocity->length = pre_initial->length = 0);
    }
}

static void X(refuse_third)(void) {
    X(fixpair_fft) *fft;
    fixpair_layout layout;
    fixpair_brick brick;
    size_t reals;
    int i;
    begin("third_order_sources_scratch" SUFFIX, X(call_third_order_sources_scratch));
    STRUCT(0, OUT, fixpair_layout);
    fft = X(hook_at)(1, SIDE, PAD);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    restore();
    MUST(X(fixpair_third_order_sources_scratch)(&layout, fft));
    brick = fft->fourier;
    MUST(fixpair_brick_reals(&reals, &brick));

    begin("third_order_sources" SUFFIX, X(call_third_order_sources));
    for (i = 0; i < 7; i++) {
        ARRAY(i, i < 6 ? OUT : IN, REAL, reals);
    }
    fft = X(hook_at)(7, SIDE, PAD);
    SCRATCH_OF(8, layout.size);
    exec_at(9);
    length(0, reals, LEAST);
    length(1, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));

    begin("transverse_displacement" SUFFIX, X(call_transverse_displacement));
    fft = X(hook_at)(4, SIDE, PAD);
    ARRAY(0, OUT, REAL, fft->length);
    for (i = 1; i < 4; i++) {
        ARRAY(i, IN, REAL, reals);
    }
    exec_at(5);
    t.a.d[0] = 1.0;
    length(0, fft->length, EXACT);
    length(1, reals, LEAST);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = 3);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = -(double)INFINITY);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
}

static void X(refuse_beyond_second_order)(void) {
    fixpair_layout layouts[2];
    X(refuse_queries)(layouts);
    X(refuse_beyond)(0, layouts[0].size);
    X(refuse_beyond)(1, layouts[1].size);
    X(refuse_third)();
}
