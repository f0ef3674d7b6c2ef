#include "verdict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

#define PI 3.141592653589793

/* Files of floats leave 1e-4; a code's own growth, constants and 2998 Mpc/h for c/H0 some 1e-3. */
#define TOLERANCE 0.01
/* A field that is normal has 1 +/- 0.2 with the shells of 32^3. */
#define FIXED_SCATTER 0.1
#define NORMAL_SCATTER 0.5

struct reading {
    double factor; /* what a measured ratio would be */
    enum mistake mistake;
};

/* Sum of Re a b* over modes with 0 < |n| <= n/4, k and -k. */
static double dot(const double *a, const double *b, const struct fixpair_brick *brick) {
    long n = (long)brick->n, most = n / 4;
    double sum = 0.0;
    for (long i = -most; i <= most; i++) {
        for (long j = -most; j <= most; j++) {
            for (long l = 0; l <= most; l++) {
                long square = i * i + j * j + l * l;
                if (square == 0 || square > most * most) continue;
                size_t at = 2 * ((size_t)((i + n) % n) * brick->stride[0] + (size_t)((j + n) % n) * brick->stride[1] +
                                 (size_t)l * brick->stride[2]);
                sum += (l == 0 ? 1.0 : 2.0) * (a[at] * b[at] + a[at + 1] * b[at + 1]);
            }
        }
    }
    return sum;
}

static int scale(struct linear *linear, double *modes) {
    TRY(fixpair_scale_modes_f64(modes, linear->fft->length, &linear->fft->fourier, linear->factor, linear->length, linear->exec));
    return 0;
}

/* modes <- (f^2 - <f^2>) of modes f. */
static int square(struct linear *linear, double *modes, double *copy) {
    size_t len = linear->fft->length;
    memcpy(copy, modes, len * sizeof *copy);
    TRY(fixpair_add_local_f64(modes, len, &linear->fft->fourier, 1.0, 0.0, linear->fine, linear->work, linear->fine->length,
                              linear->scratch, linear->scratch_len, linear->exec));
    for (size_t i = 0; i < len; i++) modes[i] -= copy[i];
    return 0;
}

/* t = alpha ((delta/alpha)^2 - < >). */
static int local_template(struct linear *linear, const struct fixpair_conditions *c, double *t, double *copy) {
    TRY(fixpair_alpha_table(linear->factor, linear->length, linear->n, c->box_size, &c->cosmology, &c->linear, c->redshift,
                            c->convention, linear->exec));
    for (size_t s = 1; s < linear->length; s++) linear->factor[s] = 1.0 / linear->factor[s];
    TRY(scale(linear, t));
    TRY(square(linear, t, copy));
    for (size_t s = 1; s < linear->length; s++) linear->factor[s] = 1.0 / linear->factor[s];
    return scale(linear, t);
}

static int measure_power(struct evidence *evidence, struct linear *linear, const struct fixpair_conditions *c, const double *modes) {
    size_t shells = linear->n / 4 - 1;
    double *k = memory_take_doubles(3 * linear->shells), sum = 0.0, count = 0.0, square = 0.0;
    if (k == NULL) return 1;
    double *power = k + linear->shells, *theory = power + linear->shells;
    int broken = linear_measure(linear, c->box_size, modes, k, power);
    if (!broken) broken = linear_theory(theory, linear->edges, linear->shells + 1, c);
    for (size_t b = 0; !broken && b < shells; b++) {
        sum += (double)linear->bins[b].count * power[b] / theory[b];
        count += (double)linear->bins[b].count;
    }
    evidence->power = sum / count;
    evidence->power_error = sqrt(2.0 / count);
    for (size_t b = 0; !broken && b < shells; b++) {
        double deviation = power[b] / theory[b] / evidence->power - 1.0;
        square += deviation * deviation * (double)linear->bins[b].count / 2.0;
    }
    evidence->scatter = sqrt(square / (double)shells);
    free(k);
    return broken;
}

