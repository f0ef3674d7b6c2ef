#include "snapshot.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "fixpair.h"
#include "gadget.h"
#include "memory.h"

#define PI 3.14159265358979323846
#define GRAVITY 6.672e-8 /* cm^3/g/s^2 */
#define HUBBLE 3.2407789e-18 /* h/s */

enum { HALO = 1, PATH_LENGTH = 2 * TEXT_LENGTH + 32 };

/* The particles of one file, gathered. */
struct share {
    size_t count;
    double *position, *velocity;
    uint64_t *id;
};

static void share_close(struct share *share) {
    free(share->position);
    free(share->velocity);
    free(share->id);
}

static int share_open(struct share *share, size_t count) {
    memset(share, 0, sizeof *share);
    share->count = count;
    share->position = memory_take_doubles(3 * count);
    share->velocity = memory_take_doubles(3 * count);
    share->id = malloc(count * sizeof *share->id);
    return share->position == NULL || share->velocity == NULL || share->id == NULL;
}

/* Which file a particle belongs to. On a plane it is in the cell above, however its coordinate was rounded. */
static size_t file_of(const struct parameters *parameters, const struct glass *glass, size_t particle, size_t files) {
    size_t n = (size_t)parameters->n_mesh, planes = (n + files - 1) / files;
    size_t plane = (size_t)(glass_coordinate(glass, particle, 0) * (double)n + 1e-6);
    return (plane < n ? plane : n - 1) / planes;
}

static void make_header(struct gadget_header *header, const struct parameters *p, size_t total) {
    double time = p->unit_length / p->unit_velocity, hubble = HUBBLE * time;
    double gravity = GRAVITY / pow(p->unit_length, 3.0) * p->unit_mass * time * time;
    memset(header, 0, sizeof *header);
    header->npart_total[HALO] = (uint32_t)total;
    header->npart_total_high_word[HALO] = (uint32_t)((uint64_t)total >> 32);
    header->mass[HALO] = p->omega * 3.0 * hubble * hubble / (8.0 * PI * gravity) * pow(p->box, 3.0) / (double)total;
    header->time = 1.0 / (1.0 + p->redshift);
    header->redshift = p->redshift;
    header->box_size = p->box;
    header->omega_0 = p->omega;
    header->omega_lambda = p->omega_lambda;
    header->hubble_param = p->hubble_param;
}

static int write_share(const struct parameters *p, struct gadget_header *header, const struct share *share, const char *path,
                       size_t id_bytes) {
    struct gadget_particles particles = {share->count, share->position, share->velocity, share->id};
    double length = CM_PER_MPC / p->unit_length, velocity = 1e5 / p->unit_velocity / sqrt(header->time);
    header->npart[HALO] = (uint32_t)share->count;
    return gadget_write_file(path, header, &particles, length, velocity, id_bytes);
}

/* The particles from which those of a file come: whole planes of tiles, and one more on either side for what rounds across. */
static void range(const struct parameters *parameters, const struct glass *glass, size_t file, size_t files, size_t *first,
                  size_t *last) {
    size_t n = (size_t)parameters->n_mesh, planes = (n + files - 1) / files, plane = glass->count / glass->tiles;
    size_t low = file * planes * glass->tiles / n, high = (file + 1) * planes * glass->tiles / n + 2;
    *first = (low > 0 ? low - 1 : 0) * plane;
    *last = (high < glass->tiles ? high : glass->tiles) * plane;
}

/* Gathers the particles of one file and writes it. `held` says how many it has. */
static int write_one(const struct parameters *parameters, const struct glass *glass, const double *position, const double *velocity,
                     size_t file, size_t files, size_t held, struct gadget_header *header, size_t id_bytes, const char *path) {
    struct share share;
    size_t filled = 0, first, last;
    int outcome = share_open(&share, held);
    range(parameters, glass, file, files, &first, &last);
    for (size_t i = first; outcome == 0 && i < last; i++) {
        if (file_of(parameters, glass, i, files) != file) continue;
        memcpy(&share.position[3 * filled], &position[3 * i], 3 * sizeof *position);
        memcpy(&share.velocity[3 * filled], &velocity[3 * i], 3 * sizeof *velocity);
        share.id[filled++] = (uint64_t)i + 1;
    }
    if (outcome == 0) outcome = write_share(parameters, header, &share, path, id_bytes);
    share_close(&share);
    return outcome;
}

int snapshot_write(const struct parameters *parameters, const struct glass *glass, const double *position, const double *velocity,
                   size_t files, int long_ids) {
    struct gadget_header header;
    char path[PATH_LENGTH];
    size_t *held = calloc(files, sizeof *held), number = 0;
    int outcome = held == NULL;
    make_header(&header, parameters, glass->count);
    for (size_t i = 0; outcome == 0 && i < glass->count; i++) held[file_of(parameters, glass, i, files)] += 1;
    for (size_t file = 0; outcome == 0 && file < files; file++) header.num_files += held[file] > 0;
    for (size_t file = 0; outcome == 0 && file < files; file++) {
        if (held[file] == 0) continue;
        int length = snprintf(path, sizeof path, "%s/%s", parameters->output_dir, parameters->file_base);
        if (header.num_files > 1) snprintf(path + length, sizeof path - (size_t)length, ".%lu", (unsigned long)number);
        number += 1;
        outcome = write_one(parameters, glass, position, velocity, file, files, held[file], &header,
                            long_ids || glass->count > INT32_MAX ? 8 : 4, path);
    }
    free(held);
    return outcome;
}

int snapshot_write_spectrum(const struct parameters *parameters, const struct fixpair_conditions *conditions, double growth) {
    /* 1000 to 0.001 Mpc/h, as 2LPTic prints it. */
    const double first = 2.0 * PI / 1000.0, last = 2.0 * PI / 0.001, ratio = 1.025;
    double scale = parameters->unit_length / CM_PER_MPC;
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s/inputspec_%s.txt", parameters->output_dir, parameters->file_base);
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    fprintf(file, "%12g %12g\n", parameters->redshift, 1.0 / growth);
    fixpair_status_t status = 0;
    for (double k = first; status == 0 && k < last; k *= ratio) {
        double power = 0.0;
        status = fixpair_linear_power(&power, &k, 1, &conditions->cosmology, &conditions->linear, 0.0);
        fprintf(file, "%12g %12g\n", k * scale, power * k * k * k / (2.0 * PI * PI));
    }
    int failed = fclose(file);
    TRY(status);
    return failed != 0;
}
