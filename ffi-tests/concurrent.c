/*
 * Several threads of the host in the library at once: what is immutable they share, the pool they share too, and each gets the bits that it
 * gets alone. Pools that come and go, kernels called from inside chunks of their own pool, and from an observer.
 *
 * concurrent [ROUNDS]: more rounds of each
 */
#define _POSIX_C_SOURCE 200112L

#include "handovers.h"
#include "hosts.h"

enum { CALLERS = 4, SIDE = 16, PARTICLES = SIDE * SIDE * SIDE, EDGES = 7, TRIANGLES = 100, POOL = 3, STEPS = 3 };

/* What all threads read. */
static struct {
    void *tables;
    size_t tables_len, triangles_len;
    double k[ROWS], power[ROWS], transfer[ROWS];
    fixpair_binning binning;
    uint32_t triangles[3 * TRIANGLES];
} shared;

static const uint64_t edges[EDGES] = {1, 4, 9, 16, 25, 36, 49};

/* One universe, from its seed to its halos and spectra, in memory of its own. */
typedef struct {
    const fixpair_exec *exec;
    uint64_t seed, hash;
    fixpair_fft_f64 fft;
    void *workspace, *scratch;
    size_t workspace_len, scratch_len, words, fields_len;
    double *mesh, *particles, *fields;
    int64_t *sums;
    uint64_t *labels;
} universe;

static void make_shared(void) {
    fixpair_layout layout;
    MUST(fixpair_fft_tables_scratch_f64(&layout, SIDE));
    shared.tables_len = layout.size;
    shared.tables = take(layout.size);
    MUST(fixpair_fft_tables_init_f64(shared.tables, shared.tables_len, SIDE));
    fill_rows(shared.k, shared.power, shared.transfer);
    MUST(fixpair_binning_init(&shared.binning, edges, EDGES));
    MUST(fixpair_closed_triangle_count(&shared.triangles_len, edges, EDGES, NULL));
    if (shared.triangles_len > TRIANGLES) {
        printf("too many triangles\n");
        exit(2);
    }
    MUST(fixpair_closed_triangles(shared.triangles, shared.triangles_len, edges, EDGES, NULL));
}

static fixpair_conditions conditions_of(uint64_t seed) {
    fixpair_conditions conditions;
    MUST(fixpair_conditions_init(&conditions, seed));
    conditions.box_size = BOX;
    conditions.f_nl = 100.0;
    conditions.linear.source = FIXPAIR_LINEAR_POWER;
    conditions.linear.normalisation = FIXPAIR_NORMALISE_AS_GIVEN;
    conditions.linear.k = shared.k;
    conditions.linear.value = shared.power;
    conditions.linear.rows = ROWS;
    return conditions;
}

static size_t larger(size_t size, const fixpair_layout *layout) {
    return layout->size > size ? layout->size : size;
}

static void make_fft(universe *u) {
    MUST(fixpair_fft_init_f64(&u->fft, shared.tables, shared.tables_len, 0, u->workspace, u->workspace_len, u->exec));
}

/* All memory is taken and given back by the main thread, whose counts of checks are its own. */
static void open_universe(universe *u) {
    fixpair_conditions conditions = conditions_of(0);
    fixpair_layout layout;
    size_t bins, values;
    memset(u, 0, sizeof *u);
    MUST(fixpair_fft_scratch_f64(&layout, SIDE));
    u->workspace_len = layout.size;
    u->workspace = take_scratch(layout.size);
    make_fft(u);
    MUST(fixpair_initial_conditions_scratch_f64(&layout, &conditions, &u->fft, NULL));
    u->scratch_len = layout.size;
    MUST(fixpair_deposit_scratch_f64(&layout, &u->fft.configuration, PARTICLES, FIXPAIR_WINDOW_CIC));
    u->scratch_len = larger(u->scratch_len, &layout);
    MUST(fixpair_power_sums_scratch(&layout, &u->fft.fourier, &shared.binning, 1));
    u->scratch_len = larger(u->scratch_len, &layout);
    MUST(fixpair_bispectrum_scratch_f64(&layout, &u->fft, EDGES - 1, shared.triangles_len));
    u->scratch_len = larger(u->scratch_len, &layout);
    MUST(fixpair_fof_labels_scratch_f64(&layout, PARTICLES));
    u->scratch_len = larger(u->scratch_len, &layout);
    u->scratch = take_scratch(u->scratch_len);
    MUST(fixpair_bispectrum_meshes_f64(&u->fields_len, &u->fft, 3));
    MUST(fixpair_binning_lengths(&bins, &values, &u->words, &shared.binning, 1));
    u->mesh = (double *)take(u->fft.length * sizeof(double));
    u->fields = (double *)take(u->fields_len * sizeof(double));
    u->particles = (double *)take(6 * PARTICLES * sizeof(double));
    u->sums = (int64_t *)take((u->words + shared.triangles_len * FIXPAIR_BISPECTRUM_WORDS) * sizeof(int64_t));
    u->labels = (uint64_t *)take(PARTICLES * sizeof(uint64_t));
}

