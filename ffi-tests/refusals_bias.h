/*
 * The part of refusals.c about bias and its likelihood.
 */

CALL(bias_init, (P(0)))
CALL(bias_of_k, (P(0), P(1), P(2), L(0)))
CALL(halo_power, (P(0), P(1), P(2), P(3), L(0), a->i[0]))
CALL(measured_bias, (P(0), P(1), P(2), P(3), P(4), L(0), a->i[0]))
CALL(likelihood_init, (P(0)))
CALL(likelihood_add, (P(0), P(1), P(2), P(3), P(4), L(0), a->i[0]))
CALL(likelihood_add_correlated_scratch, (P(0), L(0)))
CALL(likelihood_add_correlated, (P(0), P(1), P(2), P(3), P(4), L(0), L(1), a->d[0], P(5), L(2)))
CALL(likelihood_merge, (P(0), P(1)))
CALL(likelihood_chi_squared, (P(0), P(1), P(2)))

static void refuse_spectra_choices(void) {
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
}

/* The halos of the paper. */
static fixpair_bias *bias_at(int pointer) {
    fixpair_bias *bias = STRUCT(pointer, IN, fixpair_bias);
    MUST(fixpair_bias_init(bias));
    bias->b_g = 2.32;
    bias->f_nl = 100.0;
    return bias;
}

static void refuse_biases(fixpair_bias *bias) {
    refuse_infinite(&bias->b_g);
    refuse_infinite(&bias->p);
    refuse_infinite(&bias->f_nl);
    refuse_not_positive(&bias->delta_c);
    REFUSED(FIXPAIR_ERROR_RANGE, bias->b_g = bias->f_nl = 1e300);
}

enum { OF_SPECTRA = 8 };

/* P_hh, or P_hm, of halos with b_g and f_NL, and what it is made of. */
static void fill_spectra(const fixpair_bias *bias, double *power, double *sigma, double *linear, double *alpha, int32_t of) {
    int i;
    for (i = 0; i < OF_SPECTRA; i++) {
        linear[i] = 1e4 / (i + 1);
        alpha[i] = 500.0 * (i + 1) * (i + 1);
    }
    MUST(fixpair_halo_power(power, bias, linear, alpha, OF_SPECTRA, of));
    for (i = 0; i < OF_SPECTRA; i++) {
        sigma[i] = 0.05 * power[i];
    }
}

/* Of the halos of the paper, whose sigma is `scale` times the usual; with b_g = -1 they have P_hm. */
static fixpair_bias_likelihood likelihood_of(double scale, double b_g) {
    fixpair_bias bias = {2.32, 1.0, 100.0, 1.686};
    fixpair_bias_likelihood likelihood;
    double power[OF_SPECTRA], sigma[OF_SPECTRA], linear[OF_SPECTRA], alpha[OF_SPECTRA];
    int32_t of = b_g < 0.0 ? FIXPAIR_SPECTRUM_HALO_MATTER : FIXPAIR_SPECTRUM_HALO_HALO;
    int i;
    bias.b_g = b_g;
    fill_spectra(&bias, power, sigma, linear, alpha, of);
    for (i = 0; i < OF_SPECTRA; i++) {
        sigma[i] = scale * (sigma[i] < 0.0 ? -sigma[i] : sigma[i]);
    }
    MUST(fixpair_likelihood_init(&likelihood));
    MUST(fixpair_likelihood_add(&likelihood, power, sigma, linear, alpha, OF_SPECTRA, of));
    return likelihood;
}

static fixpair_bias_likelihood *likelihood_at(int pointer, role role) {
    fixpair_bias_likelihood *likelihood = STRUCT(pointer, role, fixpair_bias_likelihood);
    *likelihood = likelihood_of(1.0, 2.32);
    return likelihood;
}

static void refuse_likelihoods(fixpair_bias_likelihood *likelihood) {
    refuse_infinite(&likelihood->root[0][0]);
    refuse_infinite(&likelihood->root[5][5]);
    refuse_infinite(&likelihood->root[4][1]);
    REFUSED(FIXPAIR_ERROR_RANGE, likelihood->root[5][4] = 1.0);
}

