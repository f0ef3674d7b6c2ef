/*
 * The universes of 2lptic_fixpair against the scheme of 2LPTic, drawn mode by mode without the library, and what must hold among
 * them.
 *
 *     check_2lptic TABLE FOLDER PARAMETERFILE...
 *
 * Writes the files that the parameter files of 2lptic/ name into FOLDER first. Of the first file broken ones are made, which have
 * to be refused, of the last, which has Fnl, pairs. With GSL, which 2LPTic draws with, ranlxd1 is GSL's own.
 */

/* mkdir */
#define _POSIX_C_SOURCE 200112L

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifdef HAVE_GSL
#include <gsl/gsl_rng.h>
#endif

#include "2lptic/inputs.h"
#include "2lptic/parameters.h"
#include "2lptic/scheme.h"
#include "2lptic/universe.h"
#include "check.h"
#include "memory.h"

#define PI 3.14159265358979323846

enum { PARTICLES = 6 };

static const struct choices zeldovich = {FIXPAIR_SHAPE_LOCAL, FIXPAIR_ORDER_FIRST, 0, 2};
static const struct choices second_order = {FIXPAIR_SHAPE_LOCAL, FIXPAIR_ORDER_SECOND, 0, 2};

#ifdef HAVE_GSL
static int gsl_ranlxd1(double *uniforms, size_t len, uint64_t seed) {
    static gsl_rng *generator;
    if (generator == NULL) generator = gsl_rng_alloc(gsl_rng_ranlxd1);
    gsl_rng_set(generator, (unsigned long)seed);
    for (size_t i = 0; i < len; i++) uniforms[i] = gsl_rng_uniform(generator);
    return 0;
}

static const char generator_name[] = "GSL's ranlxd1";
static scheme_generator *const generator = gsl_ranlxd1;
#else
static const char generator_name[] = "the library's ranlxd1 (GSL is not installed)";
static scheme_generator *const generator = scheme_ranlxd1;
#endif

/* D of today over D of then, as 2LPTic integrates it: Heath's formula, by Simpson's rule in sqrt(a). */
static double growth_integral(const struct parameters *p, double a) {
    enum { INTERVALS = 20000 };
    double sum = 0.0, curvature = 1.0 - p->omega - p->omega_lambda;
    for (int i = 0; i <= INTERVALS; i++) {
        double root = sqrt(a) * i / INTERVALS, x = root * root;
        double weight = i == 0 || i == INTERVALS ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * 2.0 * root * pow(x / (p->omega + curvature * x + p->omega_lambda * x * x * x), 1.5);
    }
    return sqrt(p->omega / (a * a * a) + curvature / (a * a) + p->omega_lambda) * sum * sqrt(a) / INTERVALS / 3.0;
}

/* P of z = 0: 2LPTic's interpolation where there is one. */
static int power_at(double *power, const struct universe *universe, double k) {
    if (universe->spectrum.rows > 0) {
        *power = spectrum_power(&universe->spectrum, k);
        return 0;
    }
    TRY(fixpair_linear_power(power, &k, 1, &universe->conditions.cosmology, &universe->conditions.linear, 0.0));
    return 0;
}

/* sigma8 of what a fit or a table gives: of a table from 1e-4 to 20 h/Mpc, by the trapezoidal rule in ln k. */
static int integrate_sigma8(double *sigma8, const struct universe *universe) {
    enum { INTERVALS = 100000 };
    double sum = 0.0, step = log(2e5) / INTERVALS;
    if (universe->spectrum.rows == 0) {
        TRY(fixpair_linear_sigma(sigma8, 8.0, &universe->conditions.cosmology, &universe->conditions.linear));
        return 0;
    }
    for (int i = 0; i < INTERVALS; i++) {
        double k = 1e-4 * exp((i + 0.5) * step), x = 8.0 * k, window = 3.0 * (sin(x) / x - cos(x)) / (x * x);
        sum += step * k * k * k * spectrum_power(&universe->spectrum, k) * window * window / (2.0 * PI * PI);
    }
    *sigma8 = sqrt(sum);
    return 0;
}

