/*
 * The half of refusals.c that exists in both precisions: runs.
 */

enum { X(MOVED) = 8, X(ENTRIES) = 3, X(SHOWN) = 2 };

static int32_t X(calm)(void *context, const fixpair_progress *progress) {
    (void)context, (void)progress;
    return 0;
}

static int32_t X(stern)(void *context, const fixpair_progress *progress) {
    (void)context, (void)progress;
    return 1;
}

/* A transform of a whole mesh that calls itself a slab. */
static void X(part_of_mesh)(X(fixpair_fft) *fft) {
    MUST(fixpair_brick_slab(&fft->configuration, SIDE, FIXPAIR_SPACE_CONFIGURATION, 0, 3));
    MUST(fixpair_brick_transposed_slab(&fft->fourier, SIDE, 0, 3));
}

static void X(refuse_gravity)(fixpair_gravity *gravity) {
    double *numbers[2];
    int i;
    numbers[0] = &gravity->box_size;
    numbers[1] = &gravity->hubble;
    REFUSED(FIXPAIR_ERROR_VERSION, gravity->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, gravity->struct_size++);
    refuse_cosmologies(&gravity->cosmology);
    refuse_laws(&gravity->law);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, *numbers[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, *numbers[i] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, *numbers[i] = -100.0);
    }
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, gravity->cola_exponent = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, gravity->cola_exponent = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, gravity->cola_exponent = 10.5);
    ACCEPTED((gravity->stepper = FIXPAIR_STEPPER_FASTPM, gravity->cola_exponent = (double)NAN));
    REFUSED(FIXPAIR_ERROR_CHOICE, gravity->stepper = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, gravity->stepper = -1);
    REFUSED(FIXPAIR_ERROR_CHOICE, gravity->window = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, gravity->window = 5);
}

