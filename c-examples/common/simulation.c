/* rename, which takes the place of a file */
#define _POSIX_C_SOURCE 200112L

#include "simulation.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

struct fixpair_components_f32 simulation_triples(float *array, size_t count) {
    struct fixpair_components_f32 triples = {array, array + 1, array + 2, 3, count};
    return triples;
}

struct fixpair_positions_f32 simulation_view(const struct fixpair_components_f32 *components) {
    struct fixpair_positions_f32 view = {components->x, components->y, components->z, components->stride, components->length};
    return view;
}

/* What is to be run, as the library has it. */
static int describe(struct simulation *simulation) {
    const struct simulation_choice *choice = &simulation->choice;
    struct fixpair_conditions *conditions = &simulation->conditions;
    struct fixpair_gravity *gravity = &simulation->gravity;
    TRY(fixpair_conditions_init(conditions, choice->seed));
    conditions->realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    conditions->realisation.phase = choice->phase;
    conditions->redshift = choice->start;
    conditions->box_size = choice->box_size;
    TRY(fixpair_gravity_init(gravity));
    gravity->cosmology = conditions->cosmology;
    gravity->box_size = choice->box_size;
    gravity->stepper = choice->stepper;
    /* On one cell a particle the smoothing of deposit and read-out can be undone. Finer meshes see the lattice that particles start
       from, whose modes that would amplify. */
    if (choice->mesh_factor == 1) gravity->window = gravity->law.window = FIXPAIR_WINDOW_PCS;
    TRY(fixpair_linear_steps(simulation->scale_factors, choice->steps + 1, 1.0 / (1.0 + choice->start), 1.0 / (1.0 + choice->end)));
    return 0;
}

int simulation_open(struct simulation *simulation, const struct simulation_choice *choice, const struct fixpair_exec *exec) {
    struct fixpair_layout layout;
    size_t arrays = choice->stepper == FIXPAIR_STEPPER_COLA ? 4 : 2;
    memset(simulation, 0, sizeof *simulation);
    simulation->choice = *choice;
    simulation->exec = exec;
    simulation->count = choice->n * choice->n * choice->n;
    if ((simulation->scale_factors = memory_take_doubles(choice->steps + 1)) == NULL) return 1;
    TRY(describe(simulation));

    TRY(transform_open_f32(&simulation->fft, choice->n * choice->mesh_factor, exec));
    for (size_t i = 0; i < 3; i++) {
        if ((simulation->mesh[i] = memory_take_floats(simulation->fft.hook.length)) == NULL) return 1;
    }
    TRY(fixpair_evolve_scratch_f32(&layout, &simulation->fft.hook, simulation->count, simulation->gravity.window));
    simulation->scratch_len = layout.size;
    if ((simulation->scratch = memory_take(layout)) == NULL) return 1;
    for (size_t i = 0; i < arrays; i++) {
        if ((simulation->memory[i] = memory_take_floats(3 * simulation->count)) == NULL) return 1;
    }
    simulation->position = simulation_triples(simulation->memory[0], simulation->count);
    simulation->velocity = simulation_triples(simulation->memory[1], simulation->count);
    if (arrays == 4) {
        struct fixpair_components_f32 first = simulation_triples(simulation->memory[2], simulation->count);
        struct fixpair_components_f32 second = simulation_triples(simulation->memory[3], simulation->count);
        simulation->displacements.first = simulation_view(&first);
        simulation->displacements.second = simulation_view(&second);
        simulation->displacements.scale_factor = simulation->scale_factors[0];
    }
    return 0;
}

void simulation_close(struct simulation *simulation) {
    transform_close_f32(&simulation->fft);
    free(simulation->scale_factors);
    free(simulation->scratch);
    for (size_t i = 0; i < 3; i++) free(simulation->mesh[i]);
    for (size_t i = 0; i < 4; i++) free(simulation->memory[i]);
    memset(simulation, 0, sizeof *simulation);
}

/* Particles at the first scale factor, by one call; on the way, memory that the run does not need. */
static int make(struct simulation *simulation, int32_t order) {
    struct transform_f32 fft, fine;
    struct fixpair_layout layout;
    void *scratch = NULL;
    size_t n = (size_t)simulation->choice.n;
    memset(&fine, 0, sizeof fine);
    simulation->conditions.order = order;
    int32_t outcome = transform_open_f32(&fft, n, simulation->exec);
    if (outcome == 0) outcome = transform_open_f32(&fine, fixpair_fft_next_side(3 * n / 2), simulation->exec);
    if (outcome == 0) outcome = fixpair_initial_conditions_scratch_f32(&layout, &simulation->conditions, &fft.hook, &fine.hook);
    if (outcome == 0) outcome = (scratch = memory_take(layout)) == NULL;
    if (outcome == 0) {
        outcome = fixpair_initial_conditions_f32(&simulation->position, &simulation->velocity, &simulation->conditions, &fft.hook,
                                                 &fine.hook, scratch, layout.size, simulation->exec);
    }
    free(scratch);
    transform_close_f32(&fft);
    transform_close_f32(&fine);
    TRY(outcome);
    return 0;
}

