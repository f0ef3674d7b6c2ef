#include "verdict.h"

#include <math.h>
#include <stdio.h>

static const char *const sentences[] = {
    [MISTAKE_NONE] = "right",
    [MISTAKE_POWER_NOT_SCALED] = "the spectrum of z = 0 was used at the start: scale it by D(z)^2",
    [MISTAKE_POWER_SCALED_TWICE] = "the spectrum of the start was scaled by D(z)^2 once more",
    [MISTAKE_POWER_TO_MEAN] = "pi/4 of the power: moduli are fixed to the mean, sqrt(pi/4 P/V); fix them to the r.m.s., sqrt(P/V)",
    [MISTAKE_POWER_HALF] = "a factor of two: <|delta_k|^2> = P/V is shared by real and imaginary part, P/(2V) each",
    [MISTAKE_POWER_UNIT] = "a factor of h^3: P is in (Mpc/h)^3 and k in h/Mpc, not Mpc^3 and 1/Mpc",
    [MISTAKE_POWER_FOURIER] = "a factor of (2 pi)^3: P belongs to another Fourier convention",
    [MISTAKE_POWER_OTHER] = "the power is wrong by a factor that none of the usual mistakes makes",
    [MISTAKE_NOT_FIXED] = "the shells scatter as those of a Gaussian field: amplitudes are not fixed, or not before everything else",
    [MISTAKE_FIXED] = "the shells do not scatter: amplitudes are fixed, and normal ones were promised",
    [MISTAKE_F_NL_NONE] = "f_NL adds nothing",
    [MISTAKE_F_NL_SIGN] = "the sign of f_NL is wrong: Phi = + (3/2) Omega_m H0^2/(k^2 ...) delta, minus the Newtonian potential",
    [MISTAKE_F_NL_CONVENTION] = "f_NL is in the other convention: f_NL(LSS) = g(z_rad)/g(0) f_NL(CMB)",
    [MISTAKE_F_NL_CURVATURE] = "a factor of 5/3: f_NL multiplies the curvature zeta and not Phi = 3/5 zeta, or the other way",
    [MISTAKE_F_NL_AFTER_TRANSFER] = "the density was squared: f_NL comes before the transfer function, on Phi",
    [MISTAKE_F_NL_TEMPLATE] = "what f_NL adds is not Phi_G^2 of this seed: another seed, another shape, or aliasing",
    [MISTAKE_F_NL_OTHER] = "the size of f_NL is wrong by a factor that none of the usual mistakes makes",
    [MISTAKE_PAIR_FIELD] = "the final field was inverted, which is a universe of -f_NL: invert Phi_G, before it is squared",
    [MISTAKE_PAIR_PHASES] = "the inverted universe has not the phases of the original plus pi",
    [MISTAKE_PAIR_OTHER] = "what the pair has in common is not f_NL Phi_G^2",
    [MISTAKE_VELOCITY_GADGET] = "a factor of sqrt(a): Gadget's files hold v/sqrt(a), v peculiar",
    [MISTAKE_VELOCITY_COMOVING] = "a factor of a: the peculiar velocity is a dx/dt",
    [MISTAKE_VELOCITY_OTHER] = "velocities are wrong by a factor that none of the usual mistakes makes",
};

const char *verdict_sentence(enum mistake mistake) {
    return sentences[mistake];
}

static int say(enum question question, const struct evidence *evidence, const struct fixpair_conditions *conditions) {
    enum mistake mistake = verdict_on(question, evidence, conditions);
    printf("   %s  %s\n", mistake == MISTAKE_NONE ? "PASS" : "FAIL", verdict_sentence(mistake));
    return mistake != MISTAKE_NONE;
}

int verdict_report(const struct evidence *e, const struct fixpair_conditions *c) {
    int fixed = c->realisation.amplitude != FIXPAIR_AMPLITUDE_NORMAL, failures = 0;
    char wide[32] = "1";
    if (!fixed) sprintf(wide, "1 +/- %.3f", e->power_error);
    printf("P over linear theory           %10.5f  should be %-11s", e->power, wide);
    failures += say(QUESTION_POWER, e, c);
    printf("scatter over a Gaussian's      %10.5f  should be %-11s", e->scatter, fixed ? "0" : "about 1");
    failures += say(QUESTION_AMPLITUDE, e, c);
    printf("f_NL                           %10.3f  should be %-11g", e->f_nl, c->f_nl);
    failures += say(QUESTION_F_NL, e, c);
    printf("   correlation with Phi_G^2    %10.5f  should be %d\n", e->local, c->f_nl < 0.0 ? -1 : 1);
    if (!isnan(e->odd)) {
        printf("f_NL of the pair's average     %10.3f  should be %-11g", e->even_f_nl, c->f_nl);
        failures += say(QUESTION_PAIR, e, c);
        printf("   and of half its difference  %10.5f  should be 0\n", e->odd);
    }
    if (!isnan(e->velocity)) {
        printf("velocity over a H f psi        %10.5f  should be 1          ", e->velocity);
        failures += say(QUESTION_VELOCITY, e, c);
    }
    return failures;
}
