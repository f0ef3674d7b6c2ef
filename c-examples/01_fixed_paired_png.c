/*
 * From a CAMB table to the initial conditions of the GOLIAT suite (Avila & Adame 2022): Normal and Fixed amplitudes, Original and
 * Inverted phases, f_NL = 0 and 100, all matched (one seed), as Gadget-2 files.
 *
 *     01_fixed_paired_png [n [seed [folder [table [kpc|mpc]]]]]
 *
 * n^3 particles in a box of 1000 Mpc/h at z = 32. Prints the power spectrum of each universe's linear density at that redshift
 * beside linear theory, and what must hold among them. Exits with 0 only if it does.
 *
 * The way to initial conditions is make_particles: one call of the library. Everything else here is memory, files and checks.
 */

/* mkdir */
#define _POSIX_C_SOURCE 200112L

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "boltzmann.h"
#include "check.h"
#include "fixpair.h"
#include "gadget.h"
#include "linear.h"
#include "memory.h"
#include "transform.h"

#define BOX 1000.0
#define REDSHIFT 32.0
/* Used where the table has T(k), which knows no amplitude. */
#define SIGMA8 0.8

/* Any number of threads gives the same bits. */
enum { THREADS = 2, UNIVERSES = 8, PATH_LENGTH = 4096 };

struct options {
    size_t n;
    uint64_t seed;
    const char *folder;
    const char *table;
    double unit;
};

struct kind {
    const char *name;
    double f_nl;
    int32_t amplitude;
    int32_t phase;
};

static const struct kind kinds[UNIVERSES] = {
    {"normal_original_fnl0", 0.0, FIXPAIR_AMPLITUDE_NORMAL, FIXPAIR_PHASE_ORIGINAL},
    {"normal_inverted_fnl0", 0.0, FIXPAIR_AMPLITUDE_NORMAL, FIXPAIR_PHASE_INVERTED},
    {"fixed_original_fnl0", 0.0, FIXPAIR_AMPLITUDE_FIXED, FIXPAIR_PHASE_ORIGINAL},
    {"fixed_inverted_fnl0", 0.0, FIXPAIR_AMPLITUDE_FIXED, FIXPAIR_PHASE_INVERTED},
    {"normal_original_fnl100", 100.0, FIXPAIR_AMPLITUDE_NORMAL, FIXPAIR_PHASE_ORIGINAL},
    {"normal_inverted_fnl100", 100.0, FIXPAIR_AMPLITUDE_NORMAL, FIXPAIR_PHASE_INVERTED},
    {"fixed_original_fnl100", 100.0, FIXPAIR_AMPLITUDE_FIXED, FIXPAIR_PHASE_ORIGINAL},
    {"fixed_inverted_fnl100", 100.0, FIXPAIR_AMPLITUDE_FIXED, FIXPAIR_PHASE_INVERTED},
};

/* The first two universes of a pair with f_NL = 0. */
enum { NORMAL = 0, FIXED = 2, FIXED_INVERTED = 3 };

/* Everything that takes memory, once for all universes. */
struct workshop {
    struct options options;
    struct boltzmann_table table;
    fixpair_threads *threads;
    struct fixpair_exec exec;
    struct transform fft;  /* side n: the particles */
    struct transform fine; /* side 3n/2 or more: products without aliasing */
    struct linear linear;
    size_t count;
    double *position, *velocity; /* triples, in Mpc/h and km/s */
    double *pair_position, *pair_velocity;
    uint64_t *id;
    double *modes, *pair_modes; /* linear density */
    double *k, *theory;         /* one value a shell */
    double *power[UNIVERSES];
};

/* What tells one universe from another. */
static int describe(struct fixpair_conditions *conditions, const struct workshop *shop, const struct kind *kind) {
    TRY(fixpair_conditions_init(conditions, shop->options.seed));
    conditions->realisation.amplitude = kind->amplitude;
    conditions->realisation.phase = kind->phase;
    conditions->linear = boltzmann_linear(&shop->table, SIGMA8);
    conditions->redshift = REDSHIFT;
    conditions->box_size = BOX;
    conditions->f_nl = kind->f_nl;
    return 0;
}

