#include "spectra.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

#define PI 3.141592653589793

enum { MULTIPOLES = 3, P_0_2_4 = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4, MESHES = 3 };

/* The auto spectrum of the only field. */
static const size_t itself[] = {0, 0};

/* ---- The hook of the transform is the place to see how far a long call is: two deposits and a transform a shell. */

static void say(struct spectra *spectra) {
    size_t all = spectra->wide.count + (spectra->choice.interlaced ? 2 : 1);
    time_t now = time(NULL);
    spectra->transforms++;
    if (spectra->choice.progress == NULL || now < spectra->said + 2) return;
    spectra->said = now;
    fprintf(spectra->choice.progress, "    transform %lu of %lu\n", (unsigned long)spectra->transforms, (unsigned long)all);
}

static int32_t forward(void *context, double *data) {
    struct spectra *spectra = context;
    say(spectra);
    return spectra->fft.hook.forward(spectra->fft.hook.context, data);
}

static int32_t inverse(void *context, double *data) {
    struct spectra *spectra = context;
    say(spectra);
    return spectra->fft.hook.inverse(spectra->fft.hook.context, data);
}

/* ---- Memory. */

static int shells_open(struct spectra_shells *shells, size_t count, double first, double width, uint32_t orders) {
    size_t bins;
    shells->count = count;
    if ((shells->edges = calloc(count + 1, sizeof *shells->edges)) == NULL) return 1;
    TRY(fixpair_edges_uniform(shells->edges, count + 1, first, width));
    TRY(fixpair_binning_init(&shells->binning, shells->edges, count + 1));
    shells->binning.orders = orders;
    TRY(fixpair_binning_lengths(&bins, &shells->values, &shells->words, &shells->binning, 1));
    shells->bins = calloc(bins, sizeof *shells->bins);
    shells->sums = calloc(shells->words, sizeof *shells->sums);
    return shells->bins == NULL || shells->sums == NULL;
}

static void shells_close(struct spectra_shells *shells) {
    free(shells->edges);
    free(shells->bins);
    free(shells->sums);
}

static void enlarge(size_t *size, struct fixpair_layout layout) {
    if (*size < layout.size) *size = layout.size;
}

/* One piece of scratch for whatever runs: nothing is left in it. */
static int take_scratch(struct spectra *spectra) {
    const struct fixpair_fft_f64 *fft = &spectra->hook;
    struct fixpair_layout layout;
    size_t wide = spectra->wide.count;
    /* The scratch of a deposit grows up to 2^21 particles. */
    TRY(fixpair_deposit_scratch_f64(&layout, &fft->configuration, (size_t)1 << 21, spectra->choice.window));
    enlarge(&spectra->scratch_len, layout);
    TRY(fixpair_power_sums_scratch(&layout, &fft->fourier, &spectra->narrow.binning, 1));
    enlarge(&spectra->scratch_len, layout);
    TRY(fixpair_power_sums_scratch(&layout, &fft->fourier, &spectra->wide.binning, 1));
    enlarge(&spectra->scratch_len, layout);
    TRY(fixpair_compensate_scratch(&layout, &fft->fourier));
    enlarge(&spectra->scratch_len, layout);
    TRY(fixpair_triangle_counts_scratch(&layout, spectra->triangles, wide, spectra->wide.edges, wide + 1, spectra->choice.n));
    enlarge(&spectra->scratch_len, layout);
    TRY(fixpair_bispectrum_scratch_f64(&layout, fft, wide, wide));
    enlarge(&spectra->scratch_len, layout);
    layout.size = spectra->scratch_len;
    spectra->scratch = memory_take(layout);
    return spectra->scratch == NULL;
}

int spectra_open(struct spectra *spectra, const struct spectra_choice *choice, const struct fixpair_exec *exec) {
    double n = (double)choice->n, highest = choice->highest * choice->box_size / (2.0 * PI), width = choice->width;
    memset(spectra, 0, sizeof *spectra);
    spectra->choice = *choice;
    spectra->exec = exec;
    /* Shells end below the Nyquist frequency. Triangles are free of aliasing if n is at least the sum of their upper edges, 1.5 w and
       twice (count + 1/2) w. */
    double narrow = floor(fmin(highest, n / 2.0) + 1e-9) - 1.0;
    double wide = floor(fmin(fmin(highest, n / 2.0) / width - 0.5, (n / width - 2.5) / 2.0) + 1e-9);
    if (!(narrow >= 1.0 && wide >= 1.0)) {
        fprintf(stderr, "no shell fits: a mesh of more cells, a higher k or narrower shells are needed\n");
        return 1;
    }
    TRY(shells_open(&spectra->narrow, (size_t)narrow, 1.0, 1.0, P_0_2_4));
    TRY(shells_open(&spectra->wide, (size_t)wide, width / 2.0, width, FIXPAIR_MULTIPOLE_0));
    size_t triangles = spectra->wide.count;
    spectra->triangles = calloc(3 * triangles, sizeof *spectra->triangles);
    spectra->counts = calloc(triangles, sizeof *spectra->counts);
    spectra->triangle_sums = calloc(FIXPAIR_BISPECTRUM_WORDS * triangles, sizeof *spectra->triangle_sums);
    if (spectra->triangles == NULL || spectra->counts == NULL || spectra->triangle_sums == NULL) return 1;
    TRY(fixpair_squeezed_triangles(spectra->triangles, triangles, 0, triangles));

    TRY(transform_open(&spectra->fft, choice->n, exec));
    spectra->hook = spectra->fft.hook;
    spectra->hook.context = spectra;
    spectra->hook.forward = forward;
    spectra->hook.inverse = inverse;
    TRY(fixpair_bispectrum_meshes_f64(&spectra->fields_len, &spectra->hook, MESHES));
    if ((spectra->mesh = memory_take_doubles(spectra->hook.length)) == NULL) return 1;
    if ((spectra->fields = memory_take_doubles(spectra->fields_len)) == NULL) return 1;
    return take_scratch(spectra);
}

