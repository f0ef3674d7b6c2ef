/*
 * The part of refusals.c about fits, posteriors and levels.
 */

CALL(fit_bias, (P(0), P(1), P(2), (uint32_t)a->u))
CALL(bias_posterior_scratch, (P(0), L(0)))
CALL(bias_posterior, (P(0), P(1), L(0), P(2), P(3), (uint32_t)a->u, L(1), a->d[0], P(4), L(2)))
CALL(bias_range, (P(0), L(0), P(1), P(2), (uint32_t)a->u))
CALL(bias_grid, (P(0), L(0), P(1), P(2), (uint32_t)a->u, P(3), P(4), L(1)))
CALL(marginal, (P(0), P(1), L(0), L(1), a->i[0], a->d[0], a->d[1]))
CALL(read_posterior, (P(0), P(1), L(0), a->d[0], a->d[1], a->d[2]))
CALL(contours, (P(0), L(0), P(1), P(2), L(1), L(2), P(3), a->d[0]))
CALL(delta_chi_squared, (P(0), a->d[0], (uint32_t)a->u))
CALL(hartlap_factor, (P(0), a->u, a->v))
CALL(percival_factor, (P(0), a->u, a->v, a->w))

/* Sets of parameters at u. */
static void refuse_sets(void) {
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.u = FIXPAIR_FREE_P | FIXPAIR_FREE_F_NL);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.u = 7);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.u = 8);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.u = UINT32_MAX);
}

/* What fits and all that begin with one refuse: likelihood and start at p[at] and p[at + 1], both b_g and f_NL free. */
static void refuse_fits(int at) {
    fixpair_bias_likelihood *likelihood = (fixpair_bias_likelihood *)t.good.p[at];
    fixpair_bias *start = (fixpair_bias *)t.good.p[at + 1];
    refuse_likelihoods(likelihood);
    refuse_infinite(&start->b_g);
    refuse_infinite(&start->p);
    refuse_infinite(&start->f_nl);
    refuse_not_positive(&start->delta_c);
    refuse_sets();
    REFUSED(FIXPAIR_ERROR_SINGULAR, memset(likelihood, 0, sizeof *likelihood));
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, *likelihood = likelihood_of(1.0, -1.0));
}