static void close_universe(universe *u) {
    give_back(u->workspace);
    give_back(u->scratch);
    give_back(u->mesh);
    give_back(u->fields);
    give_back(u->particles);
    give_back(u->sums);
    give_back(u->labels);
}

static fixpair_components_f64 triples(double *start) {
    fixpair_components_f64 view;
    view.x = start;
    view.y = start + 1;
    view.z = start + 2;
    view.stride = 3;
    view.length = PARTICLES;
    return view;
}

/* The power spectrum of particles, into sums that are zeros before. */
static void measure(universe *u, const double *particles) {
    static const size_t pair[] = {0, 0};
    static const int32_t none[] = {FIXPAIR_COMPENSATION_NONE};
    const double *field = u->mesh;
    fixpair_positions_f64 where;
    where.x = particles;
    where.y = particles + 1;
    where.z = particles + 2;
    where.stride = 3;
    where.length = PARTICLES;
    memset(u->mesh, 0, u->fft.length * sizeof(double));
    memset(u->sums, 0, u->words * sizeof(int64_t));
    MUST(fixpair_deposit_f64(u->mesh, u->fft.length, &u->fft.configuration, &where, NULL, 0, BOX, FIXPAIR_WINDOW_CIC, 0.0,
                             u->scratch, u->scratch_len, u->exec));
    if (u->fft.forward(u->fft.context, u->mesh) != 0) {
        exit(2);
    }
    MUST(fixpair_power_sums_f64(u->sums, u->words, &field, 1, u->fft.length, pair, 1, none, &u->fft.fourier,
                                &shared.binning, u->scratch, u->scratch_len, u->exec));
    MUST(fixpair_fof_labels_f64(u->labels, PARTICLES, &where, NULL, 0, BOX, 0.5 * BOX / SIDE, u->scratch, u->scratch_len,
                                u->exec));
}

static void *run_universe(void *argument) {
    universe *u = (universe *)argument;
    fixpair_conditions conditions = conditions_of(u->seed);
    fixpair_components_f64 x = triples(u->particles), v = triples(u->particles + 3 * PARTICLES);
    int64_t *bispectrum = u->sums + u->words;
    size_t words = shared.triangles_len * FIXPAIR_BISPECTRUM_WORDS, transforms;
    make_fft(u);
    MUST(fixpair_initial_conditions_f64(&x, &v, &conditions, &u->fft, NULL, u->scratch, u->scratch_len, u->exec));
    measure(u, u->particles);
    memset(bispectrum, 0, words * sizeof *bispectrum);
    MUST(fixpair_bispectrum_f64(bispectrum, words, &transforms, shared.triangles, shared.triangles_len, edges, EDGES, u->mesh,
                                u->fft.length, &u->fft, u->fields, u->fields_len, u->scratch, u->scratch_len, u->exec));
    u->hash = hash_bytes(HASH_START, u->particles, 6 * PARTICLES * sizeof(double));
    u->hash = hash_bytes(u->hash, u->sums, (u->words + words) * sizeof *u->sums);
    u->hash = hash_bytes(u->hash, u->labels, PARTICLES * sizeof *u->labels);
    return NULL;
}

static universe universes[CALLERS];
static uint64_t alone[CALLERS];

static void at_once(void *(*run)(void *), void *const *arguments) {
    pthread_t thread[CALLERS];
    int i;
    for (i = 0; i < CALLERS; i++) {
        if (pthread_create(&thread[i], NULL, run, arguments[i]) != 0) {
            printf("no thread\n");
            exit(2);
        }
    }
    for (i = 0; i < CALLERS; i++) {
        CHECK(pthread_join(thread[i], NULL) == 0);
    }
}

/* `execs`: one for each caller. */
static void universes_at_once(const fixpair_exec *const *execs) {
    void *arguments[CALLERS];
    int i;
    for (i = 0; i < CALLERS; i++) {
        universes[i].exec = execs[i];
        universes[i].seed = (uint64_t)i + 1;
        universes[i].hash = 0;
        arguments[i] = &universes[i];
    }
    at_once(run_universe, arguments);
    for (i = 0; i < CALLERS; i++) {
        CHECK(universes[i].hash == alone[i]);
    }
}

static void run_chunk(void *argument, size_t index) {
    (void)argument;
    run_universe(&universes[index]);
}

/* A host that runs its own loop on the pool, whose chunks call kernels that loop on the same pool. */
static void universes_in_chunks(const fixpair_exec *pool) {
    int i;
    for (i = 0; i < CALLERS; i++) {
        universes[i].exec = pool;
        universes[i].hash = 0;
    }
    CHECK(pool->parallel_for(pool->context, CALLERS, run_chunk, NULL) == 0);
    for (i = 0; i < CALLERS; i++) {
        CHECK(universes[i].hash == alone[i]);
    }
}

