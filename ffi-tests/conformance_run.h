/*
 * The part of conformance.c about runs, in one precision: all steppers, outputs, an observer that stops, and runs that go on.
 */

enum { X(LATTICE) = 6, X(CROWD_OF_RUN) = X(LATTICE) * X(LATTICE) * X(LATTICE) };

/* What the observer sees. */
typedef struct {
    const X(fixpair_components) *state, *output;
    uint64_t reports;
    /* The step after which it stops the run; 0 for none. */
    size_t stop;
} X(witness);

static int32_t X(observe)(void *context, const fixpair_progress *progress) {
    X(witness) *witness = (X(witness) *)context;
    const X(fixpair_components) *shown = progress->event == FIXPAIR_EVENT_OUTPUT ? witness->output : witness->state;
    uint64_t numbers[4];
    double epoch[2];
    numbers[0] = (uint64_t)progress->event;
    numbers[1] = progress->step;
    numbers[2] = progress->steps;
    numbers[3] = progress->output;
    epoch[0] = progress->epoch.position;
    epoch[1] = progress->epoch.velocity;
    witness->reports = hash_bytes(hash_bytes(witness->reports, numbers, sizeof numbers), epoch, sizeof epoch);
    witness->reports = X(hash_particles)(X(hash_particles)(witness->reports, &shown[0]), &shown[1]);
    return progress->event == FIXPAIR_EVENT_STEP && progress->step == witness->stop;
}

/* A lattice, displaced; and the displacements of both orders. */
static void X(displaced_lattice)(X(fixpair_components) *both, REAL *psi1, REAL *psi2) {
    size_t i;
    for (i = 0; i < 3 * X(CROWD_OF_RUN); i++) {
        size_t particle = i / 3, side = X(LATTICE);
        size_t cell = i % 3 == 0 ? particle / (side * side) : i % 3 == 1 ? particle / side % side : particle % side;
        double first = 2.0 * noise(i), second = 0.25 * noise(i + 1000);
        *X(component)(&both[0], i) = (REAL)((double)cell * BOX / X(LATTICE) + first + second);
        *X(component)(&both[1], i) = (REAL)(150.0 * noise(i + 2000));
        psi1[i] = (REAL)first;
        psi2[i] = (REAL)second;
    }
}

/* One run, in one go or stopped after a step; `watched`: with outputs and an observer. */
static void X(one_run)(const char *name, int which, size_t stop, int watched, const X(built_in) *transform,
                       const fixpair_exec *exec) {
    static const double times[4] = {0.125, 0.3125, 0.75, 1.0};
    const size_t mesh_length = transform->fft.length, count = X(CROWD_OF_RUN);
    /* Each run with another layout of particles; the arrays of outputs with the next. */
    const int kind = (int)(stop + (size_t)which) % X(LAYOUTS);
    REAL *memory = X(reals)(8 * count), *output_memory = X(reals)(8 * count), *mesh[3], *psi[2];
    X(fixpair_components) both[2], output[2];
    X(fixpair_displacements) displacements;
    X(fixpair_outputs) outputs;
    X(witness) witness;
    fixpair_observer observer;
    fixpair_gravity gravity;
    fixpair_force_law laws[LAWS];
    fixpair_layout layout;
    fixpair_epoch epoch = {0.125, 0.125};
    double steps[STEPS];
    uint64_t hash = HASH_START;
    fixpair_status_t status;
    void *scratch;
    size_t i;
    make_laws(laws);
    MUST(fixpair_gravity_init(&gravity));
    gravity.box_size = BOX;
    gravity.law = laws[which];
    gravity.stepper = steppers[which];
    gravity.window = FIXPAIR_WINDOW_CIC + which;
    MUST(fixpair_logarithmic_steps(steps, STEPS, 0.125, 1.0));
    for (i = 0; i < 3; i++) {
        mesh[i] = X(reals)(mesh_length);
    }
    for (i = 0; i < 2; i++) {
        psi[i] = X(reals)(3 * count);
    }
    X(lay_out)(both, memory, count, kind);
    X(lay_out)(output, output_memory, count, (kind + 1) % X(LAYOUTS));
    X(displaced_lattice)(both, psi[0], psi[1]);
    displacements.first = X(view)(psi[0], count);
    displacements.second = X(view)(psi[1], count);
    displacements.scale_factor = 0.125;
    outputs.scale_factors = times;
    outputs.length = 4;
    outputs.position = output[0];
    outputs.velocity = output[1];
    witness.state = both;
    witness.output = output;
    witness.reports = HASH_START;
    witness.stop = stop;
    observer.context = &witness;
    observer.observe = X(observe);
    MUST(X(fixpair_evolve_scratch)(&layout, &transform->fft, count, gravity.window));
    scratch = take_scratch(layout.size);
    do {
        status = X(fixpair_evolve)(&both[0], &both[1], &epoch, &gravity,
                                   gravity.stepper == FIXPAIR_STEPPER_COLA ? &displacements : NULL, steps, STEPS,
                                   watched ? &outputs : NULL, mesh[0], mesh[1], mesh[2], mesh_length, &transform->fft,
                                   scratch, layout.size, watched ? &observer : NULL, exec);
        CHECK(status == (witness.stop > 0 ? FIXPAIR_ERROR_STOPPED : FIXPAIR_OK));
        if (status == FIXPAIR_ERROR_STOPPED) {
            /* State is the particles and the epoch; nothing else matters to the run that goes on. */
            CHECK(epoch.position == steps[stop] && epoch.velocity < steps[stop] && epoch.velocity > steps[stop - 1]);
            witness.stop = 0;
            for (i = 0; i < 3; i++) {
                memset(mesh[i], CANARY_BYTE, mesh_length * sizeof(REAL));
            }
            memset(scratch, CANARY_BYTE, layout.size);
        }
    } while (status == FIXPAIR_ERROR_STOPPED);
    hash = X(hash_particles)(X(hash_particles)(hash_layout(hash, layout), &both[0]), &both[1]);
    check_named("evolve.", name, SUFFIX, hash_bytes(hash_bytes(hash, &epoch.position, sizeof(double)), &epoch.velocity,
                                                    sizeof(double)));
    if (watched) {
        char full[32];
        snprintf(full, sizeof full, "%s.reports", name);
        check_named("evolve.", full, SUFFIX, witness.reports);
    }
    if (kind == X(MEMBERS)) {
        int untouched = 1;
        for (i = 0; i < count; i++) {
            untouched &= ((X(particle) *)memory)[i].mass == 0 && ((X(particle) *)memory)[i].potential == 0;
        }
        CHECK(untouched);
    }
    for (i = 0; i < 3; i++) {
        give_back(mesh[i]);
    }
    give_back(psi[0]);
    give_back(psi[1]);
    give_back(memory);
    give_back(output_memory);
    give_back(scratch);
}

static void X(gravity)(const fixpair_exec *exec) {
    static const char *const names[STEPPERS] = {"fastpm", "leapfrog", "cola"};
    X(built_in) transform;
    size_t stop;
    int which;
    X(forces)(exec);
    X(kicks_and_drifts)(exec);
    X(kicks_on_slabs)(exec);
    for (which = 0; which < STEPPERS; which++) {
        /* The padding of a plane is no business of the run. */
        X(open)(&transform, N, which == 1 ? PADDING : 0, exec);
        for (stop = 0; stop < STEPS; stop++) {
            X(one_run)(names[which], which, stop, 1, &transform, exec);
        }
        X(one_run)(names[which], which, 0, 0, &transform, exec);
        X(close)(&transform);
    }
}
