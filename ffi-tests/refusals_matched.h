/*
 * The part of refusals.c about matched simulations, control variates and matrices.
 */

CALL(matched_difference, (P(0), P(1), P(2), L(0)))
CALL(difference_sigma, (P(0), a->d[0], a->d[1], a->d[2]))
CALL(effective_volume, (P(0), a->d[0], a->u, a->d[1], a->v))
CALL(universality, (P(0), P(1), a->d[0], a->d[1], a->d[2], a->d[3], a->d[4], a->d[5]))
CALL(control_variates_scratch, (P(0), L(0)))
CALL(control_variates, (P(0), L(0), P(1), P(2), L(1), P(3), P(4), a->i[0], a->d[0], P(5), L(2)))
CALL(control_variate_gain, (P(0), a->d[0], a->d[1], a->d[2], a->d[3]))
CALL(control_variate_loss, (P(0), a->u, a->v))
CALL(covariance_root_scratch, (P(0), L(0)))
CALL(covariance_root, (P(0), P(1), L(0), P(2), L(1)))
CALL(carpool_scratch, (P(0), L(0), L(1)))
CALL(carpool, (P(0), P(1), P(2), P(3), P(4), L(0), L(1), P(5), P(6), L(2), P(7), L(3)))

static void refuse_correlations(int d) {
    refuse_infinite(&t.a.d[d]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = 1.01);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = -1.01);
}

static void refuse_differences(void) {
    double *first, *second;
    int i;
    begin("matched_difference", call_matched_difference);
    STRUCT(0, OUT, fixpair_difference);
    first = numbers_at(1, 4);
    second = numbers_at(2, 4);
    length(0, 4, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[2] = t.a.p[1]);
    refuse_infinite(first + 3);
    refuse_infinite(second);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, first[0] = first[1] = first[2] = first[3] = 1.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, memset(second, 0, 4 * sizeof *second));
    REFUSED(FIXPAIR_ERROR_RANGE, first[1] = 1e200);
    /* Squares of both are finite, those of the difference are not. */
    REFUSED(FIXPAIR_ERROR_RANGE, (first[0] = second[1] = 6e153, first[1] = second[0] = -6e153));

    begin("difference_sigma", call_difference_sigma);
    ARRAY(0, OUT, double, 1);
    t.a.d[0] = 12.1;
    t.a.d[1] = 11.8;
    t.a.d[2] = 0.76;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.d[0] = t.a.d[1], t.a.d[2] = 1.0));
    refuse_negative(&t.a.d[0]);
    refuse_negative(&t.a.d[1]);
    refuse_correlations(2);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = t.a.d[1] = 1e200);

    begin("effective_volume", call_effective_volume);
    ARRAY(0, OUT, double, 1);
    t.a.d[0] = 60.5;
    t.a.d[1] = 7.3;
    t.a.u = 1;
    t.a.v = 2;
    refuse_pointers_and_lengths();
    refuse_not_positive(&t.a.d[0]);
    refuse_not_positive(&t.a.d[1]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.v = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1e200);

    begin("universality", call_universality);
    ARRAY(0, OUT, double, 1);
    ARRAY(1, OUT, double, 1);
    t.a.d[0] = 2.32;
    t.a.d[1] = 0.01;
    t.a.d[2] = 109.2;
    t.a.d[3] = 5.2;
    t.a.d[4] = -0.05;
    t.a.d[5] = 100.0;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.d[1] = t.a.d[3] = t.a.d[4] = 0.0);
    ACCEPTED(t.a.d[5] = -100.0);
    for (i = 0; i < 6; i++) {
        refuse_infinite(&t.a.d[i]);
    }
    refuse_negative(&t.a.d[1]);
    refuse_negative(&t.a.d[3]);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[4] = 0.0521);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[4] = -0.0521);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[5] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[5] = 1e-307);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[3] = 1e200);
}

static void refuse_controls(void) {
    enum { OF_CONTROLS = 3, MATCHES = 5 };
    fixpair_layout layout;
    double *y, *c, *mu, *error;
    int i;
    begin("control_variates_scratch", call_control_variates_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, MATCHES, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX / 16);

    MUST(fixpair_control_variates_scratch(&layout, MATCHES));
    begin("control_variates", call_control_variates);
    argument(0, OUT, OF_CONTROLS * sizeof(fixpair_control_variate), sizeof(double));
    y = numbers_at(1, OF_CONTROLS * MATCHES);
    c = numbers_at(2, OF_CONTROLS * MATCHES);
    mu = numbers_at(3, OF_CONTROLS);
    error = numbers_at(4, OF_CONTROLS);
    t.slots[4].optional = 1;
    SCRATCH_OF(5, layout.size);
    length(0, OF_CONTROLS, FREE);
    length(1, MATCHES, FREE);
    length(2, layout.size, SCRATCH);
    t.a.i[0] = FIXPAIR_BETA_OPTIMAL;
    t.a.d[0] = 1.0;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[4] = NULL);
    ACCEPTED(t.a.d[0] = (double)NAN);
    ACCEPTED((t.a.i[0] = FIXPAIR_BETA_GIVEN, t.a.n[1] = 2));
    refuse_infinite(y + 14);
    refuse_infinite(c + 14);
    refuse_infinite(mu + 2);
    refuse_negative(error + 2);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, (t.a.i[0] = FIXPAIR_BETA_GIVEN, t.a.d[0] = (double)NAN));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, (t.a.i[0] = FIXPAIR_BETA_GIVEN, t.a.d[0] = (double)INFINITY));
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[1] = 3);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, (t.a.i[0] = FIXPAIR_BETA_GIVEN, t.a.n[1] = 1));
    REFUSED(FIXPAIR_ERROR_RANGE, y[2] = 1e200);
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.i[0] = FIXPAIR_BETA_GIVEN, t.a.d[0] = 1e200));
    for (i = 0; i < 2; i++) {
        double *of = i ? y : c;
        /* The last value is the same in each sample. */
        REFUSED(FIXPAIR_ERROR_SINGULAR, of[2] = of[5] = of[8] = of[11] = of[14] = 1.0);
    }

    begin("control_variate_gain", call_control_variate_gain);
    ARRAY(0, OUT, double, 1);
    t.a.d[0] = 12.1;
    t.a.d[1] = 11.8;
    t.a.d[2] = 0.76;
    t.a.d[3] = 1.0;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.d[3] = -1.0);
    ACCEPTED(t.a.d[1] = 0.0);
    refuse_not_positive(&t.a.d[0]);
    refuse_negative(&t.a.d[1]);
    refuse_correlations(2);
    refuse_infinite(&t.a.d[3]);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, (t.a.d[1] = (double)INFINITY, t.a.d[3] = 0.0));
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[1] = -1.0, t.a.d[3] = 0.0));
    REFUSED(FIXPAIR_ERROR_RANGE, (t.a.d[0] = t.a.d[1], t.a.d[2] = 1.0));
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[3] = 1e308);

    begin("control_variate_loss", call_control_variate_loss);
    ARRAY(0, OUT, double, 1);
    t.a.u = 6;
    t.a.v = 3;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.u = 3, t.a.v = 0));
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 5);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.v = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = t.a.v = UINT64_MAX);
}

