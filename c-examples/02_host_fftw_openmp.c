/*
 * The host brings its own: FFTW as the transform, OpenMP as the loop. A simulation code that has both links nothing new for fixpair.
 *
 *     02_host_fftw_openmp [n [seed]]
 *
 * Makes one universe (fixed, f_NL = 100, second order) with the built-in transform and threads and again with the host's, and
 * compares: the random modes are the same bits; positions differ by the roundings of two different transforms. Exits with 0 only if so.
 */

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "fixpair.h"
#include "memory.h"
#include "transform.h"

/* The built-in pool; OpenMP has its own number, which need not be the same. */
enum { THREADS = 2 };

/* ---- The executor: the whole hook. Iterations may cost differently, so they are dealt out as they end. */

static int32_t openmp_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    (void)context;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < count; i++) body(argument, i);
    return 0;
}

static const struct fixpair_exec openmp = {NULL, openmp_for};

/* ---- The transform: a context that holds the plans, two functions that run them, and the layout of FFTW's r2c in place. */

struct fftw {
    struct fixpair_fft_f64 hook;
    fftw_plan forward;
    fftw_plan inverse;
};

/* A plan runs on other arrays than its own by FFTW's "new-array" functions; they are aligned alike, see fftw_open. */
static int32_t fftw_forward(void *context, double *data) {
    const struct fftw *fftw = context;
    fftw_execute_dft_r2c(fftw->forward, data, (fftw_complex *)data);
    return 0;
}

static int32_t fftw_inverse(void *context, double *data) {
    const struct fftw *fftw = context;
    fftw_execute_dft_c2r(fftw->inverse, (fftw_complex *)data, data);
    return 0;
}

/* The hook points to *fftw, which therefore must not move. fftw_close gives back what this took, whether it succeeds or not. */
static int fftw_open(struct fftw *fftw, size_t n) {
    struct fixpair_fft_f64 *hook = &fftw->hook;
    int side = (int)n;
    size_t reals;
    memset(fftw, 0, sizeof *fftw);
    hook->struct_size = sizeof *hook;
    hook->context = fftw;
    hook->forward = fftw_forward;
    hook->inverse = fftw_inverse;
    /* No sum: this process holds the whole mesh. No padding of planes: rows of n + 2 reals is what FFTW takes for granted. */
    TRY(fixpair_brick_whole(&hook->configuration, n, FIXPAIR_SPACE_CONFIGURATION, 0));
    TRY(fixpair_brick_whole(&hook->fourier, n, FIXPAIR_SPACE_FOURIER, 0));
    TRY(fixpair_brick_reals(&reals, &hook->configuration));
    TRY(fixpair_brick_reals(&hook->length, &hook->fourier));
    if (hook->length < reals) hook->length = reals;

    /* Planning may write to the array. It is aligned to 64 bytes, as are the meshes in scratch that the library transforms; a host
       that passes less aligned meshes to single stages adds FFTW_UNALIGNED. */
    double *data = memory_take_doubles(hook->length);
    if (data == NULL) return 1;
    fftw->forward = fftw_plan_dft_r2c_3d(side, side, side, data, (fftw_complex *)data, FFTW_ESTIMATE);
    fftw->inverse = fftw_plan_dft_c2r_3d(side, side, side, (fftw_complex *)data, data, FFTW_ESTIMATE);
    free(data);
    if (fftw->forward == NULL || fftw->inverse == NULL) {
        fprintf(stderr, "FFTW has no plan for side %d\n", side);
        return 1;
    }
    return 0;
}

static void fftw_close(struct fftw *fftw) {
    if (fftw->forward != NULL) fftw_destroy_plan(fftw->forward);
    if (fftw->inverse != NULL) fftw_destroy_plan(fftw->inverse);
}

/* ---- The same universe by two ways. */

struct particles {
    size_t count;
    double *position;
    double *velocity;
    double *white; /* the unit modes that they come from */
};

static int particles_open(struct particles *particles, size_t n, size_t modes) {
    particles->count = n * n * n;
    particles->position = memory_take_doubles(3 * particles->count);
    particles->velocity = memory_take_doubles(3 * particles->count);
    particles->white = memory_take_doubles(modes);
    return particles->position == NULL || particles->velocity == NULL || particles->white == NULL;
}

static void particles_close(struct particles *particles) {
    free(particles->position);
    free(particles->velocity);
    free(particles->white);
}

/* From here on nothing knows whose transform and whose threads they are. */
static int make(struct particles *particles, const struct fixpair_conditions *conditions, const struct fixpair_fft_f64 *fft,
                const struct fixpair_fft_f64 *fine, const struct fixpair_exec *exec) {
    double *x = particles->position, *v = particles->velocity;
    struct fixpair_components_f64 position = {x, x + 1, x + 2, 3, particles->count};
    struct fixpair_components_f64 velocity = {v, v + 1, v + 2, 3, particles->count};
    struct fixpair_layout layout;
    /* Without padding of planes, so that the two ways can be compared byte by byte. */
    struct fixpair_brick brick;
    size_t reals;
    TRY(fixpair_brick_whole(&brick, fft->fourier.n, FIXPAIR_SPACE_FOURIER, 0));
    TRY(fixpair_brick_reals(&reals, &brick));
    TRY(fixpair_white_modes_f64(particles->white, reals, &brick, &conditions->realisation, NULL, 0, exec));

    TRY(fixpair_initial_conditions_scratch_f64(&layout, conditions, fft, fine));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    double start = omp_get_wtime();
    fixpair_status_t status = fixpair_initial_conditions_f64(&position, &velocity, conditions, fft, fine, scratch, layout.size, exec);
    printf("    particles in %.3f s\n", omp_get_wtime() - start);
    free(scratch);
    TRY(status);
    return 0;
}