/* The one call: asks how much scratch it needs, takes it, and makes the particles. */
static int make_particles(struct workshop *shop, const struct fixpair_conditions *conditions, double *position, double *velocity) {
    struct fixpair_components_f64 x = {position, position + 1, position + 2, 3, shop->count};
    struct fixpair_components_f64 v = {velocity, velocity + 1, velocity + 2, 3, shop->count};
    struct fixpair_layout layout;
    TRY(fixpair_initial_conditions_scratch_f64(&layout, conditions, &shop->fft.hook, &shop->fine.hook));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;

    fixpair_status_t status = fixpair_initial_conditions_f64(&x, &v, conditions, &shop->fft.hook, &shop->fine.hook, scratch,
                                                             layout.size, &shop->exec);
    free(scratch);
    TRY(status);
    return 0;
}

static int check_box(const struct workshop *shop) {
    size_t outside = 0;
    for (size_t i = 0; i < 3 * shop->count; i++) outside += !(shop->position[i] >= 0.0 && shop->position[i] < BOX);
    return outside == 0 ? 0 : claim(0, "%lu coordinates are outside [0, L)", (unsigned long)outside);
}

/* Is `file` the float of x? Across the edge of the box, 0 is L. */
static int is_float_of(float file, double x, double period) {
    double difference = fabs((double)file - x);
    if (period > 0.0 && difference > 0.5 * period) difference = period - difference;
    return difference <= FLT_EPSILON * fabs(x);
}

/* Reads a file back and compares everything in it with the particles in memory. */
static int check_file(const struct workshop *shop, const char *path) {
    struct gadget_file file;
    double box = BOX * shop->options.unit, a = 1.0 / (1.0 + REDSHIFT);
    size_t wrong = 0;
    if (gadget_read(&file, path) != 0 || file.count != shop->count) {
        gadget_close(&file);
        return claim(0, "%s can be read", path);
    }
    wrong += file.header.box_size != box || file.header.time != a || file.header.npart_total[1] != shop->count;
    for (size_t i = 0; i < shop->count; i++) wrong += file.id[i] != shop->id[i];
    for (size_t i = 0; i < 3 * shop->count; i++) {
        wrong += !is_float_of(file.position[i], shop->position[i] * shop->options.unit, box);
        wrong += !is_float_of(file.velocity[i], shop->velocity[i] / sqrt(a), 0.0);
    }
    gadget_close(&file);
    return claim(wrong == 0, "%s, read back, is what was written", path);
}

static int write_file(const struct workshop *shop, const struct fixpair_conditions *conditions, const char *path) {
    struct gadget_universe universe = {BOX, REDSHIFT, 0.0, 0.0, 0.0, shop->options.unit};
    struct gadget_particles particles = {shop->count, shop->position, shop->velocity, shop->id};
    universe.omega_m = conditions->cosmology.omega_m;
    universe.omega_de = conditions->cosmology.omega_de;
    universe.h = conditions->cosmology.h;
    return gadget_write(path, &universe, &particles, shop->count <= UINT32_MAX ? 4 : 8);
}

/* Particles, their file, and the spectrum of one universe. */
static int make_universe(struct workshop *shop, size_t which, int *failures) {
    struct fixpair_conditions conditions;
    char path[PATH_LENGTH];
    TRY(describe(&conditions, shop, &kinds[which]));
    TRY(make_particles(shop, &conditions, shop->position, shop->velocity));
    if (snprintf(path, sizeof path, "%s/%s", shop->options.folder, kinds[which].name) >= (int)sizeof path) {
        return claim(0, "the path of the folder is short enough");
    }
    TRY(write_file(shop, &conditions, path));
    *failures += check_box(shop);
    *failures += check_file(shop, path);

    TRY(linear_density(&shop->linear, &conditions, shop->modes));
    TRY(linear_measure(&shop->linear, BOX, shop->modes, shop->k, shop->power[which]));
    return 0;
}

