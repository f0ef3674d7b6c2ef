/*
 * The part of conformance.c about steps in time, force laws and numbers of halos that has one precision.
 */

enum { STEPPERS = 3, STEPS = 5, LAWS = 3 };
static const int32_t steppers[STEPPERS] = {FIXPAIR_STEPPER_FASTPM, FIXPAIR_STEPPER_LEAPFROG, FIXPAIR_STEPPER_COLA};

static void make_laws(fixpair_force_law *laws) {
    int i;
    for (i = 0; i < LAWS; i++) {
        MUST(fixpair_force_law_init(&laws[i]));
    }
    laws[1].laplacian = FIXPAIR_DIFFERENCE_TWO_POINT;
    laws[1].gradient = FIXPAIR_DIFFERENCE_FOUR_POINT;
    laws[1].window = FIXPAIR_WINDOW_CIC;
    laws[1].window_power = 1;
    laws[2].gradient = FIXPAIR_DIFFERENCE_FOUR_POINT;
    laws[2].window = FIXPAIR_WINDOW_PCS;
    laws[2].split_scale = 1.25 * BOX / N;
}

static uint64_t hash_law(const fixpair_force_law *law) {
    uint64_t numbers[4];
    numbers[0] = (uint64_t)law->laplacian;
    numbers[1] = (uint64_t)law->gradient;
    numbers[2] = (uint64_t)law->window;
    numbers[3] = (uint64_t)law->window_power;
    return hash_bytes(hash_bytes(HASH_START, numbers, sizeof numbers), &law->split_scale, sizeof law->split_scale);
}

static void steps_in_time(void) {
    static const double times[2][3] = {{0.125, 0.25, 0.1875}, {0.5, 0.25, 0.3125}};
    fixpair_force_law law;
    fixpair_gravity gravity;
    fixpair_cosmology cosmology;
    fixpair_layout layout;
    fixpair_step_factors factors[2];
    double steps[2 * STEPS], units[3];
    uint64_t hash, choices[2];
    int i, j;
    MUST(fixpair_force_law_init(&law));
    CHECK(law.struct_size == sizeof law);
    check_case("force_law_init", hash_law(&law));
    MUST(fixpair_gravity_init(&gravity));
    CHECK(gravity.struct_size == sizeof gravity);
    CHECK(gravity.law.struct_size == sizeof law);
    CHECK(gravity.cosmology.struct_size == sizeof cosmology);
    CHECK(gravity.cola_exponent == FIXPAIR_COLA_EXPONENT);
    units[0] = gravity.box_size;
    units[1] = gravity.hubble;
    units[2] = gravity.cola_exponent;
    choices[0] = (uint64_t)gravity.stepper;
    choices[1] = (uint64_t)gravity.window;
    hash = hash_bytes(hash_law(&gravity.law), &gravity.cosmology.omega_m, 9 * sizeof(double));
    check_case("gravity_init", hash_bytes(hash_bytes(hash, units, sizeof units), choices, sizeof choices));
    MUST(fixpair_force_scratch(&layout, N));
    check_case("force_scratch", hash_layout(HASH_START, layout));
    MUST(fixpair_cosmology_init(&cosmology));
    hash = HASH_START;
    for (i = 0; i < STEPPERS; i++) {
        for (j = 0; j < 2; j++) {
            const double *a = times[j];
            MUST(fixpair_drift_factors(&factors[0], &cosmology, steppers[i], FIXPAIR_COLA_EXPONENT, a[0], a[1], a[2]));
            MUST(fixpair_kick_factors(&factors[1], &cosmology, steppers[i], FIXPAIR_COLA_EXPONENT, a[0], a[1], a[2]));
            hash = hash_bytes(hash, factors, sizeof factors);
        }
    }
    check_case("step_factors", hash);
    MUST(fixpair_linear_steps(steps, STEPS, 0.125, 1.0));
    MUST(fixpair_logarithmic_steps(steps + STEPS, STEPS, 0.125, 1.0));
    CHECK(steps[0] == 0.125 && steps[STEPS - 1] == 1.0 && steps[STEPS] == 0.125 && steps[2 * STEPS - 1] == 1.0);
    check_case("steps", hash_bytes(HASH_START, steps, sizeof steps));
}

enum { CROWD = 400, CLUMPED = 300, THREADED = 350, CLUMPS = 10, LEAST_MEMBERS = 10, DENSITIES = 3 };

static void numbers_of_halos(void) {
    fixpair_cosmology cosmology;
    fixpair_layout layout;
    double length, mass, delta[3];
    /* What a program in another language takes for granted. */
    CHECK(sizeof(fixpair_halo) == 112 && offsetof(fixpair_halo, radius) == 72);
    CHECK(sizeof(fixpair_halo_sums) == 176 && offsetof(fixpair_halo_sums, position_squared) == 88);
    CHECK(sizeof(fixpair_sphere) == 24 && sizeof(fixpair_epoch) == 16 && sizeof(fixpair_step_factors) == 24);
    MUST(fixpair_linking_length(&length, 0.2, BOX, CROWD));
    check_case("linking_length", hash_bytes(HASH_START, &length, sizeof length));
    MUST(fixpair_particle_mass(&mass, 0.27, BOX, CROWD));
    check_case("particle_mass", hash_bytes(HASH_START, &mass, sizeof mass));
    MUST(fixpair_cosmology_init(&cosmology));
    MUST(fixpair_overdensity(&delta[0], FIXPAIR_OVERDENSITY_MEAN, 200.0, &cosmology, 0.5));
    MUST(fixpair_overdensity(&delta[1], FIXPAIR_OVERDENSITY_CRITICAL, 200.0, &cosmology, 0.5));
    MUST(fixpair_overdensity(&delta[2], FIXPAIR_OVERDENSITY_VIRIAL, 0.0, &cosmology, 0.5));
    check_case("overdensity", hash_bytes(HASH_START, delta, sizeof delta));
    MUST(fixpair_halos_scratch(&layout, CROWD));
    check_case("halos_scratch", hash_layout(HASH_START, layout));
}
