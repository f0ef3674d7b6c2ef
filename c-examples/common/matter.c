#include "matter.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "linear.h"
#include "memory.h"

#define TWO_PI 6.283185307179586

enum { WINDOW = FIXPAIR_WINDOW_TSC };

int matter_open(struct matter *matter, const struct fixpair_fft_f32 *fft, size_t particles, const struct fixpair_exec *exec) {
    struct fixpair_layout deposit, sums;
    size_t bins, values;
    memset(matter, 0, sizeof *matter);
    matter->fft = fft;
    matter->exec = exec;
    matter->shells = fft->fourier.n / 4;
    matter->edges = calloc(matter->shells + 1, sizeof *matter->edges);
    if (matter->edges == NULL) return 1;
    TRY(fixpair_edges_uniform(matter->edges, matter->shells + 1, 1.0, 1.0));
    TRY(fixpair_binning_init(&matter->binning, matter->edges, matter->shells + 1));
    TRY(fixpair_binning_lengths(&bins, &values, &matter->words, &matter->binning, 1));
    matter->bins = calloc(bins, sizeof *matter->bins);
    matter->sums = calloc(matter->words, sizeof *matter->sums);
    if (matter->bins == NULL || matter->sums == NULL) return 1;

    TRY(fixpair_deposit_scratch_f32(&deposit, &fft->configuration, particles, WINDOW));
    TRY(fixpair_power_sums_scratch(&sums, &fft->fourier, &matter->binning, 1));
    if (deposit.size < sums.size) deposit.size = sums.size;
    matter->scratch_len = deposit.size;
    if ((matter->scratch = memory_take(deposit)) == NULL) return 1;
    if ((matter->mesh = memory_take_floats(fft->length)) == NULL) return 1;
    if ((matter->shifted = memory_take_floats(fft->length)) == NULL) return 1;
    if ((matter->k = memory_take_doubles(3 * matter->shells)) == NULL) return 1;
    matter->power = matter->k + matter->shells;
    matter->theory = matter->power + matter->shells;
    return 0;
}

void matter_close(struct matter *matter) {
    free(matter->edges);
    free(matter->bins);
    free(matter->sums);
    free(matter->mesh);
    free(matter->shifted);
    free(matter->scratch);
    free(matter->k);
    memset(matter, 0, sizeof *matter);
}

/* Modes of the number of particles in cells that begin `shift` of a cell further on. */
static int deposit(struct matter *matter, float *mesh, const struct fixpair_positions_f32 *position, double box_size, double shift) {
    const struct fixpair_fft_f32 *fft = matter->fft;
    memset(mesh, 0, fft->length * sizeof *mesh);
    TRY(fixpair_deposit_f32(mesh, fft->length, &fft->configuration, position, NULL, 0, box_size, WINDOW, shift, matter->scratch,
                            matter->scratch_len, matter->exec));
    if (fft->forward(fft->context, mesh) == 0) return 0;
    fprintf(stderr, "the transform failed\n");
    return 1;
}

int matter_measure(struct matter *matter, const struct fixpair_positions_f32 *position, const struct fixpair_conditions *conditions) {
    static const size_t itself[] = {0, 0};
    static const int32_t compensation = FIXPAIR_COMPENSATION_WINDOW + WINDOW;
    const struct fixpair_fft_f32 *fft = matter->fft;
    const float *field = matter->mesh;
    double box_size = conditions->box_size, particles = (double)position->length;
    size_t shells = matter->shells;
    TRY(deposit(matter, matter->mesh, position, box_size, 0.0));
    TRY(deposit(matter, matter->shifted, position, box_size, 0.5));
    TRY(fixpair_interlace_f32(matter->mesh, matter->shifted, fft->length, &fft->fourier, matter->exec));
    memset(matter->sums, 0, matter->words * sizeof *matter->sums);
    TRY(fixpair_power_sums_f32(matter->sums, matter->words, &field, 1, fft->length, itself, 1, &compensation, &fft->fourier,
                               &matter->binning, matter->scratch, matter->scratch_len, matter->exec));
    TRY(fixpair_binning_read(matter->bins, shells, matter->power, shells, matter->sums, matter->words, &matter->binning, 1));
    TRY(fixpair_binning_normalise(matter->power, shells, matter->bins, shells, matter->binning.orders,
                                  pow(box_size, 3.0) / (particles * particles)));
    for (size_t b = 0; b < shells; b++) matter->k[b] = TWO_PI / box_size * matter->bins[b].first;
    return linear_theory(matter->theory, matter->edges, shells + 1, conditions);
}

int matter_write(const struct matter *matter, const char *path) {
    FILE *stream = fopen(path, "w");
    int failed = stream == NULL;
    if (!failed) {
        fprintf(stream, "# 1: k [h/Mpc]  2: modes  3, 4: P, P of linear theory [(Mpc/h)^3]\n");
        for (size_t b = 0; b < matter->shells; b++) {
            fprintf(stream, "%9.6f %9llu %14.7g %14.7g\n", matter->k[b], (unsigned long long)matter->bins[b].count, matter->power[b],
                    matter->theory[b]);
        }
        failed |= ferror(stream);
        failed |= fclose(stream) != 0;
    }
    if (failed) fprintf(stderr, "%s: %s\n", path, strerror(errno));
    return failed;
}