static void print_spectra(const struct workshop *shop) {
    /* Ten rows or so, evenly in k. */
    size_t step = shop->linear.shells / 10 + 1;
    printf("\nP(k) at z = %g in (Mpc/h)^3; N normal, F fixed, o original, i inverted\n\n", REDSHIFT);
    printf("%8s %9s |%37s |%37s\n", "", "", "f_NL = 0", "f_NL = 100");
    printf("%8s %9s |", "k h/Mpc", "linear");
    for (size_t u = 0; u < UNIVERSES; u++) {
        printf(" %7c%c%s", "NNFF"[u % 4], "oi"[u % 2], u == UNIVERSES / 2 - 1 ? " |" : "");
    }
    printf("\n");
    for (size_t b = 0; b < shop->linear.shells; b += step) {
        printf("%8.4f %9.5f |", shop->k[b], shop->theory[b]);
        for (size_t u = 0; u < UNIVERSES; u++) printf(" %8.5f%s", shop->power[u][b], u == UNIVERSES / 2 - 1 ? " |" : "");
        printf("\n");
    }
    printf("\n");
}

static double worst_ratio(const struct workshop *shop, size_t which) {
    double worst = 0.0;
    for (size_t b = 0; b < shop->linear.shells; b++) {
        worst = fmax(worst, fabs(shop->power[which][b] / shop->theory[b] - 1.0));
    }
    return worst;
}

/* |w| = 1 to a rounding and the table is interpolated once: all that can differ are a few roundings. */
static int check_spectra(const struct workshop *shop) {
    int failures = 0;
    for (size_t u = FIXED; u <= FIXED_INVERTED; u++) {
        double worst = worst_ratio(shop, u);
        failures += claim(worst < 1e-12, "%s has the input power in every shell, to %.1e", kinds[u].name, worst);
    }
    /* The first shell has 26 modes, 13 of them independent: one sigma is 28%. */
    double worst = worst_ratio(shop, NORMAL);
    failures += claim(worst > 0.01, "%s scatters about it, by up to %.0f%%", kinds[NORMAL].name, 100.0 * worst);
    /* f_NL Phi is some 1e-3: in power, f_NL^2 Phi^2 in the mean and 1e-3 of a shell's chance correlations. */
    worst = worst_ratio(shop, UNIVERSES / 2 + FIXED);
    failures += claim(worst > 1e-12 && worst < 1e-2, "f_NL = 100 changes the power of the fixed field by %.1e at most", worst);
    return failures;
}

/* Phase plus pi: every mode of the linear density changes its sign and nothing else. */
static int check_pair_modes(struct workshop *shop, int *failures) {
    struct fixpair_conditions conditions;
    size_t wrong = 0;
    TRY(describe(&conditions, shop, &kinds[FIXED]));
    TRY(linear_density(&shop->linear, &conditions, shop->modes));
    TRY(describe(&conditions, shop, &kinds[FIXED_INVERTED]));
    TRY(linear_density(&shop->linear, &conditions, shop->pair_modes));
    for (size_t i = 0; i < shop->fft.hook.length; i++) wrong += shop->modes[i] != -shop->pair_modes[i];
    *failures += claim(wrong == 0, "fixed: original and inverted density cancel at f_NL = 0, bit for bit");
    return 0;
}

