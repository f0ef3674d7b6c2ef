/*
 * The half of refusals.c that exists in both precisions: the stages of the initial conditions, and the one call.
 */

CALL_REAL(scale_modes, (P(0), L(0), P(1), P(2), L(1), P(3)))
CALL_REAL(copy_modes, (P(0), L(0), P(1), P(2), L(1), P(3), P(4)))
CALL_REAL(add_local_scratch, (P(0), P(1)))
CALL_REAL(add_local, (P(0), L(0), P(1), a->d[0], a->d[1], P(2), P(3), L(1), P(4), L(2), P(5)))
CALL_REAL(second_order_source, (P(0), L(0), P(1), L(1), P(2), P(3), P(4), P(5), P(6), L(2), P(7)))
CALL_REAL(displacement, (P(0), L(0), P(1), L(1), P(2), L(2), a->d[0], P(3), P(4)))
CALL_REAL(displace, (P(0), P(1), P(2), P(3), L(0), P(4), L(1), a->d[0], a->d[1], a->d[2], P(5)))
CALL_REAL(initial_conditions_scratch, (P(0), P(1), P(2), P(3)))
CALL_REAL(initial_conditions, (P(0), P(1), P(2), P(3), P(4), P(5), L(0), P(6)))

/* Triples for each cell of a mesh of SIDE, at p[pointer]. */
static X(fixpair_components) *X(components_at)(int pointer) {
    X(fixpair_components) *components = STRUCT(pointer, IN, X(fixpair_components));
    components->x = (REAL *)lay(3 * SIDE * SIDE * SIDE * sizeof(REAL), OUT);
    components->y = components->x + 1;
    components->z = components->x + 2;
    components->stride = 3;
    components->length = SIDE * SIDE * SIDE;
    return components;
}

static void X(refuse_components)(X(fixpair_components) *position, X(fixpair_components) *velocity) {
    REFUSED(FIXPAIR_ERROR_NULL, position->x = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, position->z = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, velocity->y = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, position->y = (REAL *)(void *)((char *)position->y + sizeof(REAL) / 2));
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, velocity->z = (REAL *)(void *)((char *)velocity->z + 1));
    REFUSED(FIXPAIR_ERROR_LENGTH, position->length--);
    REFUSED(FIXPAIR_ERROR_LENGTH, velocity->length--);
    REFUSED(FIXPAIR_ERROR_LENGTH, position->length = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, position->length = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, velocity->stride = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, position->stride = 0);
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->y = position->x);
    REFUSED(FIXPAIR_ERROR_OVERLAP, velocity->z = velocity->x + 3);
    REFUSED(FIXPAIR_ERROR_OVERLAP, velocity->x = position->x);
    REFUSED(FIXPAIR_ERROR_OVERLAP, velocity->y = position->z + 30);
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->stride = 1);
}

static void X(refuse_stages)(void) {
    fixpair_brick brick, cells, work_brick, *own, *other;
    X(fixpair_components) *position, *velocity;
    X(fixpair_fft) *fft, *near;
    fixpair_layout layout;
    REAL *psi;
    size_t reals, work_reals, entries;
    int i;
    MUST(fixpair_brick_whole(&brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_whole(&cells, SIDE, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_brick_whole(&work_brick, WORK_SIDE, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_reals(&reals, &brick));
    MUST(fixpair_brick_reals(&work_reals, &work_brick));
    MUST(fixpair_mode_table_length(&entries, SIDE));

    begin("scale_modes" SUFFIX, X(call_scale_modes));
    ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    *own = brick;
    ARRAY(2, IN, double, entries);
    exec_at(3);
    length(0, reals, LEAST);
    length(1, entries, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);

    begin("copy_modes" SUFFIX, X(call_copy_modes));
    ARRAY(0, OUT, REAL, work_reals);
    other = STRUCT(1, IN, fixpair_brick);
    *other = work_brick;
    ARRAY(2, IN, REAL, reals);
    own = STRUCT(3, IN, fixpair_brick);
    *own = brick;
    exec_at(4);
    length(0, work_reals, LEAST);
    length(1, reals, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    refuse_bricks(other);
    REFUSED(FIXPAIR_ERROR_BRICK, own->count[0]--);
    REFUSED(FIXPAIR_ERROR_BRICK, (own->count[2] = 1, own->start[2] = 1));

    begin("add_local_scratch" SUFFIX, X(call_add_local_scratch));
    STRUCT(0, OUT, fixpair_layout);
    fft = X(hook_at)(1, WORK_SIDE, PAD);
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    restore();
    MUST(X(fixpair_add_local_scratch)(&layout, fft));

    begin("add_local" SUFFIX, X(call_add_local));
    ARRAY(0, OUT, REAL, reals);
    own = STRUCT(1, IN, fixpair_brick);
    *own = brick;
    fft = X(hook_at)(2, WORK_SIDE, PAD);
    near = (X(fixpair_fft) *)lay(sizeof *near, IN);
    X(make_hook)(near, 8, 0);
    ARRAY(3, WORK, REAL, fft->length);
    SCRATCH_OF(4, layout.size);
    exec_at(5);
    t.a.d[0] = 1.0;
    length(0, reals, LEAST);
    length(1, fft->length, LEAST);
    length(2, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_hooks)(fft);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
    }
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.p[2] = near);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.d[1] = 1.0);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));

    begin("second_order_source" SUFFIX, X(call_second_order_source));
    ARRAY(0, OUT, REAL, reals);
    ARRAY(1, IN, REAL, reals);
    own = STRUCT(2, IN, fixpair_brick);
    *own = brick;
    fft = X(hook_at)(3, WORK_SIDE, PAD);
    near = (X(fixpair_fft) *)lay(sizeof *near, IN);
    X(make_hook)(near, 8, 0);
    for (i = 4; i < 7; i++) {
        ARRAY(i, WORK, REAL, fft->length);
    }
    exec_at(7);
    length(0, reals, LEAST);
    length(1, reals, LEAST);
    length(2, fft->length, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_hooks)(fft);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.p[3] = near);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));

    begin("displacement" SUFFIX, X(call_displacement));
    ARRAY(0, OUT, REAL, reals + 2 * SIDE * PAD);
    ARRAY(1, IN, REAL, reals);
    own = STRUCT(2, IN, fixpair_brick);
    *own = brick;
    fft = X(hook_at)(3, SIDE, PAD);
    exec_at(4);
    t.a.d[0] = 1.0;
    length(0, fft->length, EXACT);
    length(1, reals, LEAST);
    refuse_pointers_and_lengths();
    refuse_bricks(own);
    X(refuse_hooks)(fft);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = 3);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = -(double)INFINITY);
    REFUSED(FIXPAIR_ERROR_BRICK, (void)fixpair_brick_whole(own, 4, FIXPAIR_SPACE_FOURIER, 0));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));

    begin("displace" SUFFIX, X(call_displace));
    position = X(components_at)(0);
    velocity = X(components_at)(1);
    psi = ARRAY(2, IN, REAL, reals);
    ARRAY(3, IN, REAL, reals);
    t.slots[3].optional = 1;
    own = STRUCT(4, IN, fixpair_brick);
    *own = cells;
    exec_at(5);
    t.a.d[0] = BOX;
    t.a.d[1] = t.a.d[2] = 1.0;
    MUST(fixpair_brick_reals(&t.a.n[0], &cells));
    length(0, t.a.n[0], LEAST);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[3] = NULL);
    refuse_bricks(own);
    X(refuse_components)(position, velocity);
    REFUSED(FIXPAIR_ERROR_OVERLAP, position->x = psi);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 3);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    for (i = 0; i < 3; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
    }
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, psi[5] = (REAL)NAN);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, psi[5] = (REAL)INFINITY);
}

