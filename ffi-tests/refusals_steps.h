/*
 * The part of refusals.c about force laws, steps in time and halos that exists in one precision.
 */

CALL(force_law_init, (P(0)))
CALL(force_scratch, (P(0), L(0)))
CALL(gravity_init, (P(0)))
CALL(drift_factors, (P(0), P(1), a->i[0], a->d[0], a->d[1], a->d[2], a->d[3]))
CALL(kick_factors, (P(0), P(1), a->i[0], a->d[0], a->d[1], a->d[2], a->d[3]))
CALL(linear_steps, (P(0), L(0), a->d[0], a->d[1]))
CALL(logarithmic_steps, (P(0), L(0), a->d[0], a->d[1]))
CALL(linking_length, (P(0), a->d[0], a->d[1], a->u))
CALL(particle_mass, (P(0), a->d[0], a->d[1], a->u))
CALL(overdensity, (P(0), a->i[0], a->d[0], P(1), a->d[1]))
CALL(fof_merge, (P(0), L(0), P(1), P(2), L(1)))
CALL(fof_relabel, (P(0), L(0), P(1), L(1), P(2)))
CALL(halos_scratch, (P(0), L(0)))
CALL(halo_count, (P(0), P(1), L(0), a->u, P(2), L(1), P(3)))
CALL(halo_sums_merge, (P(0), L(0), P(1), a->d[0]))
CALL(halos_finish, (P(0), L(0), P(1), P(2), L(1), a->d[0], a->u, a->d[1]))

static void factors_of_steps(void) {
    fixpair_cosmology *cosmology;
    int which, i;
    begin("force_law_init", call_force_law_init);
    STRUCT(0, OUT, fixpair_force_law);
    refuse_pointers_and_lengths();
    begin("gravity_init", call_gravity_init);
    STRUCT(0, OUT, fixpair_gravity);
    refuse_pointers_and_lengths();
    begin("force_scratch", call_force_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, SIDE, FREE);
    refuse_pointers_and_lengths();
    for (which = 0; which < 2; which++) {
        begin(which ? "kick_factors" : "drift_factors", which ? call_kick_factors : call_drift_factors);
        STRUCT(0, OUT, fixpair_step_factors);
        cosmology = STRUCT(1, IN, fixpair_cosmology);
        MUST(fixpair_cosmology_init(cosmology));
        t.a.i[0] = FIXPAIR_STEPPER_COLA;
        t.a.d[0] = FIXPAIR_COLA_EXPONENT;
        t.a.d[1] = 0.25;
        t.a.d[2] = 0.5;
        t.a.d[3] = 0.375;
        refuse_pointers_and_lengths();
        ACCEPTED(t.a.i[0] = FIXPAIR_STEPPER_LEAPFROG);
        ACCEPTED((t.a.i[0] = FIXPAIR_STEPPER_FASTPM, t.a.d[0] = (double)NAN));
        refuse_cosmologies(cosmology);
        REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 3);
        REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
        for (i = 0; i < 4; i++) {
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 0.0);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 10.5);
        }
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -10.5);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 9e-6);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[3] = -0.5);
    }
    for (which = 0; which < 2; which++) {
        begin(which ? "logarithmic_steps" : "linear_steps", which ? call_logarithmic_steps : call_linear_steps);
        ARRAY(0, OUT, double, 4);
        length(0, 4, FREE);
        t.a.d[0] = 0.1;
        t.a.d[1] = 1.0;
        refuse_pointers_and_lengths();
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 1);
        REFUSED(FIXPAIR_ERROR_LENGTH, (t.a.n[0] = 0, t.a.p[0] = NULL));
        for (i = 0; i < 2; i++) {
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 0.0);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = -1.0);
        }
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1.0);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 2.0);
    }
}