/* Three meshes for templates and differences. */
static int compare(struct evidence *evidence, struct linear *linear, const struct fixpair_conditions *c, const double *gaussian,
                   const double *png, const double *inverted, const double *gaussian_inverted, double *mesh[3]) {
    const struct fixpair_brick *brick = &linear->fft->fourier;
    size_t len = linear->fft->length;
    double *t = mesh[0], *late = mesh[1], *difference = mesh[2];
    memcpy(t, gaussian, len * sizeof *t);
    TRY(local_template(linear, c, t, difference));
    memcpy(late, gaussian, len * sizeof *late);
    TRY(square(linear, late, difference));

    for (size_t i = 0; i < len; i++) difference[i] = png[i] - gaussian[i];
    double size = dot(difference, difference, brick), worth = dot(t, t, brick);
    evidence->f_nl = dot(difference, t, brick) / worth;
    evidence->local = size > 0.0 ? dot(difference, t, brick) / sqrt(size * worth) : 0.0;
    evidence->late = size > 0.0 ? dot(difference, late, brick) / sqrt(size * dot(late, late, brick)) : 0.0;
    if (inverted == NULL) return 0;

    for (size_t i = 0; i < len; i++) {
        double second = gaussian_inverted == NULL ? 0.0 : gaussian[i] + gaussian_inverted[i];
        difference[i] = 0.5 * (png[i] + inverted[i] - second);
    }
    evidence->even_f_nl = dot(difference, t, brick) / worth;
    for (size_t i = 0; i < len; i++) {
        double other = gaussian_inverted == NULL ? -gaussian[i] : gaussian_inverted[i];
        difference[i] = 0.5 * (png[i] - inverted[i] - gaussian[i] + other);
    }
    evidence->odd = sqrt(dot(difference, difference, brick) / dot(gaussian, gaussian, brick));
    return 0;
}

int verdict_measure(struct evidence *evidence, struct linear *linear, const struct fixpair_conditions *conditions, const double *gaussian,
                    const double *png, const double *inverted, const double *gaussian_inverted) {
    double *mesh[3];
    evidence->even_f_nl = evidence->odd = evidence->velocity = (double)NAN;
    int broken = measure_power(evidence, linear, conditions, gaussian);
    for (size_t i = 0; i < 3; i++) broken |= (mesh[i] = memory_take_doubles(linear->fft->length)) == NULL;
    if (!broken) broken = compare(evidence, linear, conditions, gaussian, png, inverted, gaussian_inverted, mesh);
    for (size_t i = 0; i < 3; i++) free(mesh[i]);
    return broken;
}

/* Which of some readings a ratio is nearest to, if it is as near as can be told. */
static enum mistake read_ratio(double ratio, double tolerance, const struct reading *readings, size_t count, enum mistake other) {
    for (size_t i = 0; i < count; i++) {
        if (fabs(ratio / readings[i].factor - 1.0) < tolerance) return readings[i].mistake;
    }
    return other;
}

static enum mistake on_power(const struct evidence *e, const struct fixpair_conditions *c) {
    struct fixpair_growth growth;
    double a = 1.0 / (1.0 + c->redshift), h3 = pow(c->cosmology.h, 3.0), tolerance = fmax(TOLERANCE, 4.0 * e->power_error);
    if (fixpair_growth_factors(&growth, &a, 1, &c->cosmology) != 0) return MISTAKE_POWER_OTHER;
    double d2 = growth.d * growth.d, turn3 = pow(2.0 * PI, 3.0);
    const struct reading readings[] = {
        {1.0, MISTAKE_NONE},          {1.0 / d2, MISTAKE_POWER_NOT_SCALED}, {d2, MISTAKE_POWER_SCALED_TWICE}, {PI / 4.0, MISTAKE_POWER_TO_MEAN},
        {2.0, MISTAKE_POWER_HALF},    {0.5, MISTAKE_POWER_HALF},            {h3, MISTAKE_POWER_UNIT},         {1.0 / h3, MISTAKE_POWER_UNIT},
        {turn3, MISTAKE_POWER_FOURIER}, {1.0 / turn3, MISTAKE_POWER_FOURIER},
    };
    return read_ratio(e->power, tolerance, readings, sizeof readings / sizeof *readings, MISTAKE_POWER_OTHER);
}