/* Modes of 2LPTic's linear density. */
static int draw_scheme(const struct universe *universe, double *modes) {
    const struct parameters *p = universe->parameters;
    size_t n = (size_t)p->n_mesh, squares = 3 * (n / 2) * (n / 2) + 1;
    double box = universe->conditions.box_size, *amplitude = memory_take_doubles(squares);
    int outcome = amplitude == NULL;
    for (size_t square = 1; outcome == 0 && square < squares; square++) {
        double power = 0.0;
        outcome = power_at(&power, universe, 2.0 * PI / box * sqrt((double)square));
        amplitude[square] = sqrt(power / (box * box * box)) * universe->growth;
    }
    struct scheme scheme = {n, (size_t)p->n_sample, p->box, p->sphere_mode == 1, (int)p->fixed_amplitude, (int)p->phase_flip,
                            (uint64_t)p->seed, generator, amplitude};
    if (outcome == 0) outcome = scheme_density(&scheme, modes);
    free(amplitude);
    return outcome;
}

/* Modes of the library's linear density, without f_NL. */
static int draw_library(const struct universe *universe, double *modes) {
    const struct fixpair_conditions *c = &universe->conditions;
    const struct fixpair_brick *brick = &universe->fft.hook.fourier;
    size_t length, n = brick->n, reals = universe->fft.hook.length;
    TRY(fixpair_mode_table_length(&length, n));
    double *table = memory_take_doubles(length);
    int32_t status = table == NULL;
    if (status == 0) {
        status = fixpair_potential_amplitude_table(table, length, n, c->box_size, &c->cosmology, &c->linear, c->convention, NULL);
    }
    if (status == 0) status = fixpair_white_modes_f64(modes, reals, brick, &c->realisation, table, length, NULL);
    if (status == 0) {
        status = fixpair_alpha_table(table, length, n, c->box_size, &c->cosmology, &c->linear, c->redshift, c->convention, NULL);
    }
    if (status == 0) status = fixpair_scale_modes_f64(modes, reals, brick, table, length, NULL);
    free(table);
    TRY(status);
    return 0;
}

/* Is this mode exactly on the edge of a sphere? There 2LPTic's rounding of k L/(2 pi) decides, for each mode. */
static int is_on_edge(const struct parameters *p, const long number[3]) {
    long most = p->n_sample / 2, square = number[0] * number[0] + number[1] * number[1] + number[2] * number[2];
    return p->sphere_mode == 1 && square == most * most;
}

struct comparison {
    size_t modes, edge, wrong; /* compared; left alone; there in one and not in the other */
    double worst; /* |a - b|/|b| */
};

static struct comparison compare(const struct universe *universe, const double *library, const double *scheme) {
    const struct fixpair_brick *brick = &universe->fft.hook.fourier;
    struct comparison result = {0, 0, 0, 0.0};
    size_t n = brick->n;
    for (size_t column = 0; column < n * n; column++) {
        size_t i = column / n, j = column % n;
        for (size_t l = 0; l <= n / 2; l++) {
            const double *a = &library[2 * (i * brick->stride[0] + j * brick->stride[1] + l * brick->stride[2])];
            const double *b = &scheme[2 * (column * (n / 2 + 1) + l)];
            long number[3] = {(long)(i < n / 2 ? i : i - n), (long)(j < n / 2 ? j : j - n), (long)l};
            if (is_on_edge(universe->parameters, number)) {
                result.edge += 1;
                continue;
            }
            double modulus = hypot(b[0], b[1]);
            result.wrong += (modulus > 0.0) != (hypot(a[0], a[1]) > 0.0);
            result.modes += modulus > 0.0;
            if (modulus > 0.0) result.worst = fmax(result.worst, hypot(a[0] - b[0], a[1] - b[1]) / modulus);
        }
    }
    return result;
}