/* Pools of 1 to 5 threads that live for one loop. */
static void *come_and_go(void *argument) {
    size_t *wrong = (size_t *)argument, rounds = *wrong, round;
    *wrong = 0;
    for (round = 0; round < rounds; round++) {
        fixpair_threads *threads;
        fixpair_exec pool, told;
        MUST(fixpair_threads_create(&threads, &pool, 1 + round % 5));
        told = followed(&pool);
        *wrong += round % 2 == 0 && fixpair_exec_self_test(&told) != FIXPAIR_OK;
        fixpair_threads_destroy(threads);
    }
    return NULL;
}

static void pools_come_and_go(size_t rounds) {
    size_t wrong[CALLERS];
    void *arguments[CALLERS];
    int i;
    for (i = 0; i < CALLERS; i++) {
        wrong[i] = rounds;
        arguments[i] = &wrong[i];
    }
    at_once(come_and_go, arguments);
    for (i = 0; i < CALLERS; i++) {
        CHECK(wrong[i] == 0);
    }
}

typedef struct {
    universe *own;
    const double *particles;
    uint64_t hash;
} watcher;

static int32_t watch(void *context, const fixpair_progress *progress) {
    watcher *w = (watcher *)context;
    (void)progress;
    if (w->own != NULL) {
        measure(w->own, w->particles);
        w->hash = hash_bytes(w->hash, w->own->sums, w->own->words * sizeof(int64_t));
        w->hash = hash_bytes(w->hash, w->own->labels, PARTICLES * sizeof(uint64_t));
    }
    return 0;
}

/* A run whose observer measures the particles, with the run's transform and threads where `exec` is one; returns the particles' hash. */
static uint64_t watched_run(const fixpair_exec *exec, universe *own, uint64_t *seen) {
    universe *u = &universes[0];
    const double steps[STEPS] = {0.1, 0.2, 0.3};
    fixpair_components_f64 x = triples(u->particles), v = triples(u->particles + 3 * PARTICLES);
    fixpair_epoch epoch = {0.1, 0.1};
    fixpair_observer observer;
    fixpair_gravity gravity;
    fixpair_layout layout;
    watcher w;
    double *mesh[3];
    void *scratch;
    size_t i;
    u->exec = exec;
    run_universe(u);
    MUST(fixpair_gravity_init(&gravity));
    gravity.box_size = BOX;
    MUST(fixpair_evolve_scratch_f64(&layout, &u->fft, PARTICLES, gravity.window));
    scratch = take_scratch(layout.size);
    for (i = 0; i < 3; i++) {
        mesh[i] = (double *)take(u->fft.length * sizeof(double));
    }
    w.own = own;
    w.particles = u->particles;
    w.hash = HASH_START;
    if (own != NULL) {
        own->exec = exec;
        own->fft = u->fft;
    }
    observer.context = &w;
    observer.observe = watch;
    MUST(fixpair_evolve_f64(&x, &v, &epoch, &gravity, NULL, steps, STEPS, NULL, mesh[0], mesh[1], mesh[2], u->fft.length,
                            &u->fft, scratch, layout.size, &observer, exec));
    for (i = 0; i < 3; i++) {
        give_back(mesh[i]);
    }
    give_back(scratch);
    *seen = w.hash;
    return hash_bytes(HASH_START, u->particles, 6 * PARTICLES * sizeof(double));
}

int main(int count, char **arguments) {
    size_t rounds = count > 1 ? strtoul(arguments[1], NULL, 10) : 4, loops[CALLERS], round;
    fixpair_exec pool, told, hosts[CALLERS];
    const fixpair_exec *execs[CALLERS];
    fixpair_threads *threads;
    uint64_t run, seen, run_alone, seen_alone, nothing;
    int i;
    make_shared();
    for (i = 0; i < CALLERS; i++) {
        open_universe(&universes[i]);
        universes[i].seed = (uint64_t)i + 1;
        run_universe(&universes[i]);
        alone[i] = universes[i].hash;
        CHECK(i == 0 || alone[i] != alone[i - 1]);
    }
    MUST(fixpair_threads_create(&threads, &pool, POOL));
    told = followed(&pool);
    for (round = 0; round < rounds; round++) {
        for (i = 0; i < CALLERS; i++) {
            execs[i] = NULL;
        }
        universes_at_once(execs);
        for (i = 0; i < CALLERS; i++) {
            execs[i] = &told;
        }
        universes_at_once(execs);
        for (i = 0; i < CALLERS; i++) {
            loops[i] = 0;
            hosts[i].context = &loops[i];
            hosts[i].parallel_for = posix_for;
            execs[i] = &hosts[i];
        }
        universes_at_once(execs);
        universes_in_chunks(&told);
        pools_come_and_go(10);
    }
    run_alone = watched_run(NULL, &universes[1], &seen_alone);
    run = watched_run(&told, &universes[1], &seen);
    CHECK(run == run_alone && seen == seen_alone);
    CHECK(watched_run(&told, NULL, &nothing) == run_alone);
    fixpair_threads_destroy(threads);
    for (i = 0; i < CALLERS; i++) {
        close_universe(&universes[i]);
    }
    give_back(shared.tables);
    return check_report("concurrent");
}
