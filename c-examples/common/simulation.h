/*
 * A particle-mesh simulation of one universe on one process, in single precision: the memory of a run, its initial conditions, its
 * list of steps, and checkpoints.
 *
 * Fixed initial conditions of the GOLIAT cosmology, with the spectrum of Eisenstein and Hu. Particles are numbered as
 * fixpair_initial_conditions_f32 numbers them, z fastest, and stay so.
 */

#ifndef SIMULATION_H
#define SIMULATION_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "transform.h"

/* What makes one run differ from another; written to checkpoints as it is. */
struct simulation_choice {
    uint64_t n;           /* particles on a side */
    uint64_t mesh_factor; /* cells over particles, on a side */
    uint64_t steps;
    uint64_t seed;
    double box_size;      /* Mpc/h */
    double start, end;    /* redshifts */
    int32_t stepper;      /* FIXPAIR_STEPPER_... */
    int32_t phase;        /* FIXPAIR_PHASE_... */
};

struct simulation {
    struct simulation_choice choice;
    const struct fixpair_exec *exec;
    struct fixpair_conditions conditions;
    struct fixpair_gravity gravity;
    double *scale_factors; /* steps + 1 */
    size_t count;          /* particles */
    struct fixpair_components_f32 position, velocity; /* triples, Mpc/h and km/s */
    struct fixpair_epoch epoch;                       /* where they are */
    struct fixpair_displacements_f32 displacements;   /* of COLA */
    struct transform_f32 fft;
    float *mesh[3];        /* fft.hook.length each */
    void *scratch;
    size_t scratch_len;
    float *memory[4];      /* positions, velocities, both orders of displacements */
};

/*
 * Memory for a run. Returns 0, or 1 after saying what is wrong; in both cases simulation_close gives the memory back, as it does for
 * a struct of zeros.
 */
int simulation_open(struct simulation *simulation, const struct simulation_choice *choice, const struct fixpair_exec *exec);

void simulation_close(struct simulation *simulation);

/* Initial conditions; for COLA the displacements that they are made of too. */
int simulation_begin(struct simulation *simulation);

/*
 * fixpair_evolve_f32, with or without outputs and an observer. Returns its status, which is FIXPAIR_ERROR_STOPPED where the observer
 * stopped it.
 */
int32_t simulation_evolve(struct simulation *simulation, const struct fixpair_outputs_f32 *outputs,
                          const struct fixpair_observer *observer);

/* Triples in `array` as fixpair takes them. */
struct fixpair_components_f32 simulation_triples(float *array, size_t count);

/* The same to be read. */
struct fixpair_positions_f32 simulation_view(const struct fixpair_components_f32 *components);

/*
 * The state, positions and velocities as they are and `epoch`, in a file: in the machine's byte order, behind the choice. It takes the
 * place of the last one at once, so that a run can be killed at any time.
 */
int simulation_save(const struct simulation *simulation, const struct fixpair_epoch *epoch, const char *path);

/* The choice in such a file, to open a simulation with; and the state that it then goes on from. */
int simulation_peek(struct simulation_choice *choice, const char *path);
int simulation_load(struct simulation *simulation, const char *path);

#endif