static int check_modes(const struct universe *universe, const double *library, const double *scheme, const char *name) {
    struct comparison result = compare(universe, library, scheme);
    int failures = claim(result.wrong == 0, "%s: both draw the same %lu modes, besides %lu on the edge of a sphere", name,
                         (unsigned long)result.modes, (unsigned long)result.edge);
    /*
     * An ulp is 2.2e-16. The phase, up to 2 pi, is rounded to 2 of them, sine, cosine and logarithm to 1 each; ln P, up to 20, to
     * 8 of P, so to 4 of its root; alpha is divided by and multiplied with, each to 4 more in T.
     */
    return failures + claim(result.worst < 4e-15, "%s: a mode differs by %.1e of itself at most", name, result.worst);
}

static double wrapped(double x, double box) {
    return x - box * floor(x / box + 0.5);
}

/* What the scheme moves a particle by: displacements of the eight corners around it, weighted by its nearness. */
static void interpolate(double psi[3], const struct universe *universe, const double *modes, size_t particle) {
    size_t n = (size_t)universe->parameters->n_mesh, cell[3];
    double above[3], each[3];
    for (size_t axis = 0; axis < 3; axis++) {
        double x = (double)n * glass_coordinate(&universe->glass, particle, axis);
        cell[axis] = (size_t)x;
        above[axis] = x - (double)cell[axis];
        psi[axis] = 0.0;
    }
    for (size_t corner = 0; corner < 8; corner++) {
        size_t at[3];
        double weight = 1.0;
        for (size_t axis = 0; axis < 3; axis++) {
            size_t up = corner >> axis & 1;
            at[axis] = (cell[axis] + up) % n;
            weight *= up ? above[axis] : 1.0 - above[axis];
        }
        if (weight == 0.0) continue;
        scheme_displacement(each, modes, n, universe->conditions.box_size, at);
        for (size_t axis = 0; axis < 3; axis++) psi[axis] += weight * each[axis];
    }
}

/* Some particles at first order, against sums over all modes. */
static int check_particles(const struct universe *universe, const double *modes, const char *name) {
    double box = universe->conditions.box_size, a = 1.0 / (1.0 + universe->conditions.redshift), e;
    double worst = 0.0, fastest = 0.0, largest = 0.0;
    struct fixpair_growth growth;
    TRY(fixpair_expansion(&e, &a, 1, &universe->conditions.cosmology));
    TRY(fixpair_growth_factors(&growth, &a, 1, &universe->conditions.cosmology));
    for (size_t i = 0; i < PARTICLES; i++) {
        size_t particle = universe->glass.count * i / PARTICLES + 7 * i;
        double psi[3];
        interpolate(psi, universe, modes, particle);
        for (size_t axis = 0; axis < 3; axis++) {
            double stood = box * glass_coordinate(&universe->glass, particle, axis);
            double moved = wrapped(universe->position[3 * particle + axis] - stood, box);
            double rate = universe->velocity[3 * particle + axis] / (100.0 * a * e * growth.f);
            worst = fmax(worst, fabs(moved - psi[axis]));
            fastest = fmax(fastest, fabs(rate - psi[axis]));
            largest = fmax(largest, fabs(psi[axis]));
        }
    }
    /* Positions are rounded to 1e-16 of the box; sums of 1e4 terms of 1e-2 of psi to 1e-14 of it, and velocities with them. */
    int failures = claim(worst < 1e-15 * box + 1e-12 * largest,
                         "%s: %d particles, moved by up to %.3g Mpc/h, are where a sum over modes has them, to %.1e", name,
                         (int)PARTICLES, largest, worst);
    return failures + claim(fastest < 1e-12 * largest, "%s: and as fast, to %.1e of it", name, fastest / largest);
}