/* Both hooks keep their contract, as the library sees it. */
static int self_test(const struct fftw *fftw, const char *what, int *failures) {
    double *data = memory_take_doubles(fftw->hook.length);
    if (data == NULL) return 1;
    fixpair_status_t status = fixpair_fft_self_test_f64(&fftw->hook, data, fftw->hook.length);
    free(data);
    *failures += claim(status == FIXPAIR_OK, "FFTW keeps the contract of the transform, %s side %lu", what,
                       (unsigned long)fftw->hook.fourier.n);
    return 0;
}

static int compare(const struct particles *builtin, const struct particles *host, size_t n, size_t modes, double box_size) {
    int failures = 0;
    double cell = box_size / (double)n, apart = 0.0, faster = 0.0, fastest = 0.0;
    for (size_t i = 0; i < 3 * builtin->count; i++) {
        double difference = fabs(builtin->position[i] - host->position[i]);
        apart = fmax(apart, fmin(difference, box_size - difference));
        faster = fmax(faster, fabs(builtin->velocity[i] - host->velocity[i]));
        fastest = fmax(fastest, fabs(builtin->velocity[i]));
    }
    failures += claim(memcmp(builtin->white, host->white, modes * sizeof(double)) == 0,
                      "the random modes are the same bits, on the built-in threads and on OpenMP's");
    /* Displacements are below a cell, transforms err by a few 1e-16 of their r.m.s., positions below L are rounded to 1e-16 L = n
       1e-16 cells: below 1e-12 for any n up to 1000. */
    failures += claim(apart < 1e-12 * cell, "positions differ by %.1e of a cell at most", apart / cell);
    failures += claim(faster < 1e-12 * fastest, "velocities differ by %.1e of the largest at most", faster / fastest);
    return failures;
}

struct example {
    size_t n;
    uint64_t seed;
    fixpair_threads *threads;
    struct fixpair_exec pool;
    struct transform fft, fine;
    struct fftw host_fft, host_fine;
    struct particles builtin, host;
};

static int run(struct example *example, int *failures) {
    struct fixpair_conditions conditions;
    size_t n = example->n, modes = n * n * (n + 2);
    TRY(fixpair_conditions_init(&conditions, example->seed));
    conditions.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    conditions.f_nl = 100.0;

    TRY(particles_open(&example->builtin, n, modes));
    TRY(particles_open(&example->host, n, modes));
    TRY(fixpair_threads_create(&example->threads, &example->pool, THREADS));
    TRY(transform_open(&example->fft, n, &example->pool));
    TRY(transform_open(&example->fine, fixpair_fft_next_side(3 * n / 2), &example->pool));
    TRY(fftw_open(&example->host_fft, n));
    TRY(fftw_open(&example->host_fine, example->fine.hook.fourier.n));

    *failures += claim(fixpair_exec_self_test(&openmp) == FIXPAIR_OK, "OpenMP keeps the contract of the loop, on %d threads",
                       omp_get_max_threads());
    TRY(self_test(&example->host_fft, "modes of", failures));
    TRY(self_test(&example->host_fine, "products on", failures));

    printf("\n    built-in transform on %d built-in threads\n", (int)THREADS);
    TRY(make(&example->builtin, &conditions, &example->fft.hook, &example->fine.hook, &example->pool));
    printf("    FFTW (one thread), everything else on OpenMP's %d threads\n", omp_get_max_threads());
    TRY(make(&example->host, &conditions, &example->host_fft.hook, &example->host_fine.hook, &openmp));
    printf("\n");
    *failures += compare(&example->builtin, &example->host, n, modes, conditions.box_size);
    return 0;
}

int main(int argc, char **argv) {
    struct example example;
    int failures = 0;
    char *end = "";
    memset(&example, 0, sizeof example);
    example.n = argc > 1 ? (size_t)strtoul(argv[1], &end, 10) : 64;
    if (*end == '\0') example.seed = argc > 2 ? strtoull(argv[2], &end, 10) : 1;
    if (*end != '\0' || argc > 3 || example.n < 8 || example.n > 1000) {
        fprintf(stderr, "usage: %s [n, 8 to 1000 [seed]]\n", argv[0]);
        return EXIT_FAILURE;
    }
    int broken = run(&example, &failures);
    particles_close(&example.builtin);
    particles_close(&example.host);
    transform_close(&example.fft);
    transform_close(&example.fine);
    fftw_close(&example.host_fft);
    fftw_close(&example.host_fine);
    fftw_cleanup();
    fixpair_threads_destroy(example.threads);
    return broken || failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
