#include "spectrum.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

int spectrum_open(struct spectrum *spectrum, MPI_Comm comm, const struct fixpair_brick *modes) {
    struct fixpair_layout layout;
    size_t bins, values;
    memset(spectrum, 0, sizeof *spectrum);
    spectrum->comm = comm;
    spectrum->modes = *modes;
    spectrum->shells = modes->n / 2 - 1;
    if ((spectrum->edges = calloc(spectrum->shells + 1, sizeof *spectrum->edges)) == NULL) return 1;
    TRY(fixpair_edges_uniform(spectrum->edges, spectrum->shells + 1, 1.0, 1.0));
    TRY(fixpair_binning_init(&spectrum->binning, spectrum->edges, spectrum->shells + 1));
    TRY(fixpair_binning_lengths(&bins, &values, &spectrum->words, &spectrum->binning, 1));
    TRY(fixpair_power_sums_scratch(&layout, modes, &spectrum->binning, 1));
    spectrum->bins = calloc(bins, sizeof *spectrum->bins);
    spectrum->sums = calloc(spectrum->words, sizeof *spectrum->sums);
    spectrum->scratch_len = layout.size;
    spectrum->scratch = memory_take(layout);
    spectrum->power = memory_take_doubles(values);
    return spectrum->bins == NULL || spectrum->sums == NULL || spectrum->scratch == NULL || spectrum->power == NULL;
}

void spectrum_close(struct spectrum *spectrum) {
    free(spectrum->edges);
    free(spectrum->bins);
    free(spectrum->sums);
    free(spectrum->scratch);
    free(spectrum->power);
    memset(spectrum, 0, sizeof *spectrum);
}

int spectrum_measure(struct spectrum *spectrum, const double *modes, size_t len, int32_t compensation, double factor) {
    static const size_t itself[] = {0, 0};
    size_t shells = spectrum->shells;
    memset(spectrum->sums, 0, spectrum->words * sizeof *spectrum->sums);
    TRY(fixpair_power_sums_f64(spectrum->sums, spectrum->words, &modes, 1, len, itself, 1, &compensation, &spectrum->modes,
                               &spectrum->binning, spectrum->scratch, spectrum->scratch_len, NULL));
    MPI_Allreduce(MPI_IN_PLACE, spectrum->sums, (int)spectrum->words, MPI_INT64_T, MPI_SUM, spectrum->comm);
    TRY(fixpair_binning_read(spectrum->bins, shells, spectrum->power, shells, spectrum->sums, spectrum->words, &spectrum->binning, 1));
    TRY(fixpair_binning_normalise(spectrum->power, shells, spectrum->bins, shells, spectrum->binning.orders, factor));
    return 0;
}