/* One parameter file against the scheme. */
static int check_file(const char *path, int *failures) {
    struct parameters parameters;
    struct universe universe;
    memset(&universe, 0, sizeof universe);
    TRY(parameters_read(&parameters, path));
    parameters.f_nl = 0.0;
    const char *name = parameters.file_base;
    size_t n = (size_t)parameters.n_mesh;
    double *scheme = memory_take_doubles(n * n * (n + 2)), *library = NULL;
    int broken = scheme == NULL || universe_open(&universe, &parameters, &zeldovich) != 0;
    if (!broken) {
        library = memory_take_doubles(universe.fft.hook.length);
        broken = library == NULL || draw_scheme(&universe, scheme) != 0 || draw_library(&universe, library) != 0 ||
                 universe_make(&universe) != 0;
    }
    if (!broken) {
        double heath = growth_integral(&parameters, 1.0 / (1.0 + parameters.redshift)) / growth_integral(&parameters, 1.0);
        double sigma8 = 0.0;
        broken = integrate_sigma8(&sigma8, &universe);
        /* The library integrates a differential equation to 1e-8, this a smooth integrand to less. */
        *failures += claim(fabs(universe.growth / heath - 1.0) < 1e-7, "%s: growth is that of Heath's integral, to %.1e", name,
                           fabs(universe.growth / heath - 1.0));
        /* 1e-7 is beyond the ends of this integral, and kinks of tables cost as much. */
        *failures += claim(fabs(sigma8 / parameters.sigma8 - 1.0) < 1e-6, "%s: sigma8 is %.8f", name, sigma8);
        *failures += check_modes(&universe, library, scheme, name);
        *failures += check_particles(&universe, scheme, name);
    }
    free(scheme);
    free(library);
    universe_close(&universe);
    return broken;
}

/* Displacements of a universe, in Mpc/h. NULL after saying what is wrong. */
static double *displacements(const struct parameters *parameters, const struct choices *choices) {
    struct universe universe;
    double *moved = NULL;
    if (universe_open(&universe, parameters, choices) == 0 && universe_make(&universe) == 0) {
        moved = memory_take_doubles(3 * universe.glass.count);
    }
    for (size_t i = 0; moved != NULL && i < 3 * universe.glass.count; i++) {
        double box = universe.conditions.box_size;
        moved[i] = wrapped(universe.position[i] - box * glass_coordinate(&universe.glass, i / 3, i % 3), box);
    }
    universe_close(&universe);
    return moved;
}

/* r.m.s. of sum over w of w_i d_i, over that of d_0. */
static double combined(double *const *d, const double *weights, size_t members, size_t count) {
    double square = 0.0, first = 0.0;
    for (size_t i = 0; i < count; i++) {
        double sum = 0.0;
        for (size_t m = 0; m < members; m++) sum += weights[m] * d[m][i];
        square += sum * sum;
        first += d[0][i] * d[0][i];
    }
    return sqrt(square / first);
}

/* Originals and inverted of a file, at f_NL = 0, F and -F, at first and second order. */
static int check_family(const char *path, int *failures) {
    enum { FIRST, FIRST_INVERTED, SECOND, SECOND_INVERTED, PLUS, MINUS, PLUS_INVERTED, MEMBERS };
    static const struct {
        const struct choices *choices;
        double sign;
        long flip;
    } kinds[MEMBERS] = {{&zeldovich, 0.0, 0}, {&zeldovich, 0.0, 1}, {&second_order, 0.0, 0}, {&second_order, 0.0, 1},
                        {&zeldovich, 1.0, 0}, {&zeldovich, -1.0, 0}, {&zeldovich, 1.0, 1}};
    struct parameters parameters;
    double *d[MEMBERS] = {NULL};
    TRY(parameters_read(&parameters, path));
    size_t count = 3 * (size_t)(parameters.n_mesh * parameters.n_mesh * parameters.n_mesh);
    double f_nl = parameters.f_nl;
    int broken = 0;
    for (int i = 0; i < MEMBERS && !broken; i++) {
        parameters.f_nl = kinds[i].sign * f_nl;
        parameters.phase_flip = kinds[i].flip;
        d[i] = displacements(&parameters, kinds[i].choices);
        broken = d[i] == NULL;
    }
    if (!broken) {
        const char *name = parameters.file_base;
        double *pair[] = {d[FIRST], d[FIRST_INVERTED]}, *second[] = {d[FIRST], d[SECOND], d[SECOND_INVERTED]};
        double *png[] = {d[FIRST], d[PLUS], d[MINUS]};
        double *png_pair[] = {d[PLUS], d[PLUS_INVERTED], d[FIRST]};
        /* Positions are rounded to 1e-16 of a box of 1000 Mpc/h, and displacements are 0.1 Mpc/h. */
        double odd = combined(pair, (const double[]){1.0, 1.0}, 2, count);
        *failures += claim(odd < 1e-11, "%s: to first order the mean of a pair does not move, to %.1e", name, odd);
        double mean = combined(second, (const double[]){0.0, 0.5, 0.5}, 3, count);
        double left = combined(second, (const double[]){1.0, -0.5, 0.5}, 3, count);
        *failures += claim(mean > 1e-5 && left < 1e-11,
                           "%s: to second order it moves by %.1e, and half the difference is first order, to %.1e: no odd part in the mean",
                           name, mean, left);
        double change = combined(png, (const double[]){-1.0, 1.0, 0.0}, 3, count);
        double sum = combined(png, (const double[]){-2.0, 1.0, 1.0}, 3, count);
        *failures += claim(change > 1e-4 && sum < 1e-11, "%s: Fnl changes displacements by %.1e, linearly, to %.1e", name, change, sum);
        double flipped = combined(png_pair, (const double[]){-1.0, 1.0, 2.0}, 3, count);
        *failures += claim(flipped < 1e-11, "%s: and alike in both of a pair, to %.1e", name, flipped);
    }
    for (int i = 0; i < MEMBERS; i++) free(d[i]);
    return broken;
}

