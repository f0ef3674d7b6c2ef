/*
 * Plants each mistake that 06_verify_png knows in initial conditions that are right, and checks that it is found, and that nothing is
 * found where nothing was planted. The host's noise is the library's here, which the verdict does not know.
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "fixpair.h"
#include "lattice.h"
#include "linear.h"
#include "memory.h"
#include "transform.h"
#include "verdict.h"

#define F_NL 100.0

enum { N = 32, GAUSSIAN = 0, PNG = 1, INVERTED = 2, FILES = 3 };

struct bench {
    struct transform fft, fine;
    struct linear linear;
    struct fixpair_conditions claimed;
    double *modes[FILES];
};

/* What is done to the three universes: of `member`s, factors on all or on f_NL, choices. */
struct plant {
    enum mistake mistake;
    enum question question;
    double factor;      /* on the modes of all universes */
    double f_nl;        /* instead of F_NL */
    int32_t amplitude;  /* instead of fixed */
    int32_t convention; /* instead of CMB */
    uint64_t png_seed, inverted_seed;
};

/* As they should be, all from seed 5. */
static const struct plant right = {MISTAKE_NONE, QUESTION_POWER, 1.0, F_NL, FIXPAIR_AMPLITUDE_FIXED, FIXPAIR_CONVENTION_CMB, 5, 5};

static int make(struct bench *bench, const struct plant *plant) {
    for (size_t i = 0; i < FILES; i++) {
        struct fixpair_conditions c = bench->claimed;
        c.realisation.seed = i == PNG ? plant->png_seed : i == INVERTED ? plant->inverted_seed : 5;
        c.realisation.amplitude = plant->amplitude;
        c.realisation.phase = i == INVERTED ? FIXPAIR_PHASE_INVERTED : FIXPAIR_PHASE_ORIGINAL;
        c.convention = plant->convention;
        c.f_nl = i == GAUSSIAN ? 0.0 : plant->f_nl;
        TRY(linear_density(&bench->linear, &c, bench->modes[i]));
        for (size_t m = 0; m < bench->fft.hook.length; m++) bench->modes[i][m] *= plant->factor;
    }
    return 0;
}

/* delta + F (delta^2 - <delta^2>): f_NL after the transfer function. */
static int square_the_density(struct bench *bench) {
    struct linear *l = &bench->linear;
    size_t len = bench->fft.hook.length;
    for (size_t i = PNG; i < FILES; i++) {
        double sign = i == INVERTED ? -1.0 : 1.0;
        for (size_t m = 0; m < len; m++) bench->modes[i][m] = sign * bench->modes[GAUSSIAN][m];
        TRY(fixpair_add_local_f64(bench->modes[i], len, &l->fft->fourier, 0.1, 0.0, l->fine, l->work, l->fine->length, l->scratch,
                                  l->scratch_len, NULL));
    }
    return 0;
}

static void invert_the_field(struct bench *bench) {
    for (size_t m = 0; m < bench->fft.hook.length; m++) bench->modes[INVERTED][m] = -bench->modes[PNG][m];
}

/* Only the question that a mistake belongs to is asked for it. */
static int found(const struct bench *bench, const struct evidence *evidence, enum question question, enum mistake mistake) {
    enum mistake verdict = verdict_on(question, evidence, &bench->claimed);
    return claim(verdict == mistake, "%s", verdict_sentence(mistake));
}

static int judge(struct bench *bench, struct evidence *evidence) {
    return verdict_measure(evidence, &bench->linear, &bench->claimed, bench->modes[GAUSSIAN], bench->modes[PNG], bench->modes[INVERTED],
                           NULL);
}

/* Nothing wrong: every number that the page docs/verify-your-png-ics.md promises, in double precision. */
static int check_right(struct bench *bench, int *failures) {
    struct evidence e;
    TRY(make(bench, &right));
    TRY(judge(bench, &e));
    *failures += claim(verdict_report(&e, &bench->claimed) == 0, "all is found right");
    /* Roundings of some 1e-16 over f_NL phi of 1e-3, and over phi of the template of 1e-5. */
    *failures += claim(fabs(e.power - 1.0) < 1e-12 && e.scatter < 1e-10, "fixed: exactly the input power");
    *failures += claim(fabs(e.f_nl / F_NL - 1.0) < 1e-6 && e.local > 1.0 - 1e-6, "f_NL is found to 1e-6");
    *failures += claim(fabs(e.even_f_nl / F_NL - 1.0) < 1e-6 && e.odd < 1e-10, "the pair's average has f_NL and nothing else");
    return 0;
}