static enum mistake on_amplitude(const struct evidence *e, const struct fixpair_conditions *c) {
    if (c->realisation.amplitude == FIXPAIR_AMPLITUDE_NORMAL) return e->scatter > NORMAL_SCATTER ? MISTAKE_NONE : MISTAKE_FIXED;
    return e->scatter < FIXED_SCATTER ? MISTAKE_NONE : MISTAKE_NOT_FIXED;
}

static enum mistake on_f_nl(const struct evidence *e, const struct fixpair_conditions *c) {
    double g = 1.0, ratio = e->f_nl / c->f_nl;
    if (fabs(ratio) < TOLERANCE) return MISTAKE_F_NL_NONE;
    /* Nothing but the template: what files of floats leave of it is 0.99 and more. */
    if (fabs(e->local) < 0.97) return fabs(e->late) > 0.97 ? MISTAKE_F_NL_AFTER_TRANSFER : MISTAKE_F_NL_TEMPLATE;
    if (fixpair_growth_suppression(&g, &c->cosmology) != 0) return MISTAKE_F_NL_OTHER;
    const struct reading readings[] = {
        {1.0, MISTAKE_NONE},          {-1.0, MISTAKE_F_NL_SIGN},           {g, MISTAKE_F_NL_CONVENTION},
        {1.0 / g, MISTAKE_F_NL_CONVENTION}, {5.0 / 3.0, MISTAKE_F_NL_CURVATURE}, {3.0 / 5.0, MISTAKE_F_NL_CURVATURE},
    };
    return read_ratio(ratio, TOLERANCE, readings, sizeof readings / sizeof *readings, MISTAKE_F_NL_OTHER);
}

static enum mistake on_pair(const struct evidence *e) {
    /* f_NL changes a mode by some 1e-3, files by less. */
    if (e->odd > 0.05) return MISTAKE_PAIR_PHASES;
    double ratio = e->even_f_nl / e->f_nl;
    if (fabs(ratio) < TOLERANCE) return MISTAKE_PAIR_FIELD;
    return fabs(ratio - 1.0) < TOLERANCE ? MISTAKE_NONE : MISTAKE_PAIR_OTHER;
}

static enum mistake on_velocity(const struct evidence *e, const struct fixpair_conditions *c) {
    double a = 1.0 / (1.0 + c->redshift);
    const struct reading readings[] = {
        {1.0, MISTAKE_NONE},
        {sqrt(a), MISTAKE_VELOCITY_GADGET},
        {1.0 / sqrt(a), MISTAKE_VELOCITY_GADGET},
        {a, MISTAKE_VELOCITY_COMOVING},
        {1.0 / a, MISTAKE_VELOCITY_COMOVING},
    };
    return read_ratio(e->velocity, TOLERANCE, readings, sizeof readings / sizeof *readings, MISTAKE_VELOCITY_OTHER);
}

enum mistake verdict_on(enum question question, const struct evidence *evidence, const struct fixpair_conditions *conditions) {
    switch (question) {
        case QUESTION_POWER: return on_power(evidence, conditions);
        case QUESTION_AMPLITUDE: return on_amplitude(evidence, conditions);
        case QUESTION_F_NL: return on_f_nl(evidence, conditions);
        case QUESTION_PAIR: return isnan(evidence->odd) ? MISTAKE_NONE : on_pair(evidence);
        case QUESTION_VELOCITY: return isnan(evidence->velocity) ? MISTAKE_NONE : on_velocity(evidence, conditions);
        default: return MISTAKE_NONE;
    }
}