/* Velocities of both orders are displacements times a H f: those of the first alone give psi1, the difference gives psi2. */
static int take_displacements(struct simulation *simulation) {
    struct fixpair_growth growth;
    const struct fixpair_cosmology *cosmology = &simulation->gravity.cosmology;
    double a = simulation->scale_factors[0], e;
    float *velocity = simulation->memory[1], *first = simulation->memory[2], *second = simulation->memory[3];
    TRY(fixpair_growth_factors(&growth, &a, 1, cosmology));
    TRY(fixpair_expansion(&e, &a, 1, cosmology));
    double rate = a * simulation->gravity.hubble * e;
    TRY(make(simulation, FIXPAIR_ORDER_FIRST));
    memcpy(first, velocity, 3 * simulation->count * sizeof *first);
    TRY(make(simulation, FIXPAIR_ORDER_SECOND));
    for (size_t i = 0; i < 3 * simulation->count; i++) {
        second[i] = (float)(((double)velocity[i] - first[i]) / (rate * growth.f2));
        first[i] = (float)(first[i] / (rate * growth.f));
    }
    return 0;
}

int simulation_begin(struct simulation *simulation) {
    simulation->epoch.position = simulation->epoch.velocity = simulation->scale_factors[0];
    if (simulation->choice.stepper == FIXPAIR_STEPPER_COLA) return take_displacements(simulation);
    return make(simulation, FIXPAIR_ORDER_SECOND);
}

int32_t simulation_evolve(struct simulation *simulation, const struct fixpair_outputs_f32 *outputs,
                          const struct fixpair_observer *observer) {
    const struct fixpair_displacements_f32 *displacements = NULL;
    if (simulation->choice.stepper == FIXPAIR_STEPPER_COLA) displacements = &simulation->displacements;
    return fixpair_evolve_f32(&simulation->position, &simulation->velocity, &simulation->epoch, &simulation->gravity, displacements,
                              simulation->scale_factors, simulation->choice.steps + 1, outputs, simulation->mesh[0],
                              simulation->mesh[1], simulation->mesh[2], simulation->fft.hook.length, &simulation->fft.hook,
                              simulation->scratch, simulation->scratch_len, observer, simulation->exec);
}

/* ---- Checkpoints. */

static const char mark[8] = "fixpm\n\r\x1a";

static int complain(const char *path, const char *what) {
    fprintf(stderr, "%s: %s\n", path, what);
    return 1;
}

int simulation_save(const struct simulation *simulation, const struct fixpair_epoch *epoch, const char *path) {
    size_t values = 3 * simulation->count, length = strlen(path) + sizeof ".partial";
    char *partial = malloc(length);
    if (partial == NULL) return complain(path, "no memory left");
    snprintf(partial, length, "%s.partial", path);
    FILE *stream = fopen(partial, "wb");
    int failed = stream == NULL;
    if (!failed) {
        failed |= fwrite(mark, sizeof mark, 1, stream) != 1;
        failed |= fwrite(&simulation->choice, sizeof simulation->choice, 1, stream) != 1;
        failed |= fwrite(epoch, sizeof *epoch, 1, stream) != 1;
        failed |= fwrite(simulation->memory[0], sizeof(float), values, stream) != values;
        failed |= fwrite(simulation->memory[1], sizeof(float), values, stream) != values;
        failed |= fclose(stream) != 0;
    }
    failed = failed || rename(partial, path) != 0;
    if (failed) complain(path, strerror(errno));
    free(partial);
    return failed;
}

static int read_header(FILE *stream, struct simulation_choice *choice, struct fixpair_epoch *epoch) {
    char found[sizeof mark];
    return fread(found, sizeof found, 1, stream) != 1 || memcmp(found, mark, sizeof mark) != 0 ||
           fread(choice, sizeof *choice, 1, stream) != 1 || fread(epoch, sizeof *epoch, 1, stream) != 1;
}

/* What the library refuses need not be asked for here; but memory is taken and arrays are indexed before it is called. */
static int is_strange(const struct simulation_choice *choice) {
    return choice->n > 1024 || choice->mesh_factor > 3 || choice->steps > 100000 ||
           (choice->phase != FIXPAIR_PHASE_ORIGINAL && choice->phase != FIXPAIR_PHASE_INVERTED);
}

int simulation_peek(struct simulation_choice *choice, const char *path) {
    struct fixpair_epoch epoch;
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) return complain(path, strerror(errno));
    int failed = read_header(stream, choice, &epoch) || is_strange(choice);
    fclose(stream);
    return failed ? complain(path, "is no checkpoint of a simulation") : 0;
}

int simulation_load(struct simulation *simulation, const char *path) {
    struct simulation_choice choice;
    size_t values = 3 * simulation->count;
    /* Displacements are not in the file: the seed gives them again. */
    if (simulation->choice.stepper == FIXPAIR_STEPPER_COLA) TRY(take_displacements(simulation));
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) return complain(path, strerror(errno));
    int failed = read_header(stream, &choice, &simulation->epoch);
    failed = failed || memcmp(&choice, &simulation->choice, sizeof choice) != 0;
    failed = failed || fread(simulation->memory[0], sizeof(float), values, stream) != values;
    failed = failed || fread(simulation->memory[1], sizeof(float), values, stream) != values || fgetc(stream) != EOF;
    fclose(stream);
    return failed ? complain(path, "is no whole checkpoint of this simulation") : 0;
}
