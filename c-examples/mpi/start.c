#include "start.h"

#include <stdlib.h>

#include "check.h"
#include "memory.h"

static int number(struct particles *particles, const struct fixpair_brick *cells) {
    uint64_t *ids = malloc((particles->count + 1) * sizeof *ids);
    int32_t outcome = ids == NULL;
    if (outcome == 0) outcome = fixpair_particle_ids(ids, particles->count, cells, 0, NULL);
    for (size_t i = 0; outcome == 0 && i < particles->count; i++) particles->at[i].id = ids[i];
    free(ids);
    TRY(outcome);
    return 0;
}

int start_particles(struct particles *particles, const struct fixpair_conditions *conditions, const struct fixpair_fft_f64 *fft) {
    const struct fixpair_brick *cells = &fft->configuration;
    struct fixpair_layout layout;
    size_t count = cells->count[0] * cells->count[1] * cells->count[2];
    TRY(particles_open(particles, count));
    particles->count = count;
    struct fixpair_components_f64 position = particles_position(particles), velocity = particles_velocity(particles);
    TRY(fixpair_initial_conditions_scratch_f64(&layout, conditions, fft, NULL));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    fixpair_status_t status = fixpair_initial_conditions_f64(&position, &velocity, conditions, fft, NULL, scratch, layout.size, NULL);
    free(scratch);
    TRY(status);
    return number(particles, cells);
}
