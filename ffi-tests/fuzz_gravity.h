/*
 * The part of fuzz.c about forces, kicks and drifts, steps in time, runs, groups, halos and spheres.
 */

static fixpair_force_law force_law(void) {
    fixpair_force_law law;
    MUST(fixpair_force_law_init(&law));
    if (word() % 3 == 0) {
        law.laplacian = choice();
        law.gradient = choice();
        law.window = choice();
        law.window_power = choice();
    }
    law.split_scale = word() % 4 ? 0.0 : number();
    return law;
}

/* Triples that begin at some place, mostly all of them. */
static fixpair_positions_f64 seen(const double *first, size_t most) {
    fixpair_positions_f64 of;
    of.x = first;
    of.y = first + 1;
    of.z = first + 2;
    of.stride = 3;
    of.length = word() % 8 ? most : (size_t)word() % (most + 1);
    return of;
}

static fixpair_components_f64 moved(double *first, size_t most) {
    fixpair_positions_f64 of = seen(first, most);
    fixpair_components_f64 same;
    same.x = first;
    same.y = first + 1;
    same.z = first + 2;
    same.stride = of.stride;
    same.length = of.length;
    return same;
}

/* Places in the box of 100 for the most part, anything now and then. */
static void scatter(double *to, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        to[i] = word() % 512 ? 100.0 * (double)(word() >> 11) / 9007199254740992.0 : number();
    }
}

static void forces(double *data, float *single, double *scratch) {
    fixpair_brick b = brick(), r = region();
    fixpair_force_law law = force_law();
    fixpair_layout layout = {0, 0};
    fixpair_step_factors factors;
    fixpair_cosmology cosmology;
    fixpair_positions_f64 position, psi[2];
    fixpair_components_f64 velocity;
    double steps[4], *members, box = maybe(100.0), *places = data + LENGTH;
    size_t third = LENGTH / 3;
    int32_t window = choice();
    MUST(fixpair_cosmology_init(&cosmology));
    members = &cosmology.omega_m;
    if (word() % 4 == 0) {
        members[word() % 9] = number();
    }
    sane(fixpair_force_scratch(&layout, size()));
    sane(fixpair_forces_f64(data, data + third, data + 2 * third, third, &b, &law, box, maybe(64.0), scratch, BYTES, NULL));
    sane(fixpair_force_f64(data, data + third, third, &b, few(4), &law, box, maybe(64.0), scratch, BYTES, NULL));
    sane(fixpair_potential_f64(data, third, &b, &law, box, maybe(64.0), scratch, BYTES, NULL));
    sane(fixpair_potential_f32(single, LENGTH / 2, &b, &law, box, maybe(64.0), scratch, size(), NULL));
    sane(fixpair_drift_factors(&factors, &cosmology, choice(), maybe(-2.5), maybe(0.25), maybe(0.5), maybe(0.375)));
    sane(fixpair_kick_factors(&factors, &cosmology, choice(), maybe(-2.5), maybe(0.25), maybe(0.5), maybe(0.375)));
    sane(fixpair_linear_steps(steps, word() % 5, maybe(0.25), maybe(1.0)));
    sane(fixpair_logarithmic_steps(steps, word() % 5, maybe(0.25), maybe(1.0)));
    scatter(places, 4 * 3 * CLOUD);
    velocity = moved(places, CLOUD);
    position = seen(places + 3 * CLOUD, CLOUD);
    psi[0] = seen(places + 6 * CLOUD, CLOUD);
    psi[1] = seen(places + 9 * CLOUD, CLOUD);
    memset(data, 0, LENGTH * sizeof *data);
    sane(fixpair_kick_scratch_f64(&layout, &r, few(100), window));
    sane(fixpair_kick_f64(&velocity, &position, data, data + third, data + 2 * third, third, &r, box, window,
                          word() % 2 ? 0.0 : maybe(0.5), maybe(1.0), maybe(1.0), maybe(0.0), maybe(0.0),
                          word() % 2 ? &psi[0] : NULL, word() % 2 ? &psi[1] : NULL, scratch, BYTES, NULL));
    sane(fixpair_drift_f64(&velocity, &position, box, maybe(1.0), maybe(0.0), maybe(0.0), word() % 2 ? &psi[0] : NULL,
                           word() % 2 ? &psi[1] : NULL, NULL));
}

static int32_t fickle(void *context, const fixpair_progress *progress) {
    (void)context;
    CHECK(progress->step <= progress->steps && progress->event >= 0 && progress->event <= 1);
    return word() % 8 == 0;
}

