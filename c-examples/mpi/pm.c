#include "pm.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"
#include "start.h"

static void enlarge(struct fixpair_layout *largest, struct fixpair_layout layout) {
    if (largest->size < layout.size) *largest = layout;
}

int pm_open(struct pm *pm, MPI_Comm comm, const struct universe *universe, int transposed) {
    struct fixpair_layout largest, layout;
    size_t side = universe->choice.n * universe->choice.mesh_factor;
    int32_t window = universe->gravity.window;
    memset(pm, 0, sizeof *pm);
    pm->universe = universe;
    TRY(fftw_slabs_open(&pm->fft, comm, side, transposed));
    TRY(ghosts_open(&pm->ghosts, &pm->fft.slabs, pm->fft.hook.length, window, 0.0));
    TRY(spectrum_open(&pm->spectrum, comm, &pm->fft.hook.fourier));
    for (size_t axis = 0; axis < 3; axis++) {
        if ((pm->mesh[axis] = memory_take_doubles(pm->ghosts.length)) == NULL) return 1;
    }
    /* Enough for all particles: the bytes do not grow beyond 2^21 of them. */
    TRY(fixpair_deposit_scratch_f64(&largest, &pm->ghosts.region, universe->particles, window));
    TRY(fixpair_kick_scratch_f64(&layout, &pm->ghosts.region, universe->particles, window));
    enlarge(&largest, layout);
    TRY(fixpair_force_scratch(&layout, side));
    enlarge(&largest, layout);
    pm->scratch_len = largest.size;
    pm->scratch = memory_take(largest);
    return pm->scratch == NULL;
}

void pm_close(struct pm *pm) {
    for (size_t axis = 0; axis < 3; axis++) free(pm->mesh[axis]);
    free(pm->scratch);
    particles_close(&pm->particles);
    spectrum_close(&pm->spectrum);
    ghosts_close(&pm->ghosts);
    fftw_slabs_close(&pm->fft);
    memset(pm, 0, sizeof *pm);
}

static int send_home(struct pm *pm) {
    size_t moved = 0;
    if (migrate(&pm->particles, &pm->fft.slabs, pm->universe->gravity.box_size, &moved)) return 1;
    pm->moved += moved;
    if (pm->most < pm->particles.count) pm->most = pm->particles.count;
    return 0;
}

int pm_begin(struct pm *pm) {
    struct fftw_slabs fft;
    /* Particles come from a mesh of their own side, whose slabs need not be those of the forces. */
    int broken = fftw_slabs_open(&fft, pm->fft.slabs.comm, pm->universe->choice.n, pm->fft.transposed) ||
                 start_particles(&pm->particles, &pm->universe->conditions, &fft.hook);
    fftw_slabs_close(&fft);
    pm->epoch.position = pm->epoch.velocity = pm->universe->scale_factors[0];
    if (broken || send_home(pm)) return 1;
    pm->moved = 0;
    return 0;
}

static int transform(int32_t outcome) {
    if (outcome != 0) fprintf(stderr, "the transform failed\n");
    return outcome != 0;
}

/* The force on the cells and their ghosts, of particles where they are; on the way, P(k). */
static int compute_force(struct pm *pm, double *power) {
    const struct fixpair_fft_f64 *fft = &pm->fft.hook;
    const struct fixpair_gravity *gravity = &pm->universe->gravity;
    struct ghosts *ghosts = &pm->ghosts;
    struct fixpair_components_f64 position = particles_position(&pm->particles);
    struct fixpair_positions_f64 view = particles_view(&position);
    double mass = (double)pm->universe->particles, volume = pow(gravity->box_size, 3.0), *inside[3];
    for (size_t axis = 0; axis < 3; axis++) inside[axis] = pm->mesh[axis] + ghosts->inside;

    memset(pm->mesh[0], 0, ghosts->length * sizeof *pm->mesh[0]);
    TRY(fixpair_deposit_f64(pm->mesh[0], ghosts->length, &ghosts->region, &view, NULL, 0, gravity->box_size, gravity->window, 0.0,
                            pm->scratch, pm->scratch_len, NULL));
    TRY(ghosts_fold(ghosts, pm->mesh[0]));
    TRY(transform(fft->forward(fft->context, inside[0])));
    TRY(spectrum_measure(&pm->spectrum, inside[0], fft->length, FIXPAIR_COMPENSATION_WINDOW + gravity->window, volume / (mass * mass)));
    memcpy(power, pm->spectrum.power, pm->spectrum.shells * sizeof *power);
    TRY(fixpair_forces_f64(inside[0], inside[1], inside[2], fft->length, &fft->fourier, &gravity->law, gravity->box_size, mass,
                           pm->scratch, pm->scratch_len, NULL));
    for (size_t axis = 0; axis < 3; axis++) {
        TRY(transform(fft->inverse(fft->context, inside[axis])));
        TRY(ghosts_fill(ghosts, pm->mesh[axis]));
    }
    return 0;
}

/* Factors are for v = a u/H0, particles have u: hence a and H0. */
static int kick(struct pm *pm, double to) {
    const struct fixpair_gravity *gravity = &pm->universe->gravity;
    struct fixpair_components_f64 position = particles_position(&pm->particles), velocity = particles_velocity(&pm->particles);
    struct fixpair_positions_f64 view = particles_view(&position);
    struct fixpair_step_factors factors;
    double from = pm->epoch.velocity;
    TRY(fixpair_kick_factors(&factors, &gravity->cosmology, gravity->stepper, gravity->cola_exponent, from, to, pm->epoch.position));
    TRY(fixpair_kick_f64(&velocity, &view, pm->mesh[0], pm->mesh[1], pm->mesh[2], pm->ghosts.length, &pm->ghosts.region,
                         gravity->box_size, gravity->window, 0.0, from / to, gravity->hubble / to * factors.factor, 0.0, 0.0, NULL, NULL,
                         pm->scratch, pm->scratch_len, NULL));
    pm->epoch.velocity = to;
    return 0;
}

static int drift(struct pm *pm, double to) {
    const struct fixpair_gravity *gravity = &pm->universe->gravity;
    struct fixpair_components_f64 position = particles_position(&pm->particles), velocity = particles_velocity(&pm->particles);
    struct fixpair_positions_f64 view = particles_view(&velocity);
    struct fixpair_step_factors factors;
    double at = pm->epoch.velocity;
    TRY(fixpair_drift_factors(&factors, &gravity->cosmology, gravity->stepper, gravity->cola_exponent, pm->epoch.position, to, at));
    TRY(fixpair_drift_f64(&position, &view, gravity->box_size, factors.factor * at / gravity->hubble, 0.0, 0.0, NULL, NULL, NULL));
    pm->epoch.position = to;
    return send_home(pm);
}

/* On the way velocities are half a step from positions; at the end they meet. */
int pm_evolve(struct pm *pm, double *power) {
    const double *a = pm->universe->scale_factors;
    size_t last = pm->universe->choice.steps, shells = pm->spectrum.shells;
    for (size_t i = 0; i < last; i++) {
        TRY(compute_force(pm, power + i * shells));
        TRY(kick(pm, sqrt(a[i] * a[i + 1])));
        TRY(drift(pm, a[i + 1]));
    }
    TRY(compute_force(pm, power + last * shells));
    return kick(pm, a[last]);
}