/* Normal times the conjugate of fixed is |normal| |fixed| in every mode: no phase is left. */
static int check_matched_phases(struct workshop *shop, int *failures) {
    struct fixpair_conditions conditions;
    double worst = 0.0;
    TRY(describe(&conditions, shop, &kinds[NORMAL]));
    TRY(linear_density(&shop->linear, &conditions, shop->modes));
    TRY(describe(&conditions, shop, &kinds[FIXED]));
    TRY(linear_density(&shop->linear, &conditions, shop->pair_modes));
    for (size_t i = 0; i < shop->fft.hook.length; i += 2) {
        const double *normal = &shop->modes[i], *fixed = &shop->pair_modes[i];
        double product = hypot(normal[0], normal[1]) * hypot(fixed[0], fixed[1]);
        double real = normal[0] * fixed[0] + normal[1] * fixed[1];
        double imaginary = normal[1] * fixed[0] - normal[0] * fixed[1];
        if (product > 0.0) worst = fmax(worst, hypot(real / product - 1.0, imaginary / product));
    }
    /* A few roundings. */
    *failures += claim(worst < 1e-14, "normal and fixed have the same phases, to %.1e", worst);
    return 0;
}

/* Sum of the pair's displacements over their difference, in the r.m.s. */
static double even_over_odd(const struct workshop *shop) {
    double even = 0.0, odd = 0.0, cell = BOX / (double)shop->options.n;
    size_t n = shop->options.n;
    for (size_t i = 0; i < shop->count; i++) {
        size_t index[3] = {i / (n * n), i / n % n, i % n};
        for (size_t axis = 0; axis < 3; axis++) {
            double first = shop->position[3 * i + axis] - cell * (double)index[axis];
            double second = shop->pair_position[3 * i + axis] - cell * (double)index[axis];
            first -= BOX * floor(first / BOX + 0.5);
            second -= BOX * floor(second / BOX + 0.5);
            even += (first + second) * (first + second);
            odd += (first - second) * (first - second);
        }
    }
    return sqrt(even / odd);
}

/* Particles of a pair: opposite displacements at first order; what is left at second order is second order. */
static int check_pair_particles(struct workshop *shop, int *failures) {
    struct fixpair_conditions original, inverted;
    size_t wrong = 0;
    double left[2];
    TRY(describe(&original, shop, &kinds[FIXED]));
    TRY(describe(&inverted, shop, &kinds[FIXED_INVERTED]));
    for (int32_t order = FIXPAIR_ORDER_FIRST; order <= FIXPAIR_ORDER_SECOND; order++) {
        original.order = inverted.order = order;
        TRY(make_particles(shop, &original, shop->position, shop->velocity));
        TRY(make_particles(shop, &inverted, shop->pair_position, shop->pair_velocity));
        left[order - FIXPAIR_ORDER_FIRST] = even_over_odd(shop);
        if (order == FIXPAIR_ORDER_SECOND) break;
        for (size_t i = 0; i < 3 * shop->count; i++) wrong += shop->velocity[i] != -shop->pair_velocity[i];
    }
    *failures += claim(wrong == 0, "first order: the pair's velocities are opposite, bit for bit");
    /* Positions are rounded to some 1e-13 Mpc/h, displacements are some 0.1 Mpc/h. */
    *failures += claim(left[0] < 1e-11, "first order: the pair's displacements cancel, to %.1e", left[0]);
    *failures += claim(left[1] > 1e-5 && left[1] < 0.1, "second order: %.1e of them is left, the even part", left[1]);
    return 0;
}

