#include "linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

#define TWO_PI 6.283185307179586

int linear_open(struct linear *linear, const struct fixpair_fft_f64 *fft, const struct fixpair_fft_f64 *fine,
                const struct fixpair_exec *exec) {
    struct fixpair_layout local, sums, larger;
    memset(linear, 0, sizeof *linear);
    linear->fft = fft;
    linear->fine = fine;
    linear->exec = exec;
    linear->n = fft->fourier.n;
    linear->shells = linear->n / 2 - 1;
    linear->edges = malloc((linear->shells + 1) * sizeof *linear->edges);
    if (linear->edges == NULL) return 1;
    for (uint64_t b = 0; b <= linear->shells; b++) linear->edges[b] = (b + 1) * (b + 1);

    size_t bins, values;
    TRY(fixpair_binning_init(&linear->binning, linear->edges, linear->shells + 1));
    TRY(fixpair_binning_lengths(&bins, &values, &linear->words, &linear->binning, 1));
    linear->bins = malloc(bins * sizeof *linear->bins);
    linear->sums = malloc(linear->words * sizeof *linear->sums);
    if (linear->bins == NULL || linear->sums == NULL) return 1;

    TRY(fixpair_mode_table_length(&linear->length, linear->n));
    TRY(fixpair_add_local_scratch_f64(&local, fine));
    TRY(fixpair_power_sums_scratch(&sums, &fft->fourier, &linear->binning, 1));
    larger.size = local.size > sums.size ? local.size : sums.size;
    larger.align = local.align > sums.align ? local.align : sums.align;
    linear->scratch_len = larger.size;
    linear->scratch = memory_take(larger);
    linear->factor = memory_take_doubles(linear->length);
    linear->work = memory_take_doubles(fine->length);
    return linear->scratch == NULL || linear->factor == NULL || linear->work == NULL;
}

void linear_close(struct linear *linear) {
    free(linear->edges);
    free(linear->bins);
    free(linear->sums);
    free(linear->scratch);
    free(linear->factor);
    free(linear->work);
    memset(linear, 0, sizeof *linear);
}

int linear_density(struct linear *linear, const struct fixpair_conditions *conditions, double *modes) {
    const struct fixpair_brick *brick = &linear->fft->fourier;
    size_t len = linear->fft->length;
    TRY(fixpair_potential_amplitude_table(linear->factor, linear->length, linear->n, conditions->box_size,
                                          &conditions->cosmology, &conditions->linear, conditions->convention, linear->exec));
    TRY(fixpair_white_modes_f64(modes, len, brick, &conditions->realisation, linear->factor, linear->length, linear->exec));
    TRY(fixpair_add_local_f64(modes, len, brick, conditions->f_nl, conditions->g_nl, linear->fine, linear->work,
                              linear->fine->length, linear->scratch, linear->scratch_len, linear->exec));
    TRY(fixpair_alpha_table(linear->factor, linear->length, linear->n, conditions->box_size, &conditions->cosmology,
                            &conditions->linear, conditions->redshift, conditions->convention, linear->exec));
    TRY(fixpair_scale_modes_f64(modes, len, brick, linear->factor, linear->length, linear->exec));
    return 0;
}

int linear_measure(struct linear *linear, double box_size, const double *modes, double *k, double *power) {
    static const size_t pair[] = {0, 0};
    /* The mean alone: as many values as bins. */
    size_t shells = linear->shells;
    memset(linear->sums, 0, linear->words * sizeof *linear->sums);
    TRY(fixpair_power_sums_f64(linear->sums, linear->words, &modes, 1, linear->fft->length, pair, 1, NULL, &linear->fft->fourier,
                               &linear->binning, linear->scratch, linear->scratch_len, linear->exec));
    TRY(fixpair_binning_read(linear->bins, shells, power, shells, linear->sums, linear->words, &linear->binning, 1));
    TRY(fixpair_binning_normalise(power, shells, linear->bins, shells, linear->binning.orders, pow(box_size, 3.0)));
    for (size_t b = 0; b < shells; b++) k[b] = TWO_PI / box_size * linear->bins[b].first;
    return 0;
}

/* How many modes there are of each |n|^2 < end. */
static void count_modes(double *count, long end) {
    long most = (long)sqrt((double)end) + 1;
    for (long i = -most; i <= most; i++) {
        for (long j = -most; j <= most; j++) {
            for (long l = -most; l <= most; l++) {
                long square = i * i + j * j + l * l;
                if (square < end) count[square] += 1.0;
            }
        }
    }
}

int linear_average(double *average, const double *values, const uint64_t *edges, size_t edges_len) {
    double *count = memory_take_doubles((size_t)edges[edges_len - 1]);
    if (count == NULL) return 1;
    count_modes(count, (long)edges[edges_len - 1]);
    for (size_t s = 0; s + 1 < edges_len; s++) {
        double modes = 0.0, sum = 0.0;
        for (size_t square = (size_t)edges[s]; square < edges[s + 1]; square++) {
            modes += count[square];
            sum += count[square] * values[square];
        }
        average[s] = sum / modes;
    }
    free(count);
    return 0;
}

int linear_theory(double *power, const uint64_t *edges, size_t edges_len, const struct fixpair_conditions *conditions) {
    size_t squares = (size_t)edges[edges_len - 1];
    double *k = memory_take_doubles(squares), *each = memory_take_doubles(squares);
    int32_t outcome = 1;
    if (k != NULL && each != NULL) {
        for (size_t square = 1; square < squares; square++) k[square] = TWO_PI / conditions->box_size * sqrt((double)square);
        outcome = fixpair_linear_power(each + 1, k + 1, squares - 1, &conditions->cosmology, &conditions->linear, conditions->redshift);
        if (outcome == 0) outcome = linear_average(power, each, edges, edges_len);
    }
    free(k);
    free(each);
    TRY(outcome);
    return 0;
}