static int check_plants(struct bench *bench, int *failures) {
    struct fixpair_growth growth;
    double a = 1.0 / (1.0 + bench->claimed.redshift), h = bench->claimed.cosmology.h;
    TRY(fixpair_growth_factors(&growth, &a, 1, &bench->claimed.cosmology));
    struct plant plants[] = {
        {MISTAKE_POWER_NOT_SCALED, QUESTION_POWER, 1.0 / growth.d, F_NL, 1, 0, 5, 5},
        {MISTAKE_POWER_SCALED_TWICE, QUESTION_POWER, growth.d, F_NL, 1, 0, 5, 5},
        {MISTAKE_POWER_TO_MEAN, QUESTION_POWER, 1.0, F_NL, FIXPAIR_AMPLITUDE_FIXED_TO_MEAN, 0, 5, 5},
        {MISTAKE_POWER_HALF, QUESTION_POWER, sqrt(0.5), F_NL, 1, 0, 5, 5},
        {MISTAKE_POWER_UNIT, QUESTION_POWER, pow(h, -1.5), F_NL, 1, 0, 5, 5},
        {MISTAKE_POWER_FOURIER, QUESTION_POWER, pow(6.283185307179586, 1.5), F_NL, 1, 0, 5, 5},
        {MISTAKE_POWER_OTHER, QUESTION_POWER, 1.3, F_NL, 1, 0, 5, 5},
        {MISTAKE_NOT_FIXED, QUESTION_AMPLITUDE, 1.0, F_NL, FIXPAIR_AMPLITUDE_NORMAL, 0, 5, 5},
        {MISTAKE_F_NL_NONE, QUESTION_F_NL, 1.0, 0.0, 1, 0, 5, 5},
        {MISTAKE_F_NL_SIGN, QUESTION_F_NL, 1.0, -F_NL, 1, 0, 5, 5},
        {MISTAKE_F_NL_CONVENTION, QUESTION_F_NL, 1.0, F_NL, 1, FIXPAIR_CONVENTION_LSS, 5, 5},
        {MISTAKE_F_NL_CURVATURE, QUESTION_F_NL, 1.0, 0.6 * F_NL, 1, 0, 5, 5},
        {MISTAKE_F_NL_OTHER, QUESTION_F_NL, 1.0, 1.2 * F_NL, 1, 0, 5, 5},
        {MISTAKE_F_NL_TEMPLATE, QUESTION_F_NL, 1.0, F_NL, 1, 0, 6, 5},
        {MISTAKE_PAIR_PHASES, QUESTION_PAIR, 1.0, F_NL, 1, 0, 5, 6},
    };
    struct evidence e;
    for (size_t i = 0; i < sizeof plants / sizeof *plants; i++) {
        TRY(make(bench, &plants[i]));
        TRY(judge(bench, &e));
        *failures += found(bench, &e, plants[i].question, plants[i].mistake);
    }
    TRY(make(bench, &right));
    TRY(square_the_density(bench));
    TRY(judge(bench, &e));
    *failures += found(bench, &e, QUESTION_F_NL, MISTAKE_F_NL_AFTER_TRANSFER);
    TRY(make(bench, &right));
    invert_the_field(bench);
    TRY(judge(bench, &e));
    *failures += found(bench, &e, QUESTION_PAIR, MISTAKE_PAIR_FIELD);
    bench->claimed.realisation.amplitude = FIXPAIR_AMPLITUDE_NORMAL;
    *failures += found(bench, &e, QUESTION_AMPLITUDE, MISTAKE_FIXED);
    bench->claimed.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;

    /* f_NL in one member of the pair alone. */
    for (size_t m = 0; m < bench->fft.hook.length; m++) bench->modes[INVERTED][m] = -bench->modes[GAUSSIAN][m];
    TRY(judge(bench, &e));
    *failures += found(bench, &e, QUESTION_PAIR, MISTAKE_PAIR_OTHER);

    /* The ratio is linear in the velocities: check_lattice measures that of right ones, and a factor on them is one on it. */
    const struct {
        double factor;
        enum mistake mistake;
    } velocities[] = {{1.0, MISTAKE_NONE}, {1.0 / sqrt(a), MISTAKE_VELOCITY_GADGET}, {1.0 / a, MISTAKE_VELOCITY_COMOVING}, {1.2, MISTAKE_VELOCITY_OTHER}};
    for (size_t i = 0; i < sizeof velocities / sizeof *velocities; i++) {
        e.velocity = velocities[i].factor;
        *failures += found(bench, &e, QUESTION_VELOCITY, velocities[i].mistake);
    }
    return 0;
}