static void X(refuse_times)(double *steps, fixpair_epoch *epoch) {
    REFUSED(FIXPAIR_ERROR_LENGTH, (t.a.n[0] = 0, t.a.p[5] = NULL));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, steps[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, steps[2] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, steps[1] = steps[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, steps[2] = 0.3);
    REFUSED(FIXPAIR_ERROR_RANGE, steps[2] = 10.5);
    REFUSED(FIXPAIR_ERROR_RANGE, steps[0] = epoch->position = epoch->velocity = 9e-6);
    REFUSED(FIXPAIR_ERROR_RANGE, steps[0] = 0.2);
    REFUSED(FIXPAIR_ERROR_RANGE, epoch->position = 0.3);
    REFUSED(FIXPAIR_ERROR_RANGE, epoch->position = 0.5);
    REFUSED(FIXPAIR_ERROR_RANGE, epoch->velocity = 0.3);
    REFUSED(FIXPAIR_ERROR_RANGE, epoch->velocity = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, epoch->position = (double)NAN);
}

static void X(refuse_outputs)(X(fixpair_outputs) *outputs, double *times, REAL *moved) {
    REFUSED(FIXPAIR_ERROR_NULL, outputs->scale_factors = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, outputs->scale_factors = (double *)(void *)((char *)times + 4));
    REFUSED(FIXPAIR_ERROR_OVERFLOW, outputs->length = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, times[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, times[0] = 0.2);
    REFUSED(FIXPAIR_ERROR_RANGE, times[1] = 1.5);
    REFUSED(FIXPAIR_ERROR_RANGE, times[1] = times[0]);
    REFUSED(FIXPAIR_ERROR_NULL, outputs->position.y = NULL);
    REFUSED(FIXPAIR_ERROR_LENGTH, outputs->position.length--);
    REFUSED(FIXPAIR_ERROR_LENGTH, outputs->velocity.length--);
    REFUSED(FIXPAIR_ERROR_RANGE, outputs->velocity.stride = 0);
    REFUSED(FIXPAIR_ERROR_OVERLAP, outputs->velocity.z = outputs->position.z);
    REFUSED(FIXPAIR_ERROR_OVERLAP, outputs->position.x = moved);
    REFUSED(FIXPAIR_ERROR_OVERLAP, outputs->scale_factors = (double *)(void *)moved);
    ACCEPTED((outputs->length = 0, outputs->scale_factors = NULL));
}

static void X(refuse_runs)(void) {
    X(fixpair_components) *position, *velocity;
    X(fixpair_displacements) *displacements;
    X(fixpair_outputs) *outputs;
    X(fixpair_fft) *fft;
    fixpair_gravity *gravity;
    fixpair_epoch *epoch;
    fixpair_observer *observer;
    fixpair_layout layout;
    double *steps, *times;
    REAL *psi;
    size_t i;
    begin("evolve_scratch" SUFFIX, X(call_evolve_scratch));
    STRUCT(0, OUT, fixpair_layout);
    fft = X(hook_at)(1, SIDE, PAD);
    t.a.n[0] = X(MOVED);
    t.a.i[0] = FIXPAIR_WINDOW_PCS;
    refuse_pointers_and_lengths();
    X(refuse_hooks)(fft);
    refuse_windows();
    REFUSED(FIXPAIR_ERROR_BRICK, X(part_of_mesh)(fft));
    ACCEPTED(t.a.n[0] = 0);
    restore();
    MUST(X(fixpair_evolve_scratch)(&layout, fft, X(MOVED), FIXPAIR_WINDOW_CIC));

    begin("evolve" SUFFIX, X(call_evolve));
    position = X(vectors_at)(0, X(MOVED));
    velocity = X(vectors_at)(1, X(MOVED));
    epoch = STRUCT(2, OUT, fixpair_epoch);
    gravity = STRUCT(3, IN, fixpair_gravity);
    displacements = STRUCT(4, IN, X(fixpair_displacements));
    steps = ARRAY(5, IN, double, X(ENTRIES));
    outputs = STRUCT(6, IN, X(fixpair_outputs));
    t.slots[6].optional = 1;
    fft = X(hook_at)(10, SIDE, PAD);
    for (i = 7; i < 10; i++) {
        ARRAY((int)i, WORK, REAL, fft->length);
    }
    SCRATCH_OF(11, layout.size);
    observer = STRUCT(12, IN, fixpair_observer);
    t.slots[12].optional = 1;
    exec_at(13);
    psi = (REAL *)lay(3 * X(MOVED) * sizeof(REAL), IN);
    times = (double *)lay(X(SHOWN) * sizeof *times, IN);
    for (i = 0; i < 3 * X(MOVED); i++) {
        position->x[i] = (REAL)(BOX * (noise(i) + 1.0) / 2.0);
        psi[i] = (REAL)noise(i);
    }
    displacements->first.x = psi;
    displacements->first.y = psi + 1;
    displacements->first.z = psi + 2;
    displacements->first.stride = 3;
    displacements->first.length = X(MOVED);
    displacements->second = displacements->first;
    displacements->scale_factor = 0.25;
    outputs->scale_factors = times;
    outputs->length = X(SHOWN);
    outputs->position = *position;
    outputs->position.x = (REAL *)lay(3 * X(MOVED) * sizeof(REAL), OUT);
    outputs->position.y = outputs->position.x + 1;
    outputs->position.z = outputs->position.x + 2;
    outputs->velocity = *position;
    outputs->velocity.x = (REAL *)lay(3 * X(MOVED) * sizeof(REAL), OUT);
    outputs->velocity.y = outputs->velocity.x + 1;
    outputs->velocity.z = outputs->velocity.x + 2;
    times[0] = 0.3;
    times[1] = 1.0;
    steps[0] = epoch->position = epoch->velocity = 0.25;
    steps[1] = 0.5;
    steps[2] = 1.0;
    MUST(fixpair_gravity_init(gravity));
    gravity->box_size = BOX;
    gravity->stepper = FIXPAIR_STEPPER_COLA;
    observer->observe = X(calm);
    length(0, X(ENTRIES), FREE);
    length(1, fft->length, LEAST);
    length(2, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[6] = NULL);
    ACCEPTED(t.a.p[12] = NULL);
    ACCEPTED((gravity->stepper = FIXPAIR_STEPPER_FASTPM, t.a.p[4] = NULL));
    ACCEPTED((displacements->second.length = 0, displacements->second.x = NULL));
    ACCEPTED((t.a.n[0] = 1, t.a.p[6] = NULL));
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 1);
    X(refuse_components)(position, velocity);
    X(refuse_gravity)(gravity);
    X(refuse_times)(steps, epoch);
    X(refuse_outputs)(outputs, times, position->x);
    REFUSED(FIXPAIR_ERROR_NULL, displacements->first.x = NULL);
    REFUSED(FIXPAIR_ERROR_LENGTH, displacements->first.length--);
    REFUSED(FIXPAIR_ERROR_LENGTH, displacements->second.length--);
    REFUSED(FIXPAIR_ERROR_OVERLAP, displacements->second.y = velocity->y);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, displacements->scale_factor = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, displacements->scale_factor = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, displacements->scale_factor = 11.0);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, psi[4] = (REAL)NAN);
    X(refuse_hooks)(fft);
    REFUSED(FIXPAIR_ERROR_BRICK, X(part_of_mesh)(fft));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->forward = X(failing_pass));
    SPOILED(FIXPAIR_ERROR_HOOK, fft->inverse = X(failing_pass));
    REFUSED(FIXPAIR_ERROR_NULL, observer->observe = NULL);
    SPOILED(FIXPAIR_ERROR_STOPPED, observer->observe = X(stern));
    CHECK(epoch->position == 0.5 && epoch->velocity > 0.25 && epoch->velocity < 0.5);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, position->x[5] = (REAL)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, position->x[0] = -(REAL)INFINITY);
    SPOILED(FIXPAIR_ERROR_NOT_FINITE, velocity->x[5] = (REAL)NAN);
    /* An empty universe has no mean density. */
    restore();
    REFUSED(FIXPAIR_ERROR_RANGE, (position->length = velocity->length = displacements->first.length =
                                      displacements->second.length = outputs->position.length = outputs->velocity.length = 0));
}
