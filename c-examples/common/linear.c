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

    TRY(fixpair_mode_table_length(&linear->length, linear->n));
    TRY(fixpair_add_local_scratch_f64(&local, fine));
    TRY(fixpair_power_sums_scratch(&sums, &fft->fourier, linear->edges, linear->shells + 1));
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
    struct fixpair_bin *bins = malloc(linear->shells * sizeof *bins);
    if (bins == NULL) return 1;
    fixpair_status_t status =
        fixpair_power_sums_f64(bins, linear->shells, linear->edges, linear->shells + 1, modes, NULL, linear->fft->length,
                               &linear->fft->fourier, linear->scratch, linear->scratch_len, linear->exec);
    for (size_t b = 0; status == FIXPAIR_OK && b < linear->shells; b++) {
        k[b] = TWO_PI / box_size * bins[b].wavenumber / (double)bins[b].modes;
        power[b] = pow(box_size, 3.0) * bins[b].power / (double)bins[b].modes;
    }
    free(bins);
    TRY(status);
    return 0;
}

/* How many modes there are of each |n|^2 below (n/2)^2. */
static void count_modes(double *count, long half) {
    for (long i = 1 - half; i < half; i++) {
        for (long j = 1 - half; j < half; j++) {
            for (long l = 1 - half; l < half; l++) {
                long square = i * i + j * j + l * l;
                if (square < half * half) count[square] += 1.0;
            }
        }
    }
}

/* The three arrays have an element for each |n|^2 below (n/2)^2. */
static int average_theory(struct linear *linear, const struct fixpair_conditions *conditions, double *average, double *k,
                          double *power, double *count) {
    size_t half = linear->n / 2;
    for (size_t square = 1; square < half * half; square++) k[square] = TWO_PI / conditions->box_size * sqrt((double)square);
    TRY(fixpair_linear_power(power + 1, k + 1, half * half - 1, &conditions->cosmology, &conditions->linear,
                             conditions->redshift));
    count_modes(count, (long)half);
    for (size_t b = 0; b < linear->shells; b++) {
        double modes = 0.0, sum = 0.0;
        for (size_t square = linear->edges[b]; square < linear->edges[b + 1]; square++) {
            modes += count[square];
            sum += count[square] * power[square];
        }
        average[b] = sum / modes;
    }
    return 0;
}

int linear_theory(struct linear *linear, const struct fixpair_conditions *conditions, double *power) {
    size_t squares = linear->n / 2 * (linear->n / 2);
    double *k = memory_take_doubles(squares), *each = memory_take_doubles(squares), *count = memory_take_doubles(squares);
    int outcome = k == NULL || each == NULL || count == NULL || average_theory(linear, conditions, power, k, each, count) != 0;
    free(k);
    free(each);
    free(count);
    return outcome;
}
