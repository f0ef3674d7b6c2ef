/*
 * A Fixed pair of initial conditions, 16^3 particles in a box of 500 Mpc/h, by a program that knows nothing of fixpair but what was installed.
 * Exits with 0 if what must hold of them holds. Compiles where FIXPAIR_NO_THREADS and FIXPAIR_NO_LINALG are defined too.
 */

#define _POSIX_C_SOURCE 200112L

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <fixpair.h>

enum { SIDE = 16, PARTICLES = SIDE * SIDE * SIDE };
#define BOX 500.0

static double position[2][3 * PARTICLES], velocity[2][3 * PARTICLES];

static void check(fixpair_status_t status) {
    if (status == FIXPAIR_OK) return;
    fprintf(stderr, "fixpair: %s\n", fixpair_status_message(status));
    exit(EXIT_FAILURE);
}

static void *take(fixpair_layout layout) {
    void *memory = NULL;
    if (posix_memalign(&memory, layout.align, layout.size) != 0) exit(EXIT_FAILURE);
    return memory;
}

/* The built-in transform; what it stands on lives as long as the program. */
static fixpair_fft_f64 transform(const fixpair_exec *exec) {
    fixpair_fft_f64 fft;
    fixpair_layout tables, scratch;
    check(fixpair_fft_tables_scratch_f64(&tables, SIDE));
    check(fixpair_fft_scratch_f64(&scratch, SIDE));
    void *built = take(tables);
    check(fixpair_fft_tables_init_f64(built, tables.size, SIDE));
    check(fixpair_fft_init_f64(&fft, built, tables.size, 0, take(scratch), scratch.size, exec));
    return fft;
}

static void make(int32_t phase, double *x, double *v, const fixpair_fft_f64 *fft, const fixpair_exec *exec) {
    fixpair_components_f64 positions = {x, x + 1, x + 2, 3, PARTICLES}, velocities = {v, v + 1, v + 2, 3, PARTICLES};
    fixpair_conditions conditions;
    fixpair_layout layout;
    check(fixpair_conditions_init(&conditions, 42));
    conditions.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    conditions.realisation.phase = phase;
    conditions.order = FIXPAIR_ORDER_FIRST;
    conditions.box_size = BOX;
    check(fixpair_initial_conditions_scratch_f64(&layout, &conditions, fft, NULL));
    void *scratch = take(layout);
    check(fixpair_initial_conditions_f64(&positions, &velocities, &conditions, fft, NULL, scratch, layout.size, exec));
    free(scratch);
}

int main(void) {
    size_t outside = 0, unequal = 0;
    double fastest = 0.0;
    const fixpair_exec *exec = NULL;
#ifndef FIXPAIR_NO_THREADS
    fixpair_exec pool;
    fixpair_threads *threads;
    check(fixpair_threads_create(&threads, &pool, 2));
    exec = &pool;
#endif
    fixpair_fft_f64 fft = transform(exec);
    make(FIXPAIR_PHASE_ORIGINAL, position[0], velocity[0], &fft, exec);
    make(FIXPAIR_PHASE_INVERTED, position[1], velocity[1], &fft, exec);
#ifndef FIXPAIR_NO_THREADS
    fixpair_threads_destroy(threads);
#endif
    for (size_t i = 0; i < 3 * PARTICLES; i++) {
        outside += !(position[0][i] >= 0.0 && position[0][i] < BOX && position[1][i] >= 0.0 && position[1][i] < BOX);
        unequal += velocity[0][i] != -velocity[1][i];
        fastest = fmax(fastest, fabs(velocity[0][i]));
    }
#ifndef FIXPAIR_NO_LINALG
    /* The Cholesky factor of a 2 x 2 covariance: sqrt(4), 2/2, sqrt(2 - 1). */
    const double covariance[4] = {4.0, 2.0, 2.0, 2.0};
    double root[4];
    fixpair_layout layout;
    check(fixpair_covariance_root_scratch(&layout, 2));
    check(fixpair_covariance_root(root, covariance, 2, take(layout), layout.size));
    unequal += fabs(root[0] - 2.0) + fabs(root[2] - 1.0) + fabs(root[3] - 1.0) > 1e-14;
#endif
    printf("fixpair %s: %d + %d particles, up to %.0f km/s\n", fixpair_version(), PARTICLES, PARTICLES, fastest);
    if (outside > 0 || unequal > 0 || !(fastest > 1.0)) {
        fprintf(stderr, "%lu coordinates outside the box, %lu velocities not opposite\n", (unsigned long)outside, (unsigned long)unequal);
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
