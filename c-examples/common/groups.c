#include "groups.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

/* Of a mean separation; and by how much spheres shrink, down to how many particles, on their way to the densest place. */
#define LINKING 0.2
#define SHRINK 0.9
enum { INNERMOST = 10 };

static void enlarge(struct fixpair_layout *largest, struct fixpair_layout layout) {
    if (largest->size < layout.size) *largest = layout;
}

int groups_open(struct groups *groups, size_t particles, double box_size, const struct fixpair_cosmology *cosmology,
                const struct fixpair_exec *exec) {
    struct fixpair_layout largest, layout;
    memset(groups, 0, sizeof *groups);
    groups->exec = exec;
    groups->particles = particles;
    groups->box_size = box_size;
    groups->halos_len = particles / GROUPS_LEAST;
    TRY(fixpair_particle_mass(&groups->particle_mass, cosmology->omega_m, box_size, particles));
    TRY(fixpair_linking_length(&groups->length, LINKING, box_size, particles));

    TRY(fixpair_fof_labels_scratch_f32(&largest, particles));
    TRY(fixpair_halos_scratch(&layout, particles));
    enlarge(&largest, layout);
    TRY(fixpair_spheres_scratch_f32(&layout, particles));
    enlarge(&largest, layout);
    groups->scratch_len = largest.size;
    groups->scratch = memory_take(largest);
    groups->labels = calloc(particles, sizeof *groups->labels);
    groups->halos = calloc(groups->halos_len, sizeof *groups->halos);
    groups->spheres = calloc(groups->halos_len, GROUPS_SPHERES * sizeof *groups->spheres);
    groups->centres = memory_take_doubles(3 * groups->halos_len);
    groups->radii = memory_take_doubles(groups->halos_len);
    return groups->scratch == NULL || groups->labels == NULL || groups->halos == NULL || groups->spheres == NULL ||
           groups->centres == NULL || groups->radii == NULL;
}

void groups_close(struct groups *groups) {
    free(groups->scratch);
    free(groups->labels);
    free(groups->halos);
    free(groups->spheres);
    free(groups->centres);
    free(groups->radii);
    memset(groups, 0, sizeof *groups);
}

/* Spheres about the densest place of each halo. */
static int grow_spheres(struct groups *groups, const struct fixpair_positions_f32 *position) {
    for (size_t i = 0; i < groups->count; i++) {
        memcpy(groups->centres + 3 * i, groups->halos[i].centre, sizeof groups->halos[i].centre);
        groups->radii[i] = fmin(2.0 * groups->halos[i].radius, groups->box_size / 4.0);
    }
    TRY(fixpair_refine_centres_f32(groups->centres, groups->count, groups->radii, position, groups->box_size, SHRINK, INNERMOST,
                                   groups->scratch, groups->scratch_len, groups->exec));
    TRY(fixpair_spheres_f32(groups->spheres, GROUPS_SPHERES * groups->count, groups->centres, groups->count, groups->overdensities,
                            GROUPS_SPHERES, position, groups->box_size, groups->particles, groups->particle_mass, INNERMOST,
                            groups->scratch, groups->scratch_len, groups->exec));
    return 0;
}

int groups_find(struct groups *groups, const struct fixpair_positions_f32 *position, const struct fixpair_positions_f32 *velocity,
                const struct fixpair_cosmology *cosmology, double scale_factor) {
    static const int32_t definitions[GROUPS_SPHERES] = {FIXPAIR_OVERDENSITY_MEAN, FIXPAIR_OVERDENSITY_CRITICAL,
                                                        FIXPAIR_OVERDENSITY_VIRIAL};
    for (size_t i = 0; i < GROUPS_SPHERES; i++) {
        TRY(fixpair_overdensity(&groups->overdensities[i], definitions[i], 200.0, cosmology, scale_factor));
    }
    TRY(fixpair_fof_labels_f32(groups->labels, groups->particles, position, NULL, 0, groups->box_size, groups->length,
                               groups->scratch, groups->scratch_len, groups->exec));
    TRY(fixpair_halos_f32(groups->halos, groups->halos_len, &groups->count, groups->labels, groups->particles, position, velocity,
                          groups->box_size, GROUPS_LEAST, groups->particle_mass, groups->scratch, groups->scratch_len, groups->exec));
    return grow_spheres(groups, position);
}

int groups_write(const struct groups *groups, const char *path) {
    FILE *stream = fopen(path, "w");
    int failed = stream == NULL;
    if (!failed) {
        fprintf(stream, "label,particles,mass [Msun/h],x [Mpc/h],y,z,vx [km/s],vy,vz,rms radius [Mpc/h],velocity dispersion [km/s],"
                        "densest x [Mpc/h],y,z,M200b [Msun/h],R200b [Mpc/h],M200c,R200c,Mvir,Rvir\n");
        for (size_t i = 0; i < groups->count; i++) {
            const struct fixpair_halo *halo = &groups->halos[i];
            const double *x = halo->centre, *v = halo->velocity, *densest = groups->centres + 3 * i;
            fprintf(stream, "%llu,%llu,%.6e,%.5f,%.5f,%.5f,%.3f,%.3f,%.3f,%.5f,%.3f,%.5f,%.5f,%.5f", (unsigned long long)halo->label,
                    (unsigned long long)halo->members, halo->mass, x[0], x[1], x[2], v[0], v[1], v[2], halo->radius,
                    halo->velocity_dispersion, densest[0], densest[1], densest[2]);
            for (size_t s = GROUPS_SPHERES * i; s < GROUPS_SPHERES * (i + 1); s++) {
                fprintf(stream, ",%.6e,%.5f", groups->spheres[s].mass, groups->spheres[s].radius);
            }
            fputs("\n", stream);
        }
        failed |= ferror(stream);
        failed |= fclose(stream) != 0;
    }
    if (failed) fprintf(stderr, "%s: %s\n", path, strerror(errno));
    return failed;
}
