#include "alone.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "friends.h"
#include "linear.h"
#include "memory.h"
#include "migrate.h"
#include "spectrum.h"
#include "start.h"
#include "transform.h"

int linear_spectrum(double *power, const struct universe *universe, const struct fixpair_fft_f64 *fft, MPI_Comm comm) {
    struct linear linear;
    struct spectrum spectrum;
    double *modes = memory_take_doubles(fft->length), volume = pow(universe->conditions.box_size, 3.0);
    memset(&spectrum, 0, sizeof spectrum);
    int broken = modes == NULL || linear_open(&linear, fft, fft, NULL) || linear_density(&linear, &universe->conditions, modes) ||
                 spectrum_open(&spectrum, comm, &fft->fourier) ||
                 spectrum_measure(&spectrum, modes, fft->length, FIXPAIR_COMPENSATION_NONE, volume);
    if (!broken) memcpy(power, spectrum.power, spectrum.shells * sizeof *power);
    if (modes != NULL) linear_close(&linear);
    spectrum_close(&spectrum);
    free(modes);
    return broken;
}

static int take(struct alone *alone, const struct universe *universe, size_t shells, size_t scale_factors) {
    memset(alone, 0, sizeof *alone);
    alone->particles = universe->particles;
    alone->shells = shells;
    alone->scale_factors = scale_factors;
    alone->position = memory_take_doubles(3 * alone->particles);
    alone->velocity = memory_take_doubles(3 * alone->particles);
    alone->power = memory_take_doubles(shells * scale_factors);
    return alone->position == NULL || alone->velocity == NULL || alone->power == NULL;
}

void alone_close(struct alone *alone) {
    free(alone->position);
    free(alone->velocity);
    free(alone->power);
    free(alone->halos);
    memset(alone, 0, sizeof *alone);
}

/* From rank 0 to all. */
static void share(struct alone *alone, MPI_Comm comm) {
    MPI_Bcast(alone->position, (int)(3 * alone->particles), MPI_DOUBLE, 0, comm);
    MPI_Bcast(alone->velocity, (int)(3 * alone->particles), MPI_DOUBLE, 0, comm);
    MPI_Bcast(alone->power, (int)(alone->shells * alone->scale_factors), MPI_DOUBLE, 0, comm);
}

/* Ids count from 0, so that the particles of the whole box are in their order. */
static void keep(struct alone *alone, const struct particles *particles) {
    for (size_t i = 0; i < particles->count; i++) {
        memcpy(alone->position + 3 * i, particles->at[i].x, 3 * sizeof(double));
        memcpy(alone->velocity + 3 * i, particles->at[i].v, 3 * sizeof(double));
    }
}

static int begin(struct alone *alone, const struct universe *universe) {
    struct transform fft;
    struct particles particles;
    memset(&particles, 0, sizeof particles);
    int broken = transform_open(&fft, universe->choice.n, NULL) || start_particles(&particles, &universe->conditions, &fft.hook) ||
                 linear_spectrum(alone->power, universe, &fft.hook, MPI_COMM_SELF);
    if (!broken) keep(alone, &particles);
    transform_close(&fft);
    particles_close(&particles);
    return broken;
}

int alone_begin(struct alone *alone, const struct universe *universe, MPI_Comm comm) {
    int rank;
    MPI_Comm_rank(comm, &rank);
    if (take(alone, universe, universe->choice.n / 2 - 1, 1)) return 1;
    if (rank == 0 && begin(alone, universe)) return 1;
    share(alone, comm);
    return 0;
}

/* A run with all that it takes. */
struct run {
    struct alone *alone;
    const struct universe *universe;
    struct transform fft;
    struct particles particles;
    struct spectrum spectrum;
    double *mesh[4]; /* three for forces, one for spectra */
    void *scratch, *deposit_scratch;
    size_t scratch_len, deposit_scratch_len;
};

static int run_open(struct run *run, struct alone *alone, const struct universe *universe) {
    struct fixpair_layout layout;
    memset(run, 0, sizeof *run);
    run->alone = alone;
    run->universe = universe;
    TRY(transform_open(&run->fft, universe->choice.n * universe->choice.mesh_factor, NULL));
    const struct fixpair_fft_f64 *fft = &run->fft.hook;
    TRY(spectrum_open(&run->spectrum, MPI_COMM_SELF, &fft->fourier));
    for (size_t i = 0; i < 4; i++) {
        if ((run->mesh[i] = memory_take_doubles(fft->length)) == NULL) return 1;
    }
    TRY(fixpair_evolve_scratch_f64(&layout, fft, universe->particles, universe->gravity.window));
    run->scratch_len = layout.size;
    run->scratch = memory_take(layout);
    TRY(fixpair_deposit_scratch_f64(&layout, &fft->configuration, universe->particles, universe->gravity.window));
    run->deposit_scratch_len = layout.size;
    run->deposit_scratch = memory_take(layout);
    return run->scratch == NULL || run->deposit_scratch == NULL;
}