static void refuse_matrices(void) {
    enum { OF_MATRIX = 3, RUNS = 6, OF_Y = 2, OF_C = 2 };
    fixpair_layout layout;
    double *matrix, *y, *c, *mu, *of_mu;
    int i;
    begin("covariance_root_scratch", call_covariance_root_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, OF_MATRIX, FREE);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = 65537);

    MUST(fixpair_covariance_root_scratch(&layout, OF_MATRIX));
    begin("covariance_root", call_covariance_root);
    ARRAY(0, OUT, double, OF_MATRIX * OF_MATRIX);
    matrix = ARRAY(1, IN, double, OF_MATRIX * OF_MATRIX);
    SCRATCH_OF(2, layout.size);
    length(0, OF_MATRIX, FREE);
    length(1, layout.size, SCRATCH);
    for (i = 0; i < OF_MATRIX * OF_MATRIX; i++) {
        matrix[i] = i % (OF_MATRIX + 1) == 0 ? 2.0 : 1.0;
    }
    refuse_pointers_and_lengths();
    /* Rounding of sums of products is no asymmetry. */
    ACCEPTED(matrix[1] = 1.0 + 1e-12);
    for (i = 0; i < OF_MATRIX * OF_MATRIX; i++) {
        refuse_infinite(matrix + i);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, matrix[1] = 1.0 + 1e-6);
    REFUSED(FIXPAIR_ERROR_RANGE, matrix[7] = -1.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, matrix[8] = 0.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, matrix[4] = -2.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, matrix[0] = matrix[4] = matrix[8] = 1.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, matrix[1] = matrix[3] = 3.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, matrix[1] = matrix[3] = 2.0);

    begin("carpool_scratch", call_carpool_scratch);
    STRUCT(0, OUT, fixpair_layout);
    length(0, OF_Y, FREE);
    length(1, OF_C, FREE);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = 65537);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = 65537);

    MUST(fixpair_carpool_scratch(&layout, OF_Y, OF_C));
    begin("carpool", call_carpool);
    ARRAY(0, OUT, double, OF_Y);
    ARRAY(1, OUT, double, OF_Y * OF_Y);
    ARRAY(2, OUT, double, OF_Y * OF_C);
    y = numbers_at(3, RUNS * OF_Y);
    c = numbers_at(4, RUNS * OF_C);
    mu = numbers_at(5, OF_C);
    of_mu = ARRAY(6, IN, double, OF_C * OF_C);
    t.slots[6].optional = 1;
    of_mu[0] = of_mu[3] = 0.01;
    SCRATCH_OF(7, layout.size);
    length(0, RUNS, FREE);
    length(1, OF_Y, FREE);
    length(2, OF_C, FREE);
    length(3, layout.size, SCRATCH);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.p[6] = NULL);
    ACCEPTED(t.a.n[0] = OF_C + 3);
    for (i = 0; i < RUNS * OF_Y; i++) {
        refuse_infinite(y + i);
        refuse_infinite(c + i);
    }
    refuse_infinite(mu + 1);
    refuse_infinite(of_mu);
    refuse_infinite(of_mu + 1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[2] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = OF_C + 2);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, y[3] = 1.1e140);
    REFUSED(FIXPAIR_ERROR_RANGE, c[3] = -1.1e140);
    REFUSED(FIXPAIR_ERROR_RANGE, mu[0] = 1.1e140);
    REFUSED(FIXPAIR_ERROR_RANGE, of_mu[1] = 0.005);
    REFUSED(FIXPAIR_ERROR_SINGULAR, of_mu[3] = 0.0);
    REFUSED(FIXPAIR_ERROR_SINGULAR, (t.a.p[6] = NULL, memset(c, 0, RUNS * OF_C * sizeof *c)));
    restore();
    for (i = 0; i < RUNS; i++) {
        c[OF_C * i + 1] = 3.0 * c[OF_C * i];
    }
    memcpy(t.pristine, t.memory, ARENA);
    REFUSED(FIXPAIR_ERROR_SINGULAR, t.a.p[6] = NULL);
}

static void refuse_matched(void) {
    refuse_differences();
    refuse_controls();
    refuse_matrices();
}
