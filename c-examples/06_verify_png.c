/*
 * Are another code's initial conditions with local f_NL right? Its Gadget-2 files in, PASS or FAIL and why out.
 *
 *     06_verify_png [options] gaussian png [inverted [gaussian_inverted]]
 *
 *     --table FILE    P(k) or T(k) of z = 0 that the code was given          (../examples/data/camb_goliat_linear.txt)
 *     --f-nl NUMBER   what it was asked for                                  (100)
 *     --convention    cmb or lss                                             (cmb)
 *     --sigma8, --n-s of a table of T(k), and of the primordial spectrum     (0.8, 0.96)
 *     --normal        amplitudes are meant to be normal, not fixed
 *
 * Files are of one seed: f_NL = 0, f_NL, and both with inverted phases, the last of which is needed beyond first order; from a lattice, particles
 * of type 1, one file each. Box, redshift and background are taken from the header. Exits with 0 only if all is right.
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boltzmann.h"
#include "check.h"
#include "fixpair.h"
#include "gadget.h"
#include "lattice.h"
#include "linear.h"
#include "memory.h"
#include "options.h"
#include "transform.h"
#include "verdict.h"

enum { GAUSSIAN, PNG, INVERTED, GAUSSIAN_INVERTED, FILES };

struct options {
    const char *table;
    const char *files[FILES];
    double f_nl, sigma8, n_s;
    int32_t convention, amplitude;
};

struct work {
    struct options options;
    struct boltzmann_table table;
    struct transform fft, fine;
    struct linear linear;
    struct fixpair_conditions conditions;
    double *modes[FILES];
    double velocity; /* over displacement, of the first file */
    size_t n;
};

static int usage(const char *name) {
    fprintf(stderr,
            "usage: %s [--table FILE] [--f-nl NUMBER] [--convention cmb|lss] [--sigma8 NUMBER] [--n-s NUMBER] [--normal] gaussian png [inverted [gaussian_inverted]]\n",
            name);
    return 1;
}

static int read_options(struct options *options, int argc, char **argv) {
    const struct options defaults = {
        "../examples/data/camb_goliat_linear.txt", {NULL, NULL, NULL, NULL}, 100.0, 0.8, 0.96, FIXPAIR_CONVENTION_CMB, FIXPAIR_AMPLITUDE_FIXED,
    };
    size_t files = 0;
    *options = defaults;
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        if (strncmp(name, "--", 2) != 0) {
            if (files == FILES) return usage(argv[0]);
            options->files[files++] = name;
            continue;
        }
        if (strcmp(name, "--normal") == 0) {
            options->amplitude = FIXPAIR_AMPLITUDE_NORMAL;
            continue;
        }
        int wrong = 0;
        if (strcmp(name, "--table") == 0) options->table = value;
        else if (strcmp(name, "--f-nl") == 0) wrong = option_number(&options->f_nl, value, -1e6, 1e6) || options->f_nl == 0.0;
        else if (strcmp(name, "--sigma8") == 0) wrong = option_number(&options->sigma8, value, 0.01, 10.0);
        else if (strcmp(name, "--n-s") == 0) wrong = option_number(&options->n_s, value, 0.1, 2.0);
        else if (strcmp(name, "--convention") == 0 && strcmp(value, "lss") == 0) options->convention = FIXPAIR_CONVENTION_LSS;
        else if (strcmp(name, "--convention") != 0 || strcmp(value, "cmb") != 0) wrong = 1;
        if (wrong) return usage(argv[0]);
        i++;
    }
    return files < 2 ? usage(argv[0]) : 0;
}