static void run_close(struct run *run) {
    transform_close(&run->fft);
    particles_close(&run->particles);
    spectrum_close(&run->spectrum);
    for (size_t i = 0; i < 4; i++) free(run->mesh[i]);
    free(run->scratch);
    free(run->deposit_scratch);
}

static int measure(struct run *run, size_t step) {
    const struct fixpair_fft_f64 *fft = &run->fft.hook;
    const struct fixpair_gravity *gravity = &run->universe->gravity;
    struct fixpair_components_f64 position = particles_position(&run->particles);
    struct fixpair_positions_f64 view = particles_view(&position);
    double particles = (double)run->particles.count, factor = pow(gravity->box_size, 3.0) / (particles * particles);
    memset(run->mesh[3], 0, fft->length * sizeof *run->mesh[3]);
    TRY(fixpair_deposit_f64(run->mesh[3], fft->length, &fft->configuration, &view, NULL, 0, gravity->box_size, gravity->window, 0.0,
                            run->deposit_scratch, run->deposit_scratch_len, NULL));
    TRY(fft->forward(fft->context, run->mesh[3]));
    TRY(spectrum_measure(&run->spectrum, run->mesh[3], fft->length, FIXPAIR_COMPENSATION_WINDOW + gravity->window, factor));
    memcpy(run->alone->power + step * run->spectrum.shells, run->spectrum.power, run->spectrum.shells * sizeof(double));
    return 0;
}

static int32_t observe(void *context, const struct fixpair_progress *progress) {
    return progress->event == FIXPAIR_EVENT_STEP ? measure(context, progress->step) : 0;
}

static int evolve(struct run *run) {
    const struct universe *universe = run->universe;
    const struct fixpair_observer observer = {run, observe};
    struct fixpair_epoch epoch = {universe->scale_factors[0], universe->scale_factors[0]};
    struct transform fft;
    int broken = transform_open(&fft, universe->choice.n, NULL) || start_particles(&run->particles, &universe->conditions, &fft.hook);
    transform_close(&fft);
    if (broken || measure(run, 0)) return 1;
    struct fixpair_components_f64 position = particles_position(&run->particles), velocity = particles_velocity(&run->particles);
    TRY(fixpair_evolve_f64(&position, &velocity, &epoch, &universe->gravity, NULL, universe->scale_factors, universe->choice.steps + 1,
                           NULL, run->mesh[0], run->mesh[1], run->mesh[2], run->fft.hook.length, &run->fft.hook, run->scratch,
                           run->scratch_len, &observer, NULL));
    keep(run->alone, &run->particles);
    return 0;
}

static int run_alone(struct alone *alone, const struct universe *universe) {
    struct run run;
    struct friends friends;
    int broken = run_open(&run, alone, universe) || evolve(&run) ||
                 friends_init(&friends, &universe->conditions.cosmology, universe->choice.box_size, universe->particles) ||
                 friends_find_alone(&alone->halos, &alone->halos_len, &friends, &run.particles);
    run_close(&run);
    return broken;
}

int alone_run(struct alone *alone, const struct universe *universe, MPI_Comm comm) {
    int rank;
    MPI_Comm_rank(comm, &rank);
    if (take(alone, universe, universe->choice.n * universe->choice.mesh_factor / 2 - 1, universe->choice.steps + 1)) return 1;
    if (rank == 0 && run_alone(alone, universe)) return 1;
    share(alone, comm);
    return 0;
}

void alone_compare(double *apart, double *faster, const struct alone *alone, const struct particles *particles, double box_size) {
    *apart = *faster = 0.0;
    for (size_t i = 0; i < particles->count; i++) {
        const struct particle *particle = &particles->at[i];
        for (size_t axis = 0; axis < 3; axis++) {
            size_t number = 3 * (size_t)particle->id + axis;
            double distance = fabs(particle->x[axis] - alone->position[number]);
            *apart = fmax(*apart, fmin(distance, box_size - distance));
            *faster = fmax(*faster, fabs(particle->v[axis] - alone->velocity[number]));
        }
    }
}
