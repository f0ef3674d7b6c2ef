/*
 * The part of refusals.c about ensembles and resampling.
 */

CALL(ensemble_length, (P(0), L(0), a->i[0]))
CALL(ensemble_init, (P(0), L(0), L(1), a->i[0]))
CALL(ensemble_add, (P(0), L(0), P(1), L(1)))
CALL(ensemble_merge, (P(0), L(0), P(1)))
CALL(ensemble_count, (P(0), P(1), L(0)))
CALL(ensemble_mean, (P(0), L(0), P(1), L(1)))
CALL(ensemble_deviation, (P(0), L(0), P(1), L(1)))
CALL(ensemble_error_of_mean, (P(0), L(0), P(1), L(1)))
CALL(ensemble_covariance, (P(0), L(0), L(1), P(1), L(2), L(3), L(4)))
CALL(ensemble_correlation, (P(0), L(0), L(1), P(1), L(2), L(3), L(4)))
CALL(pair_average, (P(0), P(1), P(2), L(0)))
CALL(sigma_per_simulation, (P(0), P(1), P(2), L(0), a->u, a->v))
CALL(bootstrap_indices, (P(0), L(0), a->u, a->v, a->w))
CALL(resampled_mean, (P(0), L(0), P(1), L(1), P(2), L(2)))
CALL(jackknife_means, (P(0), P(1), L(0), L(1)))
CALL(jackknife, (P(0), P(1), P(2), L(0), P(3), L(1)))
CALL(jackknife_covariance, (P(0), P(1), L(0), L(1)))

static void refuse_infinite(double *value) {
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, *value = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, *value = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, *value = -(double)INFINITY);
}

static void refuse_negative(double *value) {
    refuse_infinite(value);
    REFUSED(FIXPAIR_ERROR_RANGE, *value = -1e-3);
}

static void refuse_not_positive(double *value) {
    refuse_negative(value);
    REFUSED(FIXPAIR_ERROR_RANGE, *value = 0.0);
}

/* An array that is read, of numbers from 1 to 2 that vary. */
static double *numbers_at(int pointer, size_t count) {
    double *values = ARRAY(pointer, IN, double, count);
    size_t i;
    for (i = 0; i < count; i++) {
        /* Squares: multiples alone would make columns that are combinations of others. */
        values[i] = 1.5 + 0.5 * noise(17 * i * i + 1000 * (size_t)pointer);
    }
    return values;
}

/* Values of a sample, and numbers of a state for samples of five with covariance, or of ten without. */
enum { OF_SAMPLE = 5, OF_STATE = 23 };

/* A state of `samples` samples. */
static double *state_at(int pointer, role role, size_t samples) {
    double *state = ARRAY(pointer, role, double, OF_STATE), sample[OF_SAMPLE];
    size_t i, j;
    MUST(fixpair_ensemble_init(state, OF_STATE, OF_SAMPLE, FIXPAIR_MOMENTS_COVARIANCE));
    for (i = 0; i < samples; i++) {
        for (j = 0; j < OF_SAMPLE; j++) {
            sample[j] = noise(7 * i + j);
        }
        MUST(fixpair_ensemble_add(state, OF_STATE, sample, OF_SAMPLE));
    }
    return state;
}

/* Of ten variances in as much memory. */
static void become_variances(double *state) {
    int i;
    for (i = 0; i < OF_STATE; i++) {
        state[i] = 3.0;
    }
    state[1] = 10.0;
    state[2] = 0.0;
}

