#include "by_hand.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "check.h"

/* Displacements, for COLA; and what turns them into those that factors are for: one over their growth. */
struct lagrangian {
    const struct fixpair_positions_f32 *first, *second;
    double first_unit, second_unit;
};

static int take_lagrangian(struct lagrangian *lagrangian, const struct simulation *run) {
    struct fixpair_growth growth;
    memset(lagrangian, 0, sizeof *lagrangian);
    if (run->gravity.stepper != FIXPAIR_STEPPER_COLA) return 0;
    TRY(fixpair_growth_factors(&growth, &run->displacements.scale_factor, 1, &run->gravity.cosmology));
    lagrangian->first = &run->displacements.first;
    lagrangian->second = &run->displacements.second;
    lagrangian->first_unit = 1.0 / growth.d;
    lagrangian->second_unit = 1.0 / growth.d2;
    return 0;
}

static int transform(int32_t outcome) {
    if (outcome != 0) fprintf(stderr, "the transform failed\n");
    return outcome != 0;
}

/* The force on the cells, of particles where they are. */
static int compute_force(struct simulation *run) {
    const struct fixpair_fft_f32 *fft = &run->fft.hook;
    const struct fixpair_gravity *gravity = &run->gravity;
    struct fixpair_positions_f32 position = simulation_view(&run->position);
    float *x = run->mesh[0], *y = run->mesh[1], *z = run->mesh[2];
    memset(x, 0, fft->length * sizeof *x);
    TRY(fixpair_deposit_f32(x, fft->length, &fft->configuration, &position, NULL, 0, gravity->box_size, gravity->window, 0.0,
                            run->scratch, run->scratch_len, run->exec));
    TRY(transform(fft->forward(fft->context, x)));
    TRY(fixpair_forces_f32(x, y, z, fft->length, &fft->fourier, &gravity->law, gravity->box_size, (double)run->count, run->scratch,
                           run->scratch_len, run->exec));
    for (size_t axis = 0; axis < 3; axis++) TRY(transform(fft->inverse(fft->context, run->mesh[axis])));
    return 0;
}

/* Factors are for v = a u/H0, arrays hold u: hence a and H0. */
static int kick(struct simulation *run, const struct lagrangian *lagrangian, double to) {
    const struct fixpair_fft_f32 *fft = &run->fft.hook;
    const struct fixpair_gravity *gravity = &run->gravity;
    struct fixpair_positions_f32 position = simulation_view(&run->position);
    struct fixpair_step_factors factors;
    double from = run->epoch.velocity, unit = gravity->hubble / to;
    TRY(fixpair_kick_factors(&factors, &gravity->cosmology, gravity->stepper, gravity->cola_exponent, from, to, run->epoch.position));
    TRY(fixpair_kick_f32(&run->velocity, &position, run->mesh[0], run->mesh[1], run->mesh[2], fft->length, &fft->configuration,
                         gravity->box_size, gravity->window, 0.0, from / to, unit * factors.factor,
                         unit * factors.first * lagrangian->first_unit, unit * factors.second * lagrangian->second_unit,
                         lagrangian->first, lagrangian->second, run->scratch, run->scratch_len, run->exec));
    run->epoch.velocity = to;
    return 0;
}

static int drift(struct simulation *run, const struct lagrangian *lagrangian, double to) {
    const struct fixpair_gravity *gravity = &run->gravity;
    struct fixpair_positions_f32 velocity = simulation_view(&run->velocity);
    struct fixpair_step_factors factors;
    double at = run->epoch.velocity;
    TRY(fixpair_drift_factors(&factors, &gravity->cosmology, gravity->stepper, gravity->cola_exponent, run->epoch.position, to, at));
    TRY(fixpair_drift_f32(&run->position, &velocity, gravity->box_size, factors.factor * at / gravity->hubble,
                          factors.first * lagrangian->first_unit, factors.second * lagrangian->second_unit, lagrangian->first,
                          lagrangian->second, run->exec));
    run->epoch.position = to;
    return 0;
}

/* On the way velocities are half a step from positions; at the end they meet. */
int by_hand_evolve(struct simulation *run) {
    const double *a = run->scale_factors;
    struct lagrangian lagrangian;
    size_t last = (size_t)run->choice.steps;
    TRY(take_lagrangian(&lagrangian, run));
    for (size_t i = 0; i < last; i++) {
        TRY(compute_force(run));
        TRY(kick(run, &lagrangian, sqrt(a[i] * a[i + 1])));
        TRY(drift(run, &lagrangian, a[i + 1]));
    }
    TRY(compute_force(run));
    return kick(run, &lagrangian, a[last]);
}
