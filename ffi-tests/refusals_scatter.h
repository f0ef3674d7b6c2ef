/*
 * The part of refusals.c about models of scatter and comparisons of means.
 */

CALL(continuum_modes, (P(0), P(1), L(0), a->d[0], a->d[1]))
CALL(lattice_modes, (P(0), P(1), L(0)))
CALL(sigma_gaussian, (P(0), P(1), P(2), L(0), a->d[0]))
CALL(sigma_suppressed, (P(0), P(1), P(2), P(3), P(4), L(0), a->d[0]))
CALL(fit_suppression, (P(0), P(1), P(2), P(3), P(4), P(5), L(0), a->d[0], a->u))
CALL(ratio_of_means, (P(0), P(1), P(2), P(3), P(4), P(5), P(6), L(0)))
CALL(difference_of_means, (P(0), P(1), P(2), P(3), P(4), P(5), P(6), P(7), L(0)))

enum { OF_BINS = 8 };

static void refuse_models(void) {
    double *k, *power, *modes, *sigma, *error;
    fixpair_suppression *left;
    uint64_t *edges;
    int i;
    begin("continuum_modes", call_continuum_modes);
    ARRAY(0, OUT, double, 3);
    k = numbers_at(1, 3);
    length(0, 3, FREE);
    t.a.d[0] = 0.005;
    t.a.d[1] = 1000.0;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = t.a.p[1] = NULL));
    refuse_not_positive(k + 2);
    refuse_not_positive(&t.a.d[0]);
    refuse_not_positive(&t.a.d[1]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 1e110);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 1e-110);

    begin("lattice_modes", call_lattice_modes);
    ARRAY(0, OUT, uint64_t, 3);
    edges = ARRAY(1, IN, uint64_t, 4);
    length(0, 4, FREE);
    for (i = 0; i < 4; i++) {
        edges[i] = (uint64_t)(i * i);
    }
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[1] = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[1] = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, edges[3] = (UINT64_C(1) << 28) + 1);
    REFUSED(FIXPAIR_ERROR_RANGE, edges[3] = UINT64_MAX);

    begin("sigma_gaussian", call_sigma_gaussian);
    ARRAY(0, OUT, double, 3);
    power = numbers_at(1, 3);
    modes = numbers_at(2, 3);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = t.a.p[1] = t.a.p[2] = NULL));
    refuse_infinite(power + 2);
    refuse_not_positive(modes + 2);
    refuse_negative(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, power[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, power[1] = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, modes[0] = DBL_MIN * DBL_EPSILON);
    ACCEPTED((t.a.d[0] = 2.0, power[1] = -1.0));

    begin("sigma_suppressed", call_sigma_suppressed);
    ARRAY(0, OUT, double, 3);
    left = STRUCT(1, IN, fixpair_suppression);
    k = numbers_at(2, 3);
    power = numbers_at(3, 3);
    modes = numbers_at(4, 3);
    length(0, 3, FREE);
    left->cosmic_variance = 0.2;
    left->softening = 0.05;
    left->shot_noise = 0.9;
    t.a.d[0] = 1.0;
    refuse_pointers_and_lengths();
    refuse_negative(&left->cosmic_variance);
    refuse_not_positive(&left->softening);
    refuse_negative(&left->shot_noise);
    refuse_not_positive(k + 2);
    refuse_infinite(power + 1);
    refuse_not_positive(modes);
    refuse_negative(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, power[2] = -1e3);
    REFUSED(FIXPAIR_ERROR_RANGE, power[2] = DBL_MAX);

    begin("fit_suppression", call_fit_suppression);
    STRUCT(0, OUT, fixpair_suppression_fit);
    sigma = numbers_at(1, OF_BINS);
    error = numbers_at(2, OF_BINS);
    k = numbers_at(3, OF_BINS);
    power = numbers_at(4, OF_BINS);
    modes = numbers_at(5, OF_BINS);
    t.slots[2].optional = 1;
    length(0, OF_BINS, FREE);
    t.a.d[0] = 100.0;
    t.a.u = 41;
    for (i = 0; i < OF_BINS; i++) {
        fixpair_suppression of = {0.2, 0.05, 0.9};
        k[i] = 0.01 * (i + 1);
        power[i] = 1e4 / (i + 1);
        modes[i] = 30.0 * (i + 1) * (i + 1);
        MUST(fixpair_sigma_suppressed(sigma + i, &of, k + i, power + i, modes + i, 1, t.a.d[0]));
        sigma[i] *= 1.0 + 0.01 * noise((size_t)i);
        error[i] = 0.1 * sigma[i];
    }
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.u = 0);
    ACCEPTED(t.a.p[2] = NULL);
    ACCEPTED(t.a.d[0] = 0.0);
    refuse_not_positive(sigma + 7);
    refuse_not_positive(error + 7);
    refuse_not_positive(k + 7);
    refuse_infinite(power + 7);
    refuse_not_positive(modes + 7);
    refuse_negative(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 2);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, (t.a.p[2] = NULL, t.a.n[0] = 2));
    REFUSED(FIXPAIR_ERROR_SAMPLES, (t.a.p[2] = NULL, t.a.u = 1));
    REFUSED(FIXPAIR_ERROR_SINGULAR, memset(power, 0, OF_BINS * sizeof *power));
    REFUSED(FIXPAIR_ERROR_SINGULAR, (t.a.p[2] = NULL, memset(power, 0, OF_BINS * sizeof *power)));
}

static void refuse_means(void) {
    int which, i;
    for (which = 0; which < 2; which++) {
        double *of[8];
        begin(which ? "difference_of_means" : "ratio_of_means", which ? call_difference_of_means : call_ratio_of_means);
        ARRAY(0, OUT, double, 3);
        ARRAY(1, OUT, double, 3);
        for (i = 2; i < 7 + which; i++) {
            of[i] = numbers_at(i, 3);
        }
        of[6][0] = 1.0;
        of[6][1] = -1.0;
        of[6][2] = 0.5;
        t.slots[6].optional = 1;
        length(0, 3, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED(t.a.p[6] = NULL);
        ACCEPTED((t.a.n[0] = 0, memset(t.a.p, 0, sizeof t.a.p)));
        ACCEPTED((of[2][1] = 0.0, of[3][0] = of[5][1] = 0.0));
        for (i = 2; i < 7; i++) {
            refuse_infinite(of[i] + 2);
        }
        REFUSED(FIXPAIR_ERROR_RANGE, of[3][1] = -0.1);
        REFUSED(FIXPAIR_ERROR_RANGE, of[5][2] = -0.1);
        REFUSED(FIXPAIR_ERROR_RANGE, of[6][2] = 1.01);
        REFUSED(FIXPAIR_ERROR_RANGE, of[6][2] = -1.01);
        REFUSED(FIXPAIR_ERROR_RANGE, of[3][2] = 1e200);
        /* Infinity less infinity is no error of zero. */
        REFUSED(FIXPAIR_ERROR_RANGE, of[3][0] = of[5][0] = 1e200);
        if (which) {
            refuse_not_positive(of[7] + 2);
            REFUSED(FIXPAIR_ERROR_RANGE, (of[2][1] = DBL_MAX, of[4][1] = -DBL_MAX));
        } else {
            REFUSED(FIXPAIR_ERROR_RANGE, of[4][2] = 0.0);
            REFUSED(FIXPAIR_ERROR_RANGE, (of[2][1] = 1e200, of[4][1] = 1e-200));
        }
    }
}

static void refuse_scatter(void) {
    refuse_ensembles();
    refuse_resampling();
    refuse_models();
    refuse_means();
}
