#include "universe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

#define PI 3.14159265358979323846

/* Of the fit of Eisenstein & Hu in those codes, and the baryons that it takes where a file has none. */
#define T_CMB 2.728
#define BARYONS 0.04

static void describe_cosmology(struct fixpair_cosmology *cosmology, const struct parameters *parameters) {
    cosmology->omega_m = parameters->omega;
    cosmology->omega_de = parameters->omega_lambda;
    cosmology->omega_r = 0.0;
    cosmology->omega_b = parameters->omega_baryon > 0.0 ? parameters->omega_baryon : BARYONS;
    cosmology->h = parameters->hubble_param;
    cosmology->n_s = parameters->primordial_index;
    cosmology->w0 = -1.0;
    cosmology->wa = 0.0;
    cosmology->t_cmb = T_CMB;
}

/*
 * Twice the largest component that 2LPTic draws. It compares k L/(2 pi) with Nsample/2 as they are rounded, which in a cube puts
 * all modes on the edge on one side of it or the other, as the box will have it. (In a sphere each has a rounding of its own;
 * there all are drawn here.)
 */
static uint32_t sample_of(const struct parameters *parameters) {
    long most = parameters->n_sample / 2;
    double k = (double)(most * 2) * PI / parameters->box;
    if (parameters->sphere_mode != 1 && k * parameters->box / (2.0 * PI) > (double)most) most -= 1;
    /* 0 would mean all. */
    return most > 0 ? (uint32_t)(2 * most) : 1;
}

static int describe(struct universe *universe) {
    const struct parameters *parameters = universe->parameters;
    struct fixpair_conditions *conditions = &universe->conditions;
    struct fixpair_growth growth;
    /* A negative seed is what C makes of it on the way to an unsigned one; the generator reads its low 31 bits. */
    TRY(fixpair_conditions_init(conditions, (uint64_t)parameters->seed));
    conditions->realisation.scheme = FIXPAIR_SCHEME_NGENIC;
    conditions->realisation.selection = parameters->sphere_mode == 1 ? FIXPAIR_SELECTION_SPHERE : FIXPAIR_SELECTION_CUBE;
    conditions->realisation.sample = sample_of(parameters);
    conditions->realisation.amplitude = parameters->fixed_amplitude ? FIXPAIR_AMPLITUDE_FIXED : FIXPAIR_AMPLITUDE_NORMAL;
    conditions->realisation.phase = parameters->phase_flip ? FIXPAIR_PHASE_INVERTED : FIXPAIR_PHASE_ORIGINAL;
    conditions->realisation.nyquist = FIXPAIR_NYQUIST_ZERO;
    describe_cosmology(&conditions->cosmology, parameters);
    conditions->redshift = parameters->redshift;
    conditions->box_size = parameters->box * parameters->unit_length / CM_PER_MPC;
    conditions->f_nl = parameters->f_nl;
    conditions->convention = FIXPAIR_CONVENTION_CMB;
    conditions->shape = universe->choices.shape;
    conditions->order = universe->choices.order;

    double a = 1.0 / (1.0 + parameters->redshift);
    TRY(fixpair_growth_factors(&growth, &a, 1, &conditions->cosmology));
    universe->growth = growth.d;
    TRY(spectrum_open(&universe->spectrum, parameters, growth.d));
    conditions->linear = spectrum_linear(&universe->spectrum);
    return 0;
}

static int check_side(size_t n) {
    size_t next = fixpair_fft_next_side(n);
    if (next == n) return 0;
    fprintf(stderr, "Nmesh: %lu has a prime factor above 7, which the built-in transform lacks; the next that has none is %lu\n",
            (unsigned long)n, (unsigned long)next);
    return 1;
}

int universe_open(struct universe *universe, const struct parameters *parameters, const struct choices *choices) {
    size_t n = (size_t)parameters->n_mesh;
    size_t tiles = parameters->glass_tile_fac > 0 ? (size_t)parameters->glass_tile_fac : n;
    memset(universe, 0, sizeof *universe);
    universe->parameters = parameters;
    universe->choices = *choices;
    TRY(check_side(n));
    TRY(describe(universe));
    TRY(glass_open(&universe->glass, parameters->glass_file, tiles));
    TRY(fixpair_threads_create(&universe->threads, &universe->exec, choices->threads));
    TRY(transform_open(&universe->fft, n, &universe->exec));
    if (choices->dealias) TRY(transform_open(&universe->fine, fixpair_fft_next_side((3 * n + 1) / 2), &universe->exec));
    universe->position = memory_take_doubles(3 * universe->glass.count);
    universe->velocity = memory_take_doubles(3 * universe->glass.count);
    return universe->position == NULL || universe->velocity == NULL;
}

/* One particle a cell, at its corner: nothing is interpolated. */
static int make_on_mesh(struct universe *universe, const struct fixpair_components_f64 *x, const struct fixpair_components_f64 *v,
                        const struct fixpair_fft_f64 *fine) {
    struct fixpair_layout layout;
    TRY(fixpair_initial_conditions_scratch_f64(&layout, &universe->conditions, &universe->fft.hook, fine));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    fixpair_status_t status = fixpair_initial_conditions_f64(x, v, &universe->conditions, &universe->fft.hook, fine, scratch,
                                                             layout.size, &universe->exec);
    free(scratch);
    TRY(status);
    return 0;
}

/* Particles anywhere: displacements are interpolated from the eight cells around them. */
static int make_anywhere(struct universe *universe, const struct fixpair_components_f64 *x, const struct fixpair_components_f64 *v,
                         const struct fixpair_fft_f64 *fine) {
    struct fixpair_layout layout;
    size_t count = universe->glass.count;
    double *before = memory_take_doubles(3 * count), box = universe->conditions.box_size;
    if (before == NULL) return 1;
    for (size_t i = 0; i < 3 * count; i++) before[i] = box * glass_coordinate(&universe->glass, i / 3, i % 3);
    struct fixpair_positions_f64 glass = {before, before + 1, before + 2, 3, count};

    fixpair_status_t status =
        fixpair_initial_conditions_at_scratch_f64(&layout, &universe->conditions, count, &universe->fft.hook, fine);
    void *scratch = status == 0 ? memory_take(layout) : NULL;
    if (scratch != NULL) {
        status = fixpair_initial_conditions_at_f64(x, v, &glass, &universe->conditions, &universe->fft.hook, fine, scratch,
                                                   layout.size, &universe->exec);
    }
    free(before);
    free(scratch);
    TRY(status);
    return scratch == NULL;
}

int universe_make(struct universe *universe) {
    double *position = universe->position, *velocity = universe->velocity;
    struct fixpair_components_f64 x = {position, position + 1, position + 2, 3, universe->glass.count};
    struct fixpair_components_f64 v = {velocity, velocity + 1, velocity + 2, 3, universe->glass.count};
    const struct fixpair_fft_f64 *fine = universe->choices.dealias ? &universe->fine.hook : NULL;
    if (glass_is_mesh(&universe->glass, (size_t)universe->parameters->n_mesh)) return make_on_mesh(universe, &x, &v, fine);
    return make_anywhere(universe, &x, &v, fine);
}

void universe_close(struct universe *universe) {
    spectrum_close(&universe->spectrum);
    glass_close(&universe->glass);
    transform_close(&universe->fft);
    transform_close(&universe->fine);
    fixpair_threads_destroy(universe->threads);
    free(universe->position);
    free(universe->velocity);
    memset(universe, 0, sizeof *universe);
}