/* The state, whose length is n[of]. */
static void refuse_states(double *state, int of, int read) {
    int i;
    for (i = 0; i < 3; i++) {
        REFUSED(FIXPAIR_ERROR_VERSION, state[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_VERSION, state[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_VERSION, state[i] = -1.0);
        REFUSED(FIXPAIR_ERROR_VERSION, state[i] = 0.5);
        REFUSED(FIXPAIR_ERROR_VERSION, state[i] = 1e300);
    }
    REFUSED(FIXPAIR_ERROR_VERSION, state[1] = OF_SAMPLE - 1);
    REFUSED(FIXPAIR_ERROR_VERSION, state[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_VERSION, state[2] = 0.0);
    REFUSED(FIXPAIR_ERROR_VERSION, memset(state, 0, OF_STATE * sizeof *state));
    if (of >= 0) {
        REFUSED(FIXPAIR_ERROR_VERSION, t.a.n[of] = OF_STATE - 1);
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[of] = 2);
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[of] = 0);
    }
    if (read) {
        REFUSED(FIXPAIR_ERROR_VERSION, state[OF_STATE - 1] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_VERSION, state[OF_STATE - 1] = -1.0);
        REFUSED(FIXPAIR_ERROR_VERSION, state[3] = (double)INFINITY);
    }
}

static void refuse_ensembles(void) {
    static const call_function reads[3] = {call_ensemble_mean, call_ensemble_deviation, call_ensemble_error_of_mean};
    static const char *const names[3] = {"ensemble_mean", "ensemble_deviation", "ensemble_error_of_mean"};
    double *state, *other, *samples;
    int which;
    begin("ensemble_length", call_ensemble_length);
    ARRAY(0, OUT, size_t, 1);
    length(0, OF_SAMPLE, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.i[0] = FIXPAIR_MOMENTS_COVARIANCE);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX / 16);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, (t.a.i[0] = FIXPAIR_MOMENTS_COVARIANCE, t.a.n[0] = SIZE_MAX));
    REFUSED(FIXPAIR_ERROR_OVERFLOW, (t.a.i[0] = FIXPAIR_MOMENTS_COVARIANCE, t.a.n[0] = (size_t)1 << (sizeof(size_t) * 4)));

    begin("ensemble_init", call_ensemble_init);
    ARRAY(0, OUT, double, OF_STATE);
    length(0, OF_STATE, EXACT);
    length(1, OF_SAMPLE, EXACT);
    t.a.i[0] = FIXPAIR_MOMENTS_COVARIANCE;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.i[0] = FIXPAIR_MOMENTS_VARIANCE, t.a.n[1] = 10));
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.i[0] = FIXPAIR_MOMENTS_VARIANCE);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = INT32_MIN);

    begin("ensemble_add", call_ensemble_add);
    state = state_at(0, OUT, 3);
    samples = numbers_at(1, 2 * OF_SAMPLE);
    length(0, OF_STATE, FREE);
    length(1, 2 * OF_SAMPLE, EXACT);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[1] = 0, t.a.p[1] = NULL));
    refuse_states(state, 0, 0);
    refuse_infinite(samples + 9);
    REFUSED(FIXPAIR_ERROR_RANGE, samples[9] = 1.1e140);
    REFUSED(FIXPAIR_ERROR_RANGE, samples[0] = -1.1e140);

    begin("ensemble_merge", call_ensemble_merge);
    state = state_at(0, OUT, 3);
    other = state_at(1, IN, 2);
    length(0, OF_STATE, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED(other[0] = 0.0);
    refuse_states(state, 0, 0);
    refuse_states(other, -1, 1);
    REFUSED(FIXPAIR_ERROR_LENGTH, become_variances(other));

    begin("ensemble_count", call_ensemble_count);
    ARRAY(0, OUT, uint64_t, 1);
    state = state_at(1, IN, 3);
    length(0, OF_STATE, FREE);
    refuse_pointers_and_lengths();
    refuse_states(state, 0, 1);
    for (which = 0; which < 3; which++) {
        begin(names[which], reads[which]);
        ARRAY(0, OUT, double, OF_SAMPLE);
        state = state_at(1, IN, 3);
        length(0, OF_SAMPLE, EXACT);
        length(1, OF_STATE, FREE);
        refuse_pointers_and_lengths();
        refuse_states(state, 1, 1);
        REFUSED(FIXPAIR_ERROR_SAMPLES, state[0] = 0.0);
        if (which > 0) {
            REFUSED(FIXPAIR_ERROR_SAMPLES, state[0] = 1.0);
        } else {
            ACCEPTED(state[0] = 1.0);
        }
    }
    for (which = 0; which < 2; which++) {
        begin(which ? "ensemble_correlation" : "ensemble_covariance",
              which ? call_ensemble_correlation : call_ensemble_covariance);
        ARRAY(0, OUT, double, 6);
        state = state_at(1, IN, 3);
        length(0, 2, FREE);
        length(1, 3, FREE);
        length(2, OF_STATE, FREE);
        t.a.n[4] = 2;
        refuse_pointers_and_lengths();
        ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL));
        refuse_states(state, 2, 1);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[3] = OF_SAMPLE - 1);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[3] = SIZE_MAX);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[4] = 3);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[4] = SIZE_MAX);
        REFUSED(FIXPAIR_ERROR_SAMPLES, state[0] = 1.0);
        REFUSED(FIXPAIR_ERROR_CHOICE, become_variances(state));
        if (which) {
            REFUSED(FIXPAIR_ERROR_SINGULAR, state[3 + OF_SAMPLE] = 0.0);
        }
    }
    begin("pair_average", call_pair_average);
    ARRAY(0, OUT, double, 3);
    numbers_at(1, 3);
    numbers_at(2, 3);
    length(0, 3, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = t.a.p[1] = t.a.p[2] = NULL));
    refuse_infinite((double *)t.good.p[1] + 2);
    refuse_infinite((double *)t.good.p[2]);

    begin("sigma_per_simulation", call_sigma_per_simulation);
    ARRAY(0, OUT, double, 3);
    ARRAY(1, OUT, double, 3);
    samples = numbers_at(2, 3);
    length(0, 3, FREE);
    t.a.u = 41;
    t.a.v = 2;
    refuse_pointers_and_lengths();
    ACCEPTED(samples[1] = 0.0);
    refuse_negative(samples + 2);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.v = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, samples[2] = 1.5e308);
}