static void refuse_constraints(void) {
    fixpair_layout layout;
    fixpair_bias *start;
    fixpair_bias_likelihood *likelihood;
    double *ranges;
    size_t *points;
    begin("fit_bias", call_fit_bias);
    STRUCT(0, OUT, fixpair_bias_fit);
    likelihood = likelihood_at(1, IN);
    start = bias_at(2);
    t.a.u = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.u = FIXPAIR_FREE_B_G | FIXPAIR_FREE_P);
    ACCEPTED(start->b_g = -2.32);
    refuse_fits(1);
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, (t.a.u = FIXPAIR_FREE_B_G, *likelihood = likelihood_of(1.0, -1.0)));
    REFUSED(FIXPAIR_ERROR_SINGULAR, (t.a.u = FIXPAIR_FREE_P, start->f_nl = 0.0));
    REFUSED(FIXPAIR_ERROR_SINGULAR, (t.a.u = FIXPAIR_FREE_F_NL, start->b_g = 1.0));

    begin("bias_posterior_scratch", call_bias_posterior_scratch);
    STRUCT(0, OUT, fixpair_layout);
    t.a.n[0] = 16;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.n[0] = 8192);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 15);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 8193);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = SIZE_MAX);

    MUST(fixpair_bias_posterior_scratch(&layout, 16));
    begin("bias_posterior", call_bias_posterior);
    STRUCT(0, OUT, fixpair_bias_fit);
    argument(1, OUT, 2 * sizeof(fixpair_posterior), sizeof(double));
    likelihood = likelihood_at(2, IN);
    start = bias_at(3);
    SCRATCH_OF(4, layout.size);
    length(0, 2, EXACT);
    t.a.n[1] = 16;
    length(2, layout.size, SCRATCH);
    t.a.u = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    t.a.d[0] = 0.68;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.u = FIXPAIR_FREE_F_NL, t.a.n[0] = 1));
    refuse_fits(2);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 15);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 8193);
    REFUSED(FIXPAIR_ERROR_SCRATCH, t.a.n[1] = 8192);
    refuse_not_positive(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1.0);
    /* Where b_g = p cannot be excluded, f_NL may be anything. */
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, *likelihood = likelihood_of(27.0, 2.32));
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, (start->p = 0.0, *likelihood = likelihood_of(1000.0, 2.32)));

    begin("bias_range", call_bias_range);
    ARRAY(0, OUT, double, 4);
    likelihood = likelihood_at(1, IN);
    start = bias_at(2);
    length(0, 2, EXACT);
    t.a.u = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    refuse_pointers_and_lengths();
    refuse_fits(1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.u = FIXPAIR_FREE_B_G);
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, *likelihood = likelihood_of(27.0, 2.32));
    REFUSED(FIXPAIR_ERROR_CONVERGENCE, (start->p = 0.0, *likelihood = likelihood_of(1000.0, 2.32)));

    begin("bias_grid", call_bias_grid);
    ARRAY(0, OUT, double, 20);
    likelihood = likelihood_at(1, IN);
    start = bias_at(2);
    ranges = numbers_at(3, 4);
    points = ARRAY(4, IN, size_t, 2);
    length(0, 20, EXACT);
    length(1, 2, EXACT);
    ranges[1] = ranges[0] + 1.0;
    ranges[3] = ranges[2] + 200.0;
    points[0] = 4;
    points[1] = 5;
    t.a.u = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    refuse_pointers_and_lengths();
    refuse_likelihoods(likelihood);
    refuse_infinite(&start->p);
    refuse_not_positive(&start->delta_c);
    refuse_sets();
    refuse_infinite(ranges);
    refuse_infinite(ranges + 3);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.u = FIXPAIR_FREE_F_NL);
    REFUSED(FIXPAIR_ERROR_LENGTH, points[1] = 6);
    REFUSED(FIXPAIR_ERROR_RANGE, ranges[1] = ranges[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, ranges[3] = ranges[2] - 1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, points[0] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, points[1] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, points[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, ranges[3] = 1e300);
}

static void refuse_densities(void) {
    double *values, *ranges;
    size_t count;
    int i;
    begin("marginal", call_marginal);
    ARRAY(0, OUT, double, 4);
    values = numbers_at(1, 20);
    length(0, 4, FREE);
    length(1, 5, FREE);
    t.a.d[1] = 1.0;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 5, t.a.n[1] = 4, t.a.i[0] = 1));
    ACCEPTED(t.a.n[1] = 1);
    for (i = 0; i < 20; i++) {
        refuse_infinite(values + i);
    }
    refuse_infinite(&t.a.d[0]);
    refuse_infinite(&t.a.d[1]);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.i[0] = 1, t.a.n[1] = 1));
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[0] = -1e308, t.a.d[1] = 1e308));
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = DBL_MIN);

    begin("read_posterior", call_read_posterior);
    STRUCT(0, OUT, fixpair_posterior);
    values = numbers_at(1, 5);
    length(0, 5, FREE);
    t.a.d[1] = 1.0;
    t.a.d[2] = 0.68;
    refuse_pointers_and_lengths();
    ACCEPTED(values[0] = values[4] = 0.0);
    ACCEPTED(values[0] = values[1] = values[3] = values[4] = 0.0);
    ACCEPTED((memset(values, 0, 5 * sizeof *values), values[2] = DBL_MIN * DBL_EPSILON));
    refuse_negative(values + 4);
    refuse_infinite(&t.a.d[0]);
    refuse_infinite(&t.a.d[1]);
    refuse_not_positive(&t.a.d[2]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[2] = 1.0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 2);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, memset(values, 0, 5 * sizeof *values));
    REFUSED(FIXPAIR_ERROR_RANGE, values[1] = values[2] = 1.7e308);
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[0] = -1e308, t.a.d[1] = 1e308));

    begin("contours", call_contours);
    values = (double *)lay(20 * sizeof *values, IN);
    ranges = (double *)lay(4 * sizeof *ranges, IN);
    for (i = 0; i < 20; i++) {
        double x = (double)(i / 5) - 1.5, y = (double)(i % 5) - 2.0;
        values[i] = x * x + y * y;
    }
    ranges[1] = ranges[3] = 1.0;
    MUST(fixpair_contours(NULL, 0, &count, values, 4, 5, ranges, 1.5));
    CHECK(count > 4);
    ARRAY(0, OUT, double, 4 * count);
    ARRAY(1, OUT, size_t, 1);
    memcpy(ARRAY(2, IN, double, 20), values, 20 * sizeof *values);
    memcpy(ARRAY(3, IN, double, 4), ranges, 4 * sizeof *ranges);
    values = (double *)t.a.p[2];
    ranges = (double *)t.a.p[3];
    length(0, count, LEAST);
    length(1, 4, FREE);
    length(2, 5, FREE);
    t.a.d[0] = 1.5;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL));
    for (i = 0; i < 20; i++) {
        refuse_infinite(values + i);
    }
    for (i = 0; i < 4; i++) {
        refuse_infinite(ranges + i);
    }
    refuse_infinite(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, ranges[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, (ranges[2] = -1e308, ranges[3] = 1e308));
    REFUSED(FIXPAIR_ERROR_RANGE, (values[0] = -1e308, t.a.d[0] = 1e308));
}

static void refuse_levels(void) {
    begin("delta_chi_squared", call_delta_chi_squared);
    ARRAY(0, OUT, double, 1);
    t.a.d[0] = 0.68;
    t.a.u = 2;
    refuse_pointers_and_lengths();
    refuse_not_positive(&t.a.d[0]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 3);

    begin("hartlap_factor", call_hartlap_factor);
    ARRAY(0, OUT, double, 1);
    t.a.u = 17;
    t.a.v = 14;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 16);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.v = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.v = 0);

    begin("percival_factor", call_percival_factor);
    ARRAY(0, OUT, double, 1);
    t.a.u = 19;
    t.a.v = 14;
    t.a.w = 2;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 18);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.v = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.w = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.w = 15);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.v = t.a.w = 0);
}

static void refuse_bias(void) {
    refuse_halos();
    refuse_data();
    refuse_constraints();
    refuse_densities();
    refuse_levels();
}
