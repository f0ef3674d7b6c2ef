/*
 * Are another code's initial conditions with primordial non-Gaussianity right? What its modes say, and in words what is wrong.
 *
 * Asked for are the linear densities of universes of one seed: `gaussian` with f_NL = 0, `png` with f_NL, and both `inverted`. Nothing of fixpair's noise is assumed: f_NL is found by comparing the code with itself. With phi = gaussian/alpha the template
 * t = alpha (phi^2 - <phi^2>) is all that f_NL may add, and
 *
 *    f = sum (png - gaussian) t* / sum |t|^2        over modes with |n| <= n/4
 *
 * has no noise but that of the files. Power is compared shell by shell with theory, averaged over the same modes.
 */

#ifndef VERDICT_H
#define VERDICT_H

#include "linear.h"

/* What was measured. */
struct evidence {
    double power;       /* P over theory, mean over modes */
    double power_error; /* of a Gaussian universe */
    double scatter;     /* of shells about that, over a Gaussian universe's: 1 for normal, 0 for fixed amplitudes */
    double f_nl;        /* see above */
    double local;       /* correlation of png - gaussian with t */
    double late;        /* its correlation with gaussian^2 */
    double even_f_nl;   /* f of what f_NL adds to the pair's average; NaN without an inverted universe */
    double odd;         /* r.m.s. of what it adds to half the pair's difference, over that of gaussian; NaN likewise */
    double velocity;    /* velocity over a H f psi; NaN where there are no particles */
};

/* What is wrong, or nothing. */
enum mistake {
    MISTAKE_NONE,
    MISTAKE_POWER_NOT_SCALED,    /* P of z = 0 taken for that of the start */
    MISTAKE_POWER_SCALED_TWICE,  /* P of the start scaled back once more */
    MISTAKE_POWER_TO_MEAN,       /* fixed to the mean modulus */
    MISTAKE_POWER_HALF,          /* the variance of a mode given to its real and imaginary part each, or halved */
    MISTAKE_POWER_UNIT,          /* Mpc for Mpc/h */
    MISTAKE_POWER_FOURIER,       /* (2 pi)^3 */
    MISTAKE_POWER_OTHER,
    MISTAKE_NOT_FIXED,
    MISTAKE_FIXED,
    MISTAKE_F_NL_NONE,
    MISTAKE_F_NL_SIGN,
    MISTAKE_F_NL_CONVENTION,     /* CMB for LSS, or LSS for CMB */
    MISTAKE_F_NL_CURVATURE,      /* of zeta = 5/3 Phi */
    MISTAKE_F_NL_AFTER_TRANSFER, /* the density was squared */
    MISTAKE_F_NL_TEMPLATE,       /* something else was added */
    MISTAKE_F_NL_OTHER,
    MISTAKE_PAIR_FIELD,          /* the final field was inverted */
    MISTAKE_PAIR_PHASES,         /* not the same phases plus pi */
    MISTAKE_PAIR_OTHER,
    MISTAKE_VELOCITY_GADGET,     /* v/sqrt(a) for v, or the other way */
    MISTAKE_VELOCITY_COMOVING,   /* dx/dt for a dx/dt, or the other way */
    MISTAKE_VELOCITY_OTHER
};

enum question { QUESTION_POWER, QUESTION_AMPLITUDE, QUESTION_F_NL, QUESTION_PAIR, QUESTION_VELOCITY, QUESTIONS };

/*
 * Measures. `conditions` is what the code claims: cosmology, linear, redshift, box_size, f_nl, convention; its seed does not matter. `inverted` may
 * be NULL; gaussian_inverted too, which is then taken for -gaussian, as it is at first order. Returns 0, or 1 after saying what is wrong with the memory or the call.
 */
int verdict_measure(struct evidence *evidence, struct linear *linear, const struct fixpair_conditions *conditions, const double *gaussian,
                    const double *png, const double *inverted, const double *gaussian_inverted);

/* The answer to one question. */
enum mistake verdict_on(enum question question, const struct evidence *evidence, const struct fixpair_conditions *conditions);

/* A sentence about it. */
const char *verdict_sentence(enum mistake mistake);

/* Prints what was measured beside what should be, and PASS or FAIL with a sentence. Returns the number of FAIL. */
int verdict_report(const struct evidence *evidence, const struct fixpair_conditions *conditions);

#endif
