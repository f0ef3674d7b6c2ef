/*
 * Every function with good input: the bits are those of the Rust interface, on one, two and five threads of the built-in pool and on
 * threads of the host's.
 *
 * conformance FILE [WHO]: the cases of ffi-tests/vectors.rs; on whose threads, by default 01234: the caller's, pools of 1, 2 and 5, the host's
 */
#define _POSIX_C_SOURCE 200112L

#include <math.h>

#include "handovers.h"
#include "hosts.h"

/* NULL, the pool with 1, 2 and 5 threads, the host's own loop. */
enum { EXECUTORS = 5, POOLS = 3 };

/* "white_modes", "slab", ".f64" */
static void check_named(const char *name, const char *kind, const char *suffix, uint64_t hash) {
    char full[64];
    snprintf(full, sizeof full, "%s%s%s", name, kind, suffix);
    check_case(full, hash);
}

enum { BRICKS = 5 };
static const char *const brick_names[BRICKS] = {"whole", "padded", "slab", "transposed", "general"};

/* The bricks of Fourier space of ffi-tests/vectors.rs. */
static void make_bricks(fixpair_brick *bricks) {
    fixpair_brick general = {N, FIXPAIR_SPACE_FOURIER, {0, 0, 0}, {N, N, N / 2 + 1}, {1, N + 1, N * (N + 1) + 2}};
    MUST(fixpair_brick_whole(&bricks[0], N, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_whole(&bricks[1], N, FIXPAIR_SPACE_FOURIER, PADDING));
    MUST(fixpair_brick_slab(&bricks[2], N, FIXPAIR_SPACE_FOURIER, 3, 5));
    MUST(fixpair_brick_transposed_slab(&bricks[3], N, 2, 7));
    bricks[4] = general;
}

/* Is memory that was all CANARY_BYTE before still so between the elements of the brick? Spoils the elements. */
static int gaps_untouched(void *data, size_t bytes, const fixpair_brick *brick, size_t size) {
    const size_t *s = brick->stride;
    const unsigned char *all = (const unsigned char *)data;
    size_t a, b, c;
    size *= brick->space == FIXPAIR_SPACE_FOURIER ? 2 : 1;
    for (a = 0; a < brick->count[0]; a++) {
        for (b = 0; b < brick->count[1]; b++) {
            for (c = 0; c < brick->count[2]; c++) {
                memset((char *)data + (a * s[0] + b * s[1] + c * s[2]) * size, CANARY_BYTE, size);
            }
        }
    }
    for (a = 0; a < bytes; a++) {
        if (all[a] != CANARY_BYTE) {
            return 0;
        }
    }
    return 1;
}

static double *amplitude_table, *alpha_table;
static size_t table_length;

static void scalars(const fixpair_exec *exec) {
    fixpair_brick bricks[BRICKS], slab;
    fixpair_realisation realisation;
    uint64_t numbers[400], hash = HASH_START;
    uint64_t *ids = (uint64_t *)take(5 * N * N * sizeof *ids);
    const uint32_t counter[4] = {1, 2, 3, 4}, key[2] = {5, 6};
    uint32_t block[4], seeds[N * N];
    double uniforms[40];
    size_t reals;
    int i, axis;
    for (i = 0; i >= FIXPAIR_ERROR_SINGULAR; i--) {
        const char *message = fixpair_status_message(i);
        hash = hash_bytes(hash, message, strlen(message));
    }
    check_case("status_message", hash);
    CHECK(strstr(fixpair_status_message(1), "unknown") != NULL);
    CHECK(strstr(fixpair_status_message(FIXPAIR_ERROR_SINGULAR - 1), "unknown") != NULL);
    CHECK(strstr(fixpair_status_message(INT32_MIN), "unknown") != NULL);
    check_case("version", hash_bytes(HASH_START, fixpair_version(), strlen(fixpair_version())));
    MUST(fixpair_philox4x32_10(block, counter, key));
    check_case("philox4x32_10", hash_bytes(HASH_START, block, sizeof block));
    MUST(fixpair_ranlxd1(uniforms, 40, SEED));
    check_case("ranlxd1", hash_bytes(HASH_START, uniforms, sizeof uniforms));
    make_bricks(bricks);
    for (i = 0; i < BRICKS; i++) {
        size_t columns = bricks[i].count[0] * bricks[i].count[1];
        MUST(fixpair_ngenic_seeds(seeds, columns, &bricks[i], SEED));
        check_named("ngenic_seeds.", brick_names[i], "", hash_bytes(HASH_START, seeds, columns * sizeof *seeds));
    }
    MUST(fixpair_realisation_init(&realisation, SEED));
    CHECK(realisation.struct_size == sizeof realisation);
    numbers[0] = realisation.seed;
    numbers[1] = (uint64_t)realisation.scheme;
    numbers[2] = (uint64_t)realisation.amplitude;
    numbers[3] = (uint64_t)realisation.phase;
    numbers[4] = (uint64_t)realisation.nyquist;
    numbers[5] = (uint64_t)realisation.selection;
    numbers[6] = realisation.sample;
    check_case("realisation_init", hash_bytes(HASH_START, numbers, 7 * sizeof *numbers));
    for (i = 0; i < BRICKS; i++) {
        const fixpair_brick *brick = &bricks[i];
        MUST(fixpair_brick_reals(&reals, brick));
        numbers[0] = brick->n;
        numbers[1] = (uint64_t)brick->space;
        for (axis = 0; axis < 3; axis++) {
            numbers[2 + axis] = brick->start[axis];
            numbers[5 + axis] = brick->count[axis];
            numbers[8 + axis] = brick->stride[axis];
        }
        numbers[11] = reals;
        check_named("brick.", brick_names[i], "", hash_bytes(HASH_START, numbers, 12 * sizeof *numbers));
    }
    for (i = 0; i < 400; i++) {
        numbers[i] = fixpair_fft_next_side((size_t)i);
    }
    check_case("fft_next_side", hash_bytes(HASH_START, numbers, sizeof numbers));
    CHECK(fixpair_fft_next_side(SIZE_MAX) == 0);
    MUST(fixpair_brick_slab(&slab, N, FIXPAIR_SPACE_CONFIGURATION, 3, 5));
    MUST(fixpair_particle_ids(ids, 5 * N * N, &slab, 1, exec));
    check_case("particle_ids", hash_bytes(HASH_START, ids, 5 * N * N * sizeof *ids));
    give_back(ids);
}

/* One spectrum at everything that asks for one. */
static void spectrum(int number, const fixpair_cosmology *cosmology, const fixpair_linear *linear) {
    enum { WAVES = 30 };
    double k[WAVES], values[4 * WAVES + 1];
    char name[16];
    int i;
    for (i = 0; i < WAVES; i++) {
        k[i] = 0.0004 * (double)(i * i + 1);
    }
    MUST(fixpair_linear_power(values, k, WAVES, cosmology, linear, 1.0));
    MUST(fixpair_linear_transfer(values + WAVES, k, WAVES, cosmology, linear));
    MUST(fixpair_linear_sigma(values + 2 * WAVES, 5.0, cosmology, linear));
    MUST(fixpair_alpha(values + 2 * WAVES + 1, k, WAVES, cosmology, linear, 32.0, FIXPAIR_CONVENTION_CMB));
    MUST(fixpair_alpha(values + 3 * WAVES + 1, k, WAVES, cosmology, linear, 32.0, FIXPAIR_CONVENTION_LSS));
    snprintf(name, sizeof name, "linear.%d", number);
    check_case(name, hash_bytes(HASH_START, values, sizeof values));
}

static void cosmologies(void) {
    static const struct {
        int32_t source, normalisation;
        double amount;
    } kinds[] = {
        {FIXPAIR_LINEAR_POWER, FIXPAIR_NORMALISE_AS_GIVEN, 0.0},
        {FIXPAIR_LINEAR_POWER, FIXPAIR_NORMALISE_SIGMA8, 0.8},
        {FIXPAIR_LINEAR_POWER, FIXPAIR_NORMALISE_AMPLITUDE, 1e6},
        {FIXPAIR_LINEAR_TRANSFER, FIXPAIR_NORMALISE_SIGMA8, 0.8},
        {FIXPAIR_LINEAR_TRANSFER, FIXPAIR_NORMALISE_AMPLITUDE, 1e6},
        {FIXPAIR_LINEAR_TRANSFER, FIXPAIR_NORMALISE_A_S, 2e-9},
        {FIXPAIR_LINEAR_EISENSTEIN_HU, FIXPAIR_NORMALISE_SIGMA8, 0.8},
        {FIXPAIR_LINEAR_EISENSTEIN_HU_SMOOTH, FIXPAIR_NORMALISE_A_S, 2e-9},
    };
    fixpair_cosmology c, full;
    double a[20], e[20], k[ROWS], power[ROWS], transfer[ROWS], one;
    fixpair_growth growth[20];
    size_t i;
    MUST(fixpair_cosmology_init(&c));
    CHECK(c.struct_size == sizeof c);
    check_case("cosmology_init", hash_bytes(HASH_START, &c.omega_m, 9 * sizeof(double)));
    full = c;
    full.omega_de = 0.7;
    full.omega_r = 1e-4;
    full.w0 = -0.9;
    full.wa = 0.1;
    for (i = 0; i < 20; i++) {
        a[i] = (double)(i + 1) / 16.0;
    }
    MUST(fixpair_radiation_density(&one, 2.7255, 3.046, 0.7));
    check_case("radiation_density", hash_bytes(HASH_START, &one, sizeof one));
    MUST(fixpair_expansion(e, a, 20, &full));
    check_case("expansion", hash_bytes(HASH_START, e, sizeof e));
    MUST(fixpair_growth_factors(growth, a, 20, &full));
    check_case("growth_factors", hash_bytes(HASH_START, growth, sizeof growth));
    MUST(fixpair_growth_suppression(&one, &full));
    check_case("growth_suppression", hash_bytes(HASH_START, &one, sizeof one));
    fill_rows(k, power, transfer);
    for (i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        fixpair_linear linear;
        int fit = kinds[i].source > FIXPAIR_LINEAR_TRANSFER;
        linear.struct_size = sizeof linear;
        linear.source = kinds[i].source;
        linear.normalisation = kinds[i].normalisation;
        linear.amount = kinds[i].amount;
        linear.rows = fit ? 0 : ROWS;
        linear.k = fit ? NULL : k;
        linear.value = fit ? NULL : kinds[i].source == FIXPAIR_LINEAR_POWER ? power : transfer;
        spectrum((int)i, &c, &linear);
    }
}

static void tables(const fixpair_exec *exec) {
    fixpair_conditions conditions;
    uint64_t length;
    MUST(fixpair_conditions_init(&conditions, SEED));
    CHECK(conditions.struct_size == sizeof conditions);
    MUST(fixpair_mode_table_length(&table_length, N));
    length = table_length;
    check_case("mode_table_length", hash_bytes(HASH_START, &length, sizeof length));
    amplitude_table = (double *)take(table_length * sizeof(double));
    alpha_table = (double *)take(table_length * sizeof(double));
    MUST(fixpair_potential_amplitude_table(amplitude_table, table_length, N, BOX, &conditions.cosmology,
                                           &conditions.linear, FIXPAIR_CONVENTION_CMB, exec));
    check_case("potential_amplitude_table",
               hash_bytes(HASH_START, amplitude_table, table_length * sizeof(double)));
    MUST(fixpair_alpha_table(alpha_table, table_length, N, BOX, &conditions.cosmology, &conditions.linear, 32.0,
                             FIXPAIR_CONVENTION_CMB, exec));
    check_case("alpha_table", hash_bytes(HASH_START, alpha_table, table_length * sizeof(double)));
}

#include "conformance_bins.h"
#include "conformance_species.h"
#include "conformance_steps.h"
#include "conformance_variance.h"

#define REAL float
#define X(name) name##_f32
#define SUFFIX ".f32"
#include "conformance_real.h"
#include "conformance_shape.h"
#include "conformance_initial.h"
#include "conformance_third.h"
#include "conformance_particles.h"
#include "conformance_estimate.h"
#include "conformance_gravity.h"
#include "conformance_run.h"
#include "conformance_halos.h"
#undef REAL
#undef X
#undef SUFFIX

#define REAL double
#define X(name) name##_f64
#define SUFFIX ".f64"
#include "conformance_real.h"
#include "conformance_shape.h"
#include "conformance_initial.h"
#include "conformance_third.h"
#include "conformance_particles.h"
#include "conformance_estimate.h"
#include "conformance_gravity.h"
#include "conformance_run.h"
#include "conformance_halos.h"

int main(int count, char **arguments) {
    static const size_t sizes[POOLS] = {1, 2, 5};
    fixpair_threads *pool[POOLS];
    fixpair_exec pools[POOLS], hooks[POOLS], host;
    const fixpair_exec *executors[EXECUTORS];
    const char *who = count > 2 ? arguments[2] : "01234";
    size_t loops = 0, i;
    if (count < 2) {
        printf("usage: %s FILE [WHO]\n", arguments[0]);
        return 2;
    }
    read_cases(arguments[1]);
    executors[0] = NULL;
    for (i = 0; i < POOLS; i++) {
        MUST(fixpair_threads_create(&pool[i], &pools[i], sizes[i]));
        hooks[i] = followed(&pools[i]);
        executors[1 + i] = &hooks[i];
    }
    host.context = &loops;
    host.parallel_for = posix_for;
    executors[4] = &host;
    cosmologies();
    statistics();
    for (i = 0; i < EXECUTORS; i++) {
        const fixpair_exec *exec = executors[i];
        if (strchr(who, '0' + (int)i) == NULL) {
            continue;
        }
        CHECK(fixpair_exec_self_test(exec) == FIXPAIR_OK);
        scalars(exec);
        tables(exec);
        ghosts();
        bins_and_triangles(exec);
        transforms_f32(exec);
        transforms_f64(exec);
        whites_f32(exec);
        whites_f64(exec);
        stages_f32(exec);
        stages_f64(exec);
        shapes_f32(exec);
        shapes_f64(exec);
        universes_f32(exec);
        universes_f64(exec);
        species_tables(exec);
        beyond_second_order_f32(exec);
        beyond_second_order_f64(exec);
        third_order_f32(exec);
        third_order_f64(exec);
        particles_and_meshes_f32(exec);
        particles_and_meshes_f64(exec);
        estimates_f32(exec);
        estimates_f64(exec);
        steps_in_time();
        numbers_of_halos();
        gravity_f32(exec);
        gravity_f64(exec);
        halos_f32(exec);
        halos_f64(exec);
        give_back(amplitude_table);
        give_back(alpha_table);
    }
    CHECK(loops > 0 || strchr(who, '4') == NULL);
    for (i = 0; i < POOLS; i++) {
        fixpair_threads_destroy(pool[i]);
    }
    fixpair_threads_destroy(NULL);
    return check_report("conformance");
}