static void densities_of_halos(void) {
    fixpair_cosmology *cosmology;
    int which, i;
    for (which = 0; which < 2; which++) {
        begin(which ? "particle_mass" : "linking_length", which ? call_particle_mass : call_linking_length);
        ARRAY(0, OUT, double, 1);
        t.a.d[0] = 0.3;
        t.a.d[1] = BOX;
        t.a.u = 1000;
        refuse_pointers_and_lengths();
        for (i = 0; i < 2; i++) {
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = -(double)INFINITY);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 0.0);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = -1.0);
        }
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = t.a.d[1] = 1e300);
    }
    begin("overdensity", call_overdensity);
    ARRAY(0, OUT, double, 1);
    cosmology = STRUCT(1, IN, fixpair_cosmology);
    MUST(fixpair_cosmology_init(cosmology));
    t.a.i[0] = FIXPAIR_OVERDENSITY_CRITICAL;
    t.a.d[0] = 200.0;
    t.a.d[1] = 0.5;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.i[0] = FIXPAIR_OVERDENSITY_VIRIAL, t.a.d[0] = (double)NAN));
    refuse_cosmologies(cosmology);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = -1.0);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.i[0] = FIXPAIR_OVERDENSITY_VIRIAL, cosmology->omega_de = 0.5));
}

/* Sums of one particle each, at p[pointer]. */
static fixpair_halo_sums *sums_at(int pointer, role role, size_t count) {
    fixpair_halo_sums *sums = (fixpair_halo_sums *)argument(pointer, role, count * sizeof *sums, sizeof(void *));
    size_t i;
    for (i = 0; i < count; i++) {
        sums[i].label = i;
        sums[i].members = 1;
        sums[i].reference[0] = BOX / 2;
    }
    return sums;
}

static void refuse_sums(fixpair_halo_sums *sums) {
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, sums[1].reference[2] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, sums[1].reference[1] = BOX);
    REFUSED(FIXPAIR_ERROR_RANGE, sums[1].reference[1] = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, sums[0].members = 0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, sums[1].position[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, sums[1].velocity_squared = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, sums[0].high[2] = -(double)INFINITY);
}

static void groups_of_processes(void) {
    fixpair_halo_sums *sums;
    uint64_t *map;
    size_t i;
    fixpair_layout layout;
    begin("fof_merge", call_fof_merge);
    ARRAY(0, OUT, uint64_t, 12);
    ARRAY(1, OUT, size_t, 1);
    map = ARRAY(2, IN, uint64_t, 6);
    for (i = 0; i < 6; i++) {
        map[i] = i;
    }
    length(0, 6, LEAST);
    length(1, 3, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = t.a.n[1] = 0, t.a.p[0] = NULL, t.a.p[2] = NULL));

    begin("fof_relabel", call_fof_relabel);
    ARRAY(0, OUT, uint64_t, 5);
    map = ARRAY(1, IN, uint64_t, 6);
    exec_at(2);
    map[0] = 1;
    map[2] = 2;
    map[4] = UINT64_MAX;
    length(0, 5, FREE);
    length(1, 3, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = t.a.n[1] = 0, t.a.p[0] = NULL, t.a.p[1] = NULL));
    REFUSED(FIXPAIR_ERROR_TABLE, map[2] = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, map[2] = 0);

    begin("halos_scratch", call_halos_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, 100, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX >> (sizeof(size_t) * 8 - 33));

    begin("halo_count", call_halo_count);
    ARRAY(0, OUT, size_t, 1);
    ARRAY(1, IN, uint64_t, 8);
    MUST(fixpair_halos_scratch(&layout, 8));
    SCRATCH_OF(2, layout.size);
    exec_at(3);
    length(0, 8, FREE);
    length(1, layout.size, SCRATCH);
    t.a.u = 2;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);

    begin("halo_sums_merge", call_halo_sums_merge);
    sums = sums_at(0, OUT, 2);
    ARRAY(1, OUT, size_t, 1);
    length(0, 2, FREE);
    t.a.d[0] = BOX;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL));
    refuse_sums(sums);

    begin("halos_finish", call_halos_finish);
    argument(0, OUT, 2 * sizeof(fixpair_halo), sizeof(void *));
    ARRAY(1, OUT, size_t, 1);
    sums = sums_at(2, IN, 2);
    length(0, 2, LEAST);
    length(1, 2, FREE);
    t.a.d[0] = BOX;
    t.a.d[1] = 1e10;
    t.a.u = 1;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[1] = 0, t.a.p[2] = NULL));
    ACCEPTED((t.a.u = 2, t.a.n[0] = 0, t.a.p[0] = NULL));
    refuse_sums(sums);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = -1.0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[1] = (double)NAN);
}