/* Rows and values of tables of estimates. */
enum { OF_TABLE = 4, OF_ROW = 3 };

static void refuse_resampling(void) {
    double *samples, *whole;
    uint64_t *indices;
    int which;
    begin("bootstrap_indices", call_bootstrap_indices);
    ARRAY(0, OUT, uint64_t, 5);
    length(0, 5, FREE);
    t.a.u = 12;
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL));
    ACCEPTED(t.a.u = t.a.v = t.a.w = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.u = 0);

    begin("resampled_mean", call_resampled_mean);
    ARRAY(0, OUT, double, OF_ROW);
    samples = numbers_at(1, OF_TABLE * OF_ROW);
    indices = ARRAY(2, IN, uint64_t, 5);
    length(0, OF_ROW, FREE);
    length(1, OF_TABLE, FREE);
    length(2, 5, FREE);
    indices[3] = 1;
    refuse_pointers_and_lengths();
    refuse_infinite(samples + 11);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[2] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, indices[4] = OF_TABLE);
    REFUSED(FIXPAIR_ERROR_RANGE, indices[0] = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, samples[1] = DBL_MAX);

    for (which = 0; which < 2; which++) {
        begin(which ? "jackknife_covariance" : "jackknife_means", which ? call_jackknife_covariance : call_jackknife_means);
        ARRAY(0, OUT, double, which ? OF_ROW * OF_ROW : OF_TABLE * OF_ROW);
        samples = numbers_at(1, OF_TABLE * OF_ROW);
        length(0, OF_TABLE, FREE);
        length(1, OF_ROW, FREE);
        refuse_pointers_and_lengths();
        refuse_infinite(samples + 11);
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 0);
        REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 1);
        REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[0] = 0);
        REFUSED(FIXPAIR_ERROR_RANGE, samples[0] = samples[3] = 1.5e308);
        /* The sum of all is finite, that without the second is not. */
        REFUSED(FIXPAIR_ERROR_RANGE, (samples[0] = samples[6] = 1.5e308, samples[3] = -1.5e308));
    }
    begin("jackknife", call_jackknife);
    ARRAY(0, OUT, double, OF_ROW);
    ARRAY(1, OUT, double, OF_ROW);
    whole = numbers_at(2, OF_ROW);
    samples = numbers_at(3, OF_TABLE * OF_ROW);
    length(0, OF_ROW, FREE);
    length(1, OF_TABLE, FREE);
    refuse_pointers_and_lengths();
    refuse_infinite(whole + 2);
    refuse_infinite(samples + 11);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[1] = 1);
    REFUSED(FIXPAIR_ERROR_SAMPLES, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, whole[2] = 1e308);
    REFUSED(FIXPAIR_ERROR_RANGE, samples[5] = 1e200);
}