/* What the header of the first file claims, and memory for a mesh of its lattice. */
static int open_work(struct work *work, const struct gadget_header *header, size_t count, double unit) {
    struct fixpair_conditions *c = &work->conditions;
    work->n = (size_t)floor(cbrt((double)count) + 0.5);
    if (work->n * work->n * work->n != count || work->n < 16) return claim(0, "there are n^3 particles, n = 16 or more");
    TRY(fixpair_conditions_init(c, 0));
    c->realisation.amplitude = work->options.amplitude;
    c->cosmology.omega_m = header->omega_0;
    c->cosmology.omega_de = header->omega_lambda;
    c->cosmology.h = header->hubble_param;
    c->cosmology.n_s = work->options.n_s;
    c->redshift = header->redshift;
    c->box_size = header->box_size / unit;
    c->f_nl = work->options.f_nl;
    c->convention = work->options.convention;
    TRY(boltzmann_read(&work->table, work->options.table));
    c->linear = boltzmann_linear(&work->table, work->options.sigma8);
    TRY(transform_open(&work->fft, work->n, NULL));
    TRY(transform_open(&work->fine, fixpair_fft_next_side(3 * work->n / 2), NULL));
    return linear_open(&work->linear, &work->fft.hook, &work->fine.hook, NULL);
}

static int read_modes(struct work *work, size_t which) {
    struct gadget_file file;
    memset(&file, 0, sizeof file);
    int broken = gadget_read(&file, work->options.files[which]);
    double unit = broken ? 0.0 : gadget_unit(&file.header), root_a = sqrt(file.header.time);
    if (!broken && unit == 0.0) broken = claim(0, "the masses of %s fill its box", work->options.files[which]);
    if (!broken && which == GAUSSIAN) broken = open_work(work, &file.header, file.count, unit);
    if (!broken && file.count != work->n * work->n * work->n) broken = claim(0, "%s has as many particles", work->options.files[which]);
    double *x = broken ? NULL : memory_take_doubles(3 * file.count), *v = broken ? NULL : memory_take_doubles(3 * file.count);
    for (size_t i = 0; x != NULL && v != NULL && i < 3 * file.count; i++) {
        x[i] = (double)file.position[i] / unit;
        v[i] = (double)file.velocity[i] * root_a;
    }
    if (!broken) broken = x == NULL || v == NULL || (work->modes[which] = memory_take_doubles(work->fft.hook.length)) == NULL;
    if (!broken) {
        broken = lattice_density(work->modes[which], &work->velocity, x, which == GAUSSIAN ? v : NULL, work->conditions.box_size,
                                 &work->fft.hook);
    }
    free(x);
    free(v);
    gadget_close(&file);
    return broken;
}

static int run(struct work *work, int *failures) {
    struct evidence evidence;
    struct fixpair_growth growth;
    double expansion;
    for (size_t i = 0; i < FILES && work->options.files[i] != NULL; i++) TRY(read_modes(work, i));
    const struct fixpair_conditions *c = &work->conditions;
    TRY(verdict_measure(&evidence, &work->linear, c, work->modes[GAUSSIAN], work->modes[PNG], work->modes[INVERTED],
                        work->modes[GAUSSIAN_INVERTED]));
    double a = 1.0 / (1.0 + c->redshift);
    TRY(fixpair_growth_factors(&growth, &a, 1, &c->cosmology));
    TRY(fixpair_expansion(&expansion, &a, 1, &c->cosmology));
    evidence.velocity = work->velocity / (a * 100.0 * expansion * growth.f);
    printf("%lu^3 particles, L = %g Mpc/h, z = %g, Omega_m = %g\n\n", (unsigned long)work->n, c->box_size, c->redshift, c->cosmology.omega_m);
    *failures = verdict_report(&evidence, c);
    return 0;
}

int main(int argc, char **argv) {
    struct work work;
    int failures = 0;
    memset(&work, 0, sizeof work);
    if (read_options(&work.options, argc, argv) != 0) return EXIT_FAILURE;
    int broken = run(&work, &failures);
    for (size_t i = 0; i < FILES; i++) free(work.modes[i]);
    linear_close(&work.linear);
    transform_close(&work.fft);
    transform_close(&work.fine);
    boltzmann_close(&work.table);
    return broken || failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