void spectra_close(struct spectra *spectra) {
    transform_close(&spectra->fft);
    shells_close(&spectra->narrow);
    shells_close(&spectra->wide);
    free(spectra->triangles);
    free(spectra->counts);
    free(spectra->triangle_sums);
    free(spectra->mesh);
    free(spectra->fields);
    free(spectra->scratch);
    memset(spectra, 0, sizeof *spectra);
}

/* ---- Counts of triangles. */

int spectra_count(struct spectra *spectra) {
    const struct spectra_shells *wide = &spectra->wide;
    TRY(fixpair_triangle_counts(spectra->counts, spectra->triangles, wide->count, wide->edges, wide->count + 1, spectra->choice.n,
                                spectra->scratch, spectra->scratch_len, spectra->exec));
    return 0;
}

/* What counts belong to, number by number: a mark, the side, the shells, the triangles. */
static uint64_t geometry(const struct spectra *spectra, size_t index) {
    const struct spectra_shells *wide = &spectra->wide;
    uint64_t before[3] = {UINT64_C(0x73656c676e616972), spectra->choice.n, wide->count};
    if (index < 3) return before[index];
    return index < 4 + wide->count ? wide->edges[index - 3] : spectra->triangles[index - 4 - wide->count];
}

int spectra_save_counts(const struct spectra *spectra, const char *path) {
    size_t shells = spectra->wide.count;
    FILE *stream = fopen(path, "wb");
    if (stream != NULL) {
        for (size_t i = 0; i < 4 + 4 * shells; i++) {
            uint64_t word = geometry(spectra, i);
            fwrite(&word, sizeof word, 1, stream);
        }
        fwrite(spectra->counts, sizeof *spectra->counts, shells, stream);
        int failed = ferror(stream);
        failed |= fclose(stream);
        if (!failed) return 0;
        remove(path);
    }
    fprintf(stderr, "%s: counts of triangles cannot be written there\n", path);
    return 1;
}

int spectra_load_counts(struct spectra *spectra, const char *path) {
    size_t shells = spectra->wide.count;
    uint64_t word, *counts = calloc(shells, sizeof *counts);
    FILE *stream = fopen(path, "rb");
    int fits = stream != NULL && counts != NULL;
    for (size_t i = 0; fits && i < 4 + 4 * shells; i++) {
        fits = fread(&word, sizeof word, 1, stream) == 1 && word == geometry(spectra, i);
    }
    fits = fits && fread(counts, sizeof *counts, shells, stream) == shells && fgetc(stream) == EOF;
    if (fits) memcpy(spectra->counts, counts, shells * sizeof *counts);
    if (stream != NULL) fclose(stream);
    free(counts);
    return !fits;
}

/* ---- Spectra. */

/* Modes of the deposit, un-normalised and with the window in them. */
static int deposit(struct spectra *spectra, double *mesh, const struct fixpair_positions_f64 *position, double shift) {
    const struct fixpair_fft_f64 *fft = &spectra->hook;
    memset(mesh, 0, fft->length * sizeof *mesh);
    TRY(fixpair_deposit_f64(mesh, fft->length, &fft->configuration, position, NULL, 0, spectra->choice.box_size, spectra->choice.window,
                            shift, spectra->scratch, spectra->scratch_len, spectra->exec));
    if (fft->forward(fft->context, mesh) != 0) {
        fprintf(stderr, "the transform failed\n");
        return 1;
    }
    return 0;
}