static void refuse_halos(void) {
    fixpair_bias *bias;
    double *linear, *alpha, *power, *sigma;
    int which;
    for (which = 0; which < 2; which++) {
        begin(which ? "likelihood_init" : "bias_init", which ? call_likelihood_init : call_bias_init);
        argument(0, OUT, which ? sizeof(fixpair_bias_likelihood) : sizeof(fixpair_bias), sizeof(double));
        refuse_pointers_and_lengths();
        begin(which ? "halo_power" : "bias_of_k", which ? call_halo_power : call_bias_of_k);
        ARRAY(0, OUT, double, 3);
        bias = bias_at(1);
        linear = numbers_at(2, 3);
        alpha = which ? numbers_at(3, 3) : linear;
        length(0, 3, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED((t.a.n[0] = 0, t.a.p[0] = t.a.p[2] = t.a.p[3] = NULL));
        refuse_biases(bias);
        refuse_not_positive(alpha + 2);
        REFUSED(FIXPAIR_ERROR_RANGE, alpha[2] = 1e-307);
        if (which) {
            refuse_infinite(linear + 2);
            refuse_spectra_choices();
            ACCEPTED((t.a.i[0] = FIXPAIR_SPECTRUM_HALO_MATTER, linear[2] = -1.0));
        }
    }
    begin("measured_bias", call_measured_bias);
    ARRAY(0, OUT, double, 3);
    ARRAY(1, OUT, double, 3);
    power = numbers_at(2, 3);
    sigma = numbers_at(3, 3);
    linear = numbers_at(4, 3);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();
    refuse_infinite(power + 2);
    refuse_not_positive(sigma + 2);
    refuse_not_positive(linear + 2);
    refuse_spectra_choices();
    REFUSED(FIXPAIR_ERROR_RANGE, power[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, power[1] = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, (power[1] = 1e200, linear[1] = 1e-200));
    ACCEPTED((power[1] = -1.0, t.a.i[0] = FIXPAIR_SPECTRUM_HALO_MATTER));
}

static void refuse_data(void) {
    fixpair_bias_likelihood *likelihood, *other;
    fixpair_layout layout;
    double *power, *sigma, *linear, *alpha, *root;
    int i;
    begin("likelihood_add", call_likelihood_add);
    likelihood = likelihood_at(0, OUT);
    power = numbers_at(1, 3);
    sigma = numbers_at(2, 3);
    linear = numbers_at(3, 3);
    alpha = numbers_at(4, 3);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[1] = t.a.p[2] = t.a.p[3] = t.a.p[4] = NULL));
    ACCEPTED((power[0] = -1.0, t.a.i[0] = FIXPAIR_SPECTRUM_HALO_MATTER));
    ACCEPTED(likelihood->bins = UINT64_MAX);
    refuse_likelihoods(likelihood);
    refuse_infinite(power + 2);
    refuse_not_positive(sigma + 2);
    refuse_not_positive(linear + 2);
    refuse_not_positive(alpha + 2);
    refuse_spectra_choices();
    REFUSED(FIXPAIR_ERROR_RANGE, (power[1] = 1e200, sigma[1] = 1e-200));
    REFUSED(FIXPAIR_ERROR_RANGE, alpha[1] = 1e-200);

    begin("likelihood_add_correlated_scratch", call_likelihood_add_correlated_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();

    MUST(fixpair_likelihood_add_correlated_scratch(&layout, 3));
    begin("likelihood_add_correlated", call_likelihood_add_correlated);
    likelihood = likelihood_at(0, OUT);
    power = numbers_at(1, 3);
    linear = numbers_at(2, 3);
    alpha = numbers_at(3, 3);
    root = numbers_at(4, 9);
    SCRATCH_OF(5, layout.size);
    length(0, 3, FREE);
    t.a.n[1] = 2;
    length(2, layout.size, SCRATCH);
    t.a.d[0] = 0.75;
    refuse_pointers_and_lengths();
    for (i = 0; i < 4; i++) {
        ACCEPTED(t.a.n[1] = (size_t)i);
    }
    refuse_likelihoods(likelihood);
    refuse_infinite(power + 2);
    refuse_not_positive(linear + 2);
    refuse_not_positive(alpha + 2);
    for (i = 0; i < 9; i++) {
        refuse_infinite(root + i);
    }
    refuse_not_positive(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 4);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_SINGULAR, root[4] = 0.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, root[8] = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, (power[1] = 1e200, root[4] = 1e-200));

    begin("likelihood_merge", call_likelihood_merge);
    likelihood = likelihood_at(0, OUT);
    other = likelihood_at(1, IN);
    refuse_pointers_and_lengths();
    refuse_likelihoods(likelihood);
    refuse_likelihoods(other);
    REFUSED(FIXPAIR_ERROR_RANGE, likelihood->root[0][5] = other->root[0][5] = 1.7e308);

    begin("likelihood_chi_squared", call_likelihood_chi_squared);
    ARRAY(0, OUT, double, 1);
    likelihood = likelihood_at(1, IN);
    bias_at(2);
    refuse_pointers_and_lengths();
    refuse_likelihoods(likelihood);
    refuse_biases((fixpair_bias *)t.good.p[2]);
}