/* The modes that particles of a lattice give back are those that they were made with. */
static int check_lattice(struct bench *bench, int *failures) {
    struct fixpair_conditions c = bench->claimed;
    size_t count = (size_t)N * N * N, len = bench->fft.hook.length;
    double *x = memory_take_doubles(3 * count), *v = memory_take_doubles(3 * count), slope, worst = 0.0, largest = 0.0;
    struct fixpair_components_f64 position = {x, x + 1, x + 2, 3, count}, velocity = {v, v + 1, v + 2, 3, count};
    struct fixpair_layout layout;
    if (x == NULL || v == NULL) return 1;
    c.realisation.seed = 5;
    c.order = FIXPAIR_ORDER_FIRST;
    TRY(fixpair_initial_conditions_scratch_f64(&layout, &c, &bench->fft.hook, &bench->fine.hook));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    TRY(fixpair_initial_conditions_f64(&position, &velocity, &c, &bench->fft.hook, &bench->fine.hook, scratch, layout.size, NULL));
    /* A lattice in the middle of its cells, with its first particle last. */
    for (size_t i = 0; i < 3 * count; i++) x[i] = fmod(x[i] + 0.5 * c.box_size / N, c.box_size);
    for (size_t axis = 0; axis < 3; axis++) {
        double first = x[axis];
        x[axis] = x[3 * (count - 1) + axis];
        x[3 * (count - 1) + axis] = first;
        first = v[axis];
        v[axis] = v[3 * (count - 1) + axis];
        v[3 * (count - 1) + axis] = first;
    }
    TRY(make(bench, &right));
    TRY(lattice_density(bench->modes[GAUSSIAN], &slope, x, v, c.box_size, &bench->fft.hook));
    const struct fixpair_brick *brick = &bench->fft.hook.fourier;
    for (size_t i = 0; i < N; i++) {
        for (size_t j = 0; j < N; j++) {
            for (size_t l = 0; l <= N / 2; l++) {
                /* Half a cell turns the phase by pi (i + j + l)/n, which moduli do not see. */
                size_t at = 2 * (i * brick->stride[0] + j * brick->stride[1] + l * brick->stride[2]);
                double made = hypot(bench->modes[PNG][at], bench->modes[PNG][at + 1]);
                worst = fmax(worst, fabs(hypot(bench->modes[GAUSSIAN][at], bench->modes[GAUSSIAN][at + 1]) - made));
                largest = fmax(largest, made);
            }
        }
    }
    struct fixpair_growth growth;
    double a = 1.0 / (1.0 + c.redshift), expansion;
    TRY(fixpair_growth_factors(&growth, &a, 1, &c.cosmology));
    TRY(fixpair_expansion(&expansion, &a, 1, &c.cosmology));
    double ratio = slope / (a * 100.0 * expansion * growth.f);
    /* The circular mean that finds the lattice is off at third order in displacements over cells, which leaves 3e-10 here. */
    *failures += claim(fabs(ratio - 1.0) < 1e-8, "their velocities are a H f psi, to %.0e", fabs(ratio - 1.0));
    /* Positions are rounded to 1e-13 Mpc/h of displacements of some 0.1. */
    *failures += claim(len > 0 && worst < 1e-9 * largest, "particles of any order give their modes back, to %.0e", worst / largest);
    free(x);
    free(v);
    free(scratch);
    return 0;
}

static int run(struct bench *bench, int *failures) {
    struct fixpair_conditions *c = &bench->claimed;
    TRY(fixpair_conditions_init(c, 0));
    c->realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    c->f_nl = F_NL;
    TRY(transform_open(&bench->fft, N, NULL));
    TRY(transform_open(&bench->fine, 3 * N / 2, NULL));
    TRY(linear_open(&bench->linear, &bench->fft.hook, &bench->fine.hook, NULL));
    for (size_t i = 0; i < FILES; i++) {
        if ((bench->modes[i] = memory_take_doubles(bench->fft.hook.length)) == NULL) return 1;
    }
    TRY(check_right(bench, failures));
    TRY(check_lattice(bench, failures));
    return check_plants(bench, failures);
}

int main(void) {
    struct bench bench;
    int failures = 0;
    memset(&bench, 0, sizeof bench);
    int broken = run(&bench, &failures);
    for (size_t i = 0; i < FILES; i++) free(bench.modes[i]);
    linear_close(&bench.linear);
    transform_close(&bench.fft);
    transform_close(&bench.fine);
    return broken || failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