/* Multipoles in the shells; modes times `scale` are those of the overdensity. */
static int measure_power(struct spectra *spectra, struct spectra_shells *shells, double *power, double scale) {
    const struct fixpair_fft_f64 *fft = &spectra->hook;
    const double *field = spectra->mesh;
    int32_t compensation = spectra->choice.window;
    compensation += spectra->choice.interlaced ? FIXPAIR_COMPENSATION_WINDOW : FIXPAIR_COMPENSATION_ALIASED;
    memset(shells->sums, 0, shells->words * sizeof *shells->sums);
    TRY(fixpair_power_sums_f64(shells->sums, shells->words, &field, 1, fft->length, itself, 1, &compensation, &fft->fourier,
                               &shells->binning, spectra->scratch, spectra->scratch_len, spectra->exec));
    TRY(fixpair_binning_read(shells->bins, shells->count, power, shells->values, shells->sums, shells->words, &shells->binning, 1));
    TRY(fixpair_binning_normalise(power, shells->values, shells->bins, shells->count, shells->binning.orders,
                                  pow(spectra->choice.box_size, 3.0) * scale * scale));
    return 0;
}

/* Turns the modes into those of the overdensity, by `scale` and without the window. */
static int measure_bispectrum(struct spectra *spectra, struct spectra_result *result, double scale) {
    const struct spectra_shells *wide = &spectra->wide;
    const struct fixpair_fft_f64 *fft = &spectra->hook;
    size_t count = wide->count, words = FIXPAIR_BISPECTRUM_WORDS * count;
    TRY(fixpair_compensate_f64(spectra->mesh, fft->length, FIXPAIR_COMPENSATION_WINDOW + spectra->choice.window, scale,
                               &fft->fourier, spectra->scratch, spectra->scratch_len, spectra->exec));
    memset(spectra->triangle_sums, 0, words * sizeof *spectra->triangle_sums);
    TRY(fixpair_bispectrum_f64(spectra->triangle_sums, words, NULL, spectra->triangles, count, wide->edges, count + 1,
                               spectra->mesh, fft->length, fft, spectra->fields, spectra->fields_len, spectra->scratch, spectra->scratch_len,
                               spectra->exec));
    TRY(fixpair_bispectrum_values(result->bispectrum, count, spectra->triangle_sums, words));
    TRY(fixpair_bispectrum_normalise(result->bispectrum, spectra->counts, count, spectra->choice.n, spectra->choice.box_size, 1.0));
    return 0;
}

/* Shot noise of B, and Q: of P and B less noise, where that is what the points have. */
static int reduce(const struct spectra *spectra, struct spectra_result *result, double *power, double *bispectrum) {
    size_t count = spectra->wide.count;
    double noise = spectra->choice.subtract_noise ? result->noise : 0.0;
    for (size_t s = 0; s < count; s++) power[s] = result->wide_power[s] - result->noise;
    TRY(fixpair_bispectrum_shot_noise(result->bispectrum_noise, spectra->triangles, count, power, count, result->noise));
    for (size_t s = 0; s < count; s++) power[s] = result->wide_power[s] - noise;
    for (size_t s = 0; s < count; s++) {
        bispectrum[s] = result->bispectrum[s] - (spectra->choice.subtract_noise ? result->bispectrum_noise[s] : 0.0);
    }
    TRY(fixpair_bispectrum_reduced(result->reduced, bispectrum, spectra->triangles, count, power, count));
    return 0;
}

int spectra_measure(struct spectra *spectra, struct spectra_result *result, const struct fixpair_positions_f64 *position) {
    const struct fixpair_fft_f64 *fft = &spectra->hook;
    size_t narrow = spectra->narrow.values, wide = spectra->wide.count;
    memset(result, 0, sizeof *result);
    spectra->transforms = 0;
    spectra->said = time(NULL);
    if ((result->power = memory_take_doubles(narrow + 6 * wide)) == NULL) return 1;
    result->wide_power = result->power + narrow;
    result->bispectrum = result->wide_power + wide;
    result->bispectrum_noise = result->bispectrum + wide;
    result->reduced = result->bispectrum_noise + wide;

    TRY(fixpair_shot_noise_f64(&result->noise, NULL, 0, position->length, spectra->choice.box_size));
    TRY(deposit(spectra, spectra->mesh, position, 0.0));
    if (spectra->choice.interlaced) {
        TRY(deposit(spectra, spectra->fields, position, 0.5));
        TRY(fixpair_interlace_f64(spectra->mesh, spectra->fields, fft->length, &fft->fourier, spectra->exec));
    }
    /* The sum over all cells is the number of particles, so that F_k/N is the mode of the overdensity. */
    double scale = 1.0 / (double)position->length;
    TRY(measure_power(spectra, &spectra->narrow, result->power, scale));
    TRY(measure_power(spectra, &spectra->wide, result->wide_power, scale));
    TRY(measure_bispectrum(spectra, result, scale));
    return reduce(spectra, result, result->reduced + wide, result->reduced + 2 * wide);
}

void spectra_release(struct spectra_result *result) {
    free(result->power);
    memset(result, 0, sizeof *result);
}