static int open_workshop(struct workshop *shop) {
    const struct options *options = &shop->options;
    struct fixpair_conditions conditions;
    size_t n = options->n;
    TRY(boltzmann_read(&shop->table, options->table));
    TRY(fixpair_threads_create(&shop->threads, &shop->exec, THREADS));
    TRY(transform_open(&shop->fft, n, &shop->exec));
    TRY(transform_open(&shop->fine, fixpair_fft_next_side(3 * n / 2), &shop->exec));
    TRY(linear_open(&shop->linear, &shop->fft.hook, &shop->fine.hook, &shop->exec));
    shop->count = n * n * n;

    double **arrays[] = {&shop->position, &shop->velocity, &shop->pair_position, &shop->pair_velocity};
    for (size_t i = 0; i < 4; i++) {
        if ((*arrays[i] = memory_take_doubles(3 * shop->count)) == NULL) return 1;
    }
    if ((shop->modes = memory_take_doubles(shop->fft.hook.length)) == NULL) return 1;
    if ((shop->pair_modes = memory_take_doubles(shop->fft.hook.length)) == NULL) return 1;
    if ((shop->k = memory_take_doubles(shop->linear.shells)) == NULL) return 1;
    if ((shop->theory = memory_take_doubles(shop->linear.shells)) == NULL) return 1;
    for (size_t u = 0; u < UNIVERSES; u++) {
        if ((shop->power[u] = memory_take_doubles(shop->linear.shells)) == NULL) return 1;
    }
    if ((shop->id = malloc(shop->count * sizeof *shop->id)) == NULL) return 1;
    /* Gadget's ids begin at 1. */
    TRY(fixpair_particle_ids(shop->id, shop->count, &shop->fft.hook.configuration, 1, &shop->exec));
    TRY(describe(&conditions, shop, &kinds[NORMAL]));
    return linear_theory(shop->theory, shop->linear.edges, shop->linear.shells + 1, &conditions);
}

/* Takes a workshop at any stage of open_workshop. */
static void close_workshop(struct workshop *shop) {
    boltzmann_close(&shop->table);
    transform_close(&shop->fft);
    transform_close(&shop->fine);
    linear_close(&shop->linear);
    fixpair_threads_destroy(shop->threads);
    free(shop->position);
    free(shop->velocity);
    free(shop->pair_position);
    free(shop->pair_velocity);
    free(shop->id);
    free(shop->modes);
    free(shop->pair_modes);
    free(shop->k);
    free(shop->theory);
    for (size_t u = 0; u < UNIVERSES; u++) free(shop->power[u]);
}

static int read_options(struct options *options, int argc, char **argv) {
    const struct options defaults = {64, 1, "build/gadget", "../examples/data/camb_goliat_linear.txt", GADGET_KPC};
    char *end = "";
    *options = defaults;
    if (argc > 1) options->n = (size_t)strtoul(argv[1], &end, 10);
    if (*end == '\0' && argc > 2) options->seed = strtoull(argv[2], &end, 10);
    if (argc > 3) options->folder = argv[3];
    if (argc > 4) options->table = argv[4];
    if (argc > 5 && strcmp(argv[5], "mpc") == 0) options->unit = GADGET_MPC;
    if (*end != '\0' || argc > 6 || options->n < 8 || options->n > 560 ||
        (argc > 5 && strcmp(argv[5], "mpc") != 0 && strcmp(argv[5], "kpc") != 0)) {
        fprintf(stderr, "usage: %s [n, 8 to 560 [seed [folder [table [kpc|mpc]]]]]\n", argv[0]);
        return 1;
    }
    if (mkdir(options->folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", options->folder, strerror(errno));
        return 1;
    }
    return 0;
}

static int run(struct workshop *shop, int *failures) {
    TRY(open_workshop(shop));
    printf("fixpair %s: n = %lu, seed %llu, L = %g Mpc/h, z = %g, %lu rows of %s\n\n", fixpair_version(),
           (unsigned long)shop->options.n, (unsigned long long)shop->options.seed, BOX, REDSHIFT,
           (unsigned long)shop->table.rows, shop->options.table);
    for (size_t u = 0; u < UNIVERSES; u++) TRY(make_universe(shop, u, failures));
    print_spectra(shop);
    *failures += check_spectra(shop);
    TRY(check_pair_modes(shop, failures));
    TRY(check_matched_phases(shop, failures));
    TRY(check_pair_particles(shop, failures));
    return 0;
}

int main(int argc, char **argv) {
    struct workshop shop;
    int failures = 0;
    memset(&shop, 0, sizeof shop);
    if (read_options(&shop.options, argc, argv) != 0) return EXIT_FAILURE;
    int broken = run(&shop, &failures);
    close_workshop(&shop);
    return broken || failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