/* The conditions and hooks that the one call and its scratch query share. */
static void X(refuse_conditions)(fixpair_conditions *conditions) {
    REFUSED(FIXPAIR_ERROR_VERSION, conditions->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, conditions->struct_size++);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->order = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->order = 4);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->shape = FIXPAIR_SHAPE_ROWS + 1);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->shape = -1);
}

static void X(refuse_universes)(void) {
    X(fixpair_components) *position, *velocity;
    X(fixpair_fft) *fft, *fine, *near;
    fixpair_conditions *conditions;
    fixpair_layout layout;
    double *k, *power, transfer[ROWS], *numbers[4];
    int i;
    begin("initial_conditions_scratch" SUFFIX, X(call_initial_conditions_scratch));
    STRUCT(0, OUT, fixpair_layout);
    conditions = STRUCT(1, IN, fixpair_conditions);
    MUST(fixpair_conditions_init(conditions, SEED));
    fft = X(hook_at)(2, SIDE, PAD);
    fine = X(hook_at)(3, WORK_SIDE, 0);
    t.slots[3].optional = 1;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[3] = NULL);
    X(refuse_conditions)(conditions);
    X(refuse_hooks)(fft);
    X(refuse_hooks)(fine);
    restore();
    MUST(X(fixpair_initial_conditions_scratch)(&layout, conditions, fft, fine));

    begin("initial_conditions" SUFFIX, X(call_initial_conditions));
    position = X(components_at)(0);
    velocity = X(components_at)(1);
    conditions = STRUCT(2, IN, fixpair_conditions);
    fft = X(hook_at)(3, SIDE, PAD);
    fine = X(hook_at)(4, WORK_SIDE, 0);
    near = (X(fixpair_fft) *)lay(sizeof *near, IN);
    X(make_hook)(near, 8, 0);
    t.slots[4].optional = 1;
    SCRATCH_OF(5, layout.size);
    exec_at(6);
    k = (double *)lay(ROWS * sizeof *k, IN);
    power = (double *)lay(ROWS * sizeof *power, IN);
    fill_rows(k, power, transfer);
    MUST(fixpair_conditions_init(conditions, SEED));
    conditions->box_size = BOX;
    conditions->f_nl = 100.0;
    conditions->linear.source = FIXPAIR_LINEAR_POWER;
    conditions->linear.k = k;
    conditions->linear.value = power;
    conditions->linear.rows = ROWS;
    length(0, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[4] = NULL);
    ACCEPTED(conditions->order = FIXPAIR_ORDER_FIRST);
    X(refuse_components)(position, velocity);
    X(refuse_conditions)(conditions);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->convention = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, conditions->convention = -1);
    refuse_realisations(&conditions->realisation);
    refuse_cosmologies(&conditions->cosmology);
    refuse_linears(&conditions->linear, position->x);
    numbers[0] = &conditions->redshift;
    numbers[1] = &conditions->box_size;
    numbers[2] = &conditions->f_nl;
    numbers[3] = &conditions->g_nl;
    for (i = 0; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = -(double)INFINITY);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, conditions->redshift = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, conditions->redshift = 1e9);
    REFUSED(FIXPAIR_ERROR_RANGE, conditions->box_size = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, conditions->box_size = -BOX);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.p[4] = near);
    REFUSED(FIXPAIR_ERROR_BRICK, conditions->g_nl = 1.0);
    X(refuse_hooks)(fft);
    X(refuse_hooks)(fine);
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fine->inverse = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fine->forward = X(failing_pass));
}