/* A copy of a parameter file without the lines of a key, and with a line more. */
static int change_file(const char *from, const char *to, const char *key, const char *line) {
    char text[1024];
    FILE *in = fopen(from, "r"), *out = fopen(to, "w");
    while (in != NULL && out != NULL && fgets(text, sizeof text, in) != NULL) {
        if (strcspn(text, " \t\n") != strlen(key) || strncmp(text, key, strlen(key)) != 0) fputs(text, out);
    }
    if (out != NULL) fprintf(out, "%s\n", line);
    int failed = in == NULL || out == NULL;
    if (in != NULL) fclose(in);
    if (out != NULL) failed |= fclose(out) != 0;
    return failed;
}

static int check_refusals(const char *path, const char *folder, int *failures) {
    static const struct {
        const char *what, *key, *line;
    } bad[] = {
        {"an unknown key", "-", "Nmesh3 32"},           {"a key that is there twice", "-", "Box 100.0"},
        {"a missing key", "Seed", ""},                  {"a key without a value", "Seed", "Seed % none"},
        {"a word for a number", "Seed", "Seed x"},      {"a fraction of a seed", "Seed", "Seed 1.5"},
        {"warm dark matter", "WDM_On", "WDM_On 1"},     {"a second species", "OmegaDM_2ndSpecies", "OmegaDM_2ndSpecies 0.01"},
        {"an odd mesh", "Nmesh", "Nmesh 33"},           {"Fnl without a transfer function", "-", "Fnl 100"},
        {"a glass without tiles", "GlassTileFac", ""},
    };
    struct parameters parameters;
    char changed[1024];
    snprintf(changed, sizeof changed, "%s/refused.param", folder);
    printf("\nrefused:\n");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        if (change_file(path, changed, bad[i].key, bad[i].line) != 0) return 1;
        fflush(stdout);
        int refused = parameters_read(&parameters, changed) != 0;
        *failures += claim(refused, "%s is refused", bad[i].what);
    }
    return remove(changed) != 0;
}

int main(int argc, char **argv) {
    int failures = 0, broken = 0;
    if (argc < 5) {
        fprintf(stderr, "usage: %s TABLE FOLDER PARAMETERFILE PARAMETERFILE...\n", argv[0]);
        return EXIT_FAILURE;
    }
    if (mkdir(argv[2], 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", argv[2], strerror(errno));
        return EXIT_FAILURE;
    }
    broken = inputs_write(argv[1], argv[2]);
    printf("2LPTic's scheme with %s\n", generator_name);
    for (int i = 3; i < argc && !broken; i++) broken = check_file(argv[i], &failures);
    if (!broken) broken = check_family(argv[argc - 1], &failures);
    if (!broken) broken = check_refusals(argv[3], argv[2], &failures);
    return broken || failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