/* 64 particles on a mesh of 8: three times its length from data on, then everything else. */
static void runs(double *data, double *scratch, const fixpair_fft_f64 *fft) {
    enum { MESH = 8 * 8 * 10 };
    fixpair_gravity gravity;
    fixpair_epoch epoch;
    fixpair_outputs_f64 outputs;
    fixpair_displacements_f64 displacements;
    fixpair_components_f64 position, velocity;
    fixpair_observer observer = {NULL, fickle};
    fixpair_layout layout;
    fixpair_status_t status;
    double steps[4], times[2], *places = data + 3 * MESH;
    int i, stops = 0;
    MUST(fixpair_gravity_init(&gravity));
    gravity.law = force_law();
    gravity.box_size = maybe(100.0);
    gravity.hubble = maybe(100.0);
    gravity.cola_exponent = maybe(-2.5);
    gravity.stepper = word() % 4 ? (int32_t)(word() % 3) : choice();
    gravity.window = word() % 4 ? 1 + (int32_t)(word() % 4) : choice();
    if (word() % 4 == 0) {
        (&gravity.cosmology.omega_m)[word() % 9] = number();
    }
    scatter(places, 6 * 3 * CLOUD);
    position = moved(places, CLOUD);
    velocity = moved(places + 3 * CLOUD, CLOUD);
    outputs.position = moved(places + 6 * CLOUD, CLOUD);
    outputs.velocity = moved(places + 9 * CLOUD, CLOUD);
    outputs.scale_factors = times;
    outputs.length = word() % 3;
    displacements.first = seen(places + 12 * CLOUD, CLOUD);
    displacements.second = seen(places + 15 * CLOUD, word() % 4 ? CLOUD : 0);
    displacements.scale_factor = maybe(0.25);
    for (i = 0; i < 4; i++) {
        steps[i] = word() % 16 ? 0.25 * (i + 1) : number();
    }
    times[0] = word() % 8 ? 0.25 + 0.75 * (double)(word() % 8) / 8.0 : number();
    times[1] = word() % 8 ? 1.0 : number();
    epoch.position = word() % 8 ? 0.25 : maybe(0.5);
    epoch.velocity = word() % 8 ? 0.25 : maybe(0.5);
    sane(fixpair_evolve_scratch_f64(&layout, fft, size(), gravity.window));
    do {
        status = fixpair_evolve_f64(&position, &velocity, &epoch, &gravity, word() % 4 ? &displacements : NULL, steps, 4,
                                    word() % 2 ? &outputs : NULL, data, data + MESH, data + 2 * MESH, MESH, fft, scratch,
                                    BYTES, word() % 2 ? &observer : NULL, NULL);
        sane(status);
    } while (status == FIXPAIR_ERROR_STOPPED && ++stops < 8);
    if (status == FIXPAIR_OK) {
        int sound = epoch.position == steps[3] && epoch.velocity == steps[3];
        for (i = 0; (size_t)i < 3 * position.length; i++) {
            sound &= position.x[i] >= 0 && position.x[i] < gravity.box_size && isfinite(velocity.x[i]);
        }
        CHECK(sound);
    }
}

static void groups(double *data, void *scratch) {
    uint64_t labels[CLOUD], map[4 * 8], pairs[2 * 8], ids[CLOUD];
    fixpair_halo halos[CLOUD];
    fixpair_halo_sums sums[CLOUD];
    fixpair_sphere spheres[8];
    fixpair_positions_f64 position, velocity;
    fixpair_cosmology cosmology;
    fixpair_layout layout;
    double centres[4 * 3], radii[4], densities[2], value, box = maybe(100.0), mass = maybe(1e10);
    size_t entries = 0, count = 0, i;
    MUST(fixpair_cosmology_init(&cosmology));
    scatter(data, 6 * CLOUD);
    position = seen(data, CLOUD);
    velocity = seen(data + 3 * CLOUD, position.length);
    for (i = 0; i < CLOUD; i++) {
        ids[i] = labels[i] = word() % 16 ? i : word();
    }
    for (i = 0; i < 16; i++) {
        pairs[i] = word() % 16;
    }
    for (i = 0; i < 12; i++) {
        centres[i] = maybe(7.0 * (double)i);
    }
    for (i = 0; i < 4; i++) {
        radii[i] = maybe(10.0);
    }
    densities[0] = maybe(200.0);
    densities[1] = maybe(2.0);
    sane(fixpair_linking_length(&value, maybe(0.2), maybe(100.0), few(100)));
    sane(fixpair_particle_mass(&value, maybe(0.3), maybe(100.0), few(100)));
    sane(fixpair_overdensity(&value, choice(), maybe(200.0), &cosmology, maybe(0.5)));
    sane(fixpair_fof_labels_scratch_f64(&layout, size()));
    sane(fixpair_halos_scratch(&layout, size()));
    sane(fixpair_spheres_scratch_f64(&layout, size()));
    sane(fixpair_fof_labels_f64(labels, position.length, &position, ids, word() % 2 ? position.length : 0, box,
                                maybe(word() % 2 ? 5.0 : 40.0), scratch, BYTES, NULL));
    sane(fixpair_fof_merge(map, word() % 17, &entries, pairs, word() % 9));
    if (entries > 0) {
        sane(fixpair_fof_relabel(labels, position.length, map, entries, NULL));
    }
    sane(fixpair_halos_f64(halos, word() % (CLOUD + 1), &count, labels, position.length, &position, word() % 2 ? &velocity : NULL,
                           box, word() % 4, mass, scratch, BYTES, NULL));
    CHECK(count <= CLOUD);
    count = 0;
    sane(fixpair_halo_sums_f64(sums, word() % (CLOUD + 1), &count, labels, position.length, &position,
                               word() % 2 ? &velocity : NULL, box, word() % 4, map, entries, scratch, BYTES, NULL));
    for (i = 0; i < count; i++) {
        sums[i].label = word() % 4;
        sums[i].position[0] = maybe(sums[i].position[0]);
    }
    sane(fixpair_halo_sums_merge(sums, count, &entries, box));
    sane(fixpair_halos_finish(halos, CLOUD, &entries, sums, count, box, word() % 4, mass));
    sane(fixpair_refine_centres_f64(centres, 4, radii, &position, box, maybe(0.9), word() % 4, scratch, BYTES, NULL));
    sane(fixpair_spheres_f64(spheres, 8, centres, 4, densities, 2, &position, box, word() % 8 ? CLOUD : word(), mass, word() % 4,
                             scratch, BYTES, NULL));
}
