#include "gadget.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Critical density today, in 1e10 Msun/h over (Mpc/h)^3. */
#define CRITICAL_DENSITY 27.7536627

enum { HALO = 1, CHUNK = 4096 };

/* C99 has no static assertion: an array of -1 elements does not compile. */
typedef char header_has_256_bytes[sizeof(struct gadget_header) == 256 ? 1 : -1];

static int complain(const char *path, const char *what) {
    fprintf(stderr, "%s: %s\n", path, what);
    return 1;
}

static void make_header(struct gadget_header *header, const struct gadget_universe *universe, size_t count) {
    memset(header, 0, sizeof *header);
    header->npart[HALO] = (uint32_t)count;
    header->npart_total[HALO] = (uint32_t)count;
    header->mass[HALO] = CRITICAL_DENSITY * universe->omega_m * pow(universe->box_size, 3.0) / (double)count;
    header->time = 1.0 / (1.0 + universe->redshift);
    header->redshift = universe->redshift;
    header->num_files = 1;
    header->box_size = universe->box_size * universe->unit;
    header->omega_0 = universe->omega_m;
    header->omega_lambda = universe->omega_de;
    header->hubble_param = universe->h;
}

/* A length before and after each record. Errors stay in the stream until the file is closed. */
static void write_marker(FILE *stream, size_t bytes) {
    uint32_t marker = (uint32_t)bytes;
    fwrite(&marker, sizeof marker, 1, stream);
}

/* values times factor as floats. What rounds up to `period` goes to 0, where it is the same point; 0 for no period. */
static void write_vectors(FILE *stream, const double *values, size_t count, double factor, double period) {
    float chunk[CHUNK];
    write_marker(stream, 3 * count * sizeof *chunk);
    for (size_t first = 0; first < 3 * count; first += CHUNK) {
        size_t length = 3 * count - first < CHUNK ? 3 * count - first : CHUNK;
        for (size_t i = 0; i < length; i++) {
            chunk[i] = (float)(values[first + i] * factor);
            if (period > 0.0 && (double)chunk[i] >= period) chunk[i] = 0.0f;
        }
        fwrite(chunk, sizeof *chunk, length, stream);
    }
    write_marker(stream, 3 * count * sizeof *chunk);
}

static void write_ids(FILE *stream, const uint64_t *ids, size_t count, size_t id_bytes) {
    write_marker(stream, count * id_bytes);
    for (size_t i = 0; i < count; i++) {
        uint32_t narrow = (uint32_t)ids[i];
        if (id_bytes == 4) {
            fwrite(&narrow, sizeof narrow, 1, stream);
        } else {
            fwrite(&ids[i], sizeof ids[i], 1, stream);
        }
    }
    write_marker(stream, count * id_bytes);
}

static int check_particles(const char *path, const struct gadget_particles *particles, size_t id_bytes) {
    if (id_bytes != 4 && id_bytes != 8) return complain(path, "ids have 4 or 8 bytes");
    if (particles->count == 0) return complain(path, "no particles");
    if (particles->count > INT32_MAX / (3 * sizeof(float))) return complain(path, "a record of 2 GiB or more");
    for (size_t i = 0; id_bytes == 4 && i < particles->count; i++) {
        if (particles->id[i] > UINT32_MAX) return complain(path, "an id that does not fit 4 bytes");
    }
    return 0;
}

int gadget_write_file(const char *path, const struct gadget_header *header, const struct gadget_particles *particles, double length,
                      double velocity, size_t id_bytes) {
    if (check_particles(path, particles, id_bytes) != 0) return 1;
    FILE *stream = fopen(path, "wb");
    if (stream == NULL) return complain(path, strerror(errno));

    write_marker(stream, sizeof *header);
    fwrite(header, sizeof *header, 1, stream);
    write_marker(stream, sizeof *header);
    write_vectors(stream, particles->position, particles->count, length, header->box_size);
    write_vectors(stream, particles->velocity, particles->count, velocity, 0.0);
    write_ids(stream, particles->id, particles->count, id_bytes);

    int failed = ferror(stream);
    failed |= fclose(stream);
    if (failed) {
        remove(path);
        return complain(path, "cannot be written to the end; is the disk full?");
    }
    return 0;
}

int gadget_write(const char *path, const struct gadget_universe *universe, const struct gadget_particles *particles,
                 size_t id_bytes) {
    struct gadget_header header;
    make_header(&header, universe, particles->count);
    return gadget_write_file(path, &header, particles, universe->unit, 1.0 / sqrt(header.time), id_bytes);
}

int gadget_read_record(FILE *stream, void *data, size_t bytes) {
    uint32_t before, after;
    if (fread(&before, sizeof before, 1, stream) != 1 || before != bytes) return 1;
    if (fread(data, 1, bytes, stream) != bytes) return 1;
    return fread(&after, sizeof after, 1, stream) != 1 || after != bytes;
}

/* Ids are of 4 or 8 bytes, as the marker of their record says. */
static int read_ids(struct gadget_file *file, FILE *stream) {
    uint32_t before, after, narrow;
    if (fread(&before, sizeof before, 1, stream) != 1) return 1;
    file->id_bytes = before / file->count;
    if ((file->id_bytes != 4 && file->id_bytes != 8) || before % file->count != 0) return 1;
    for (size_t i = 0; i < file->count; i++) {
        if (file->id_bytes == 8) {
            if (fread(&file->id[i], 8, 1, stream) != 1) return 1;
        } else {
            if (fread(&narrow, 4, 1, stream) != 1) return 1;
            file->id[i] = narrow;
        }
    }
    return fread(&after, sizeof after, 1, stream) != 1 || after != before;
}

static int read_records(struct gadget_file *file, const char *path, FILE *stream) {
    if (gadget_read_record(stream, &file->header, sizeof file->header) != 0) return complain(path, "no header of Gadget format 1");
    for (int type = 0; type < 6; type++) {
        if (type != HALO && file->header.npart[type] != 0) return complain(path, "particles of a type other than 1");
    }
    if (file->header.num_files > 1) return complain(path, "one of several files of a snapshot; join them first");
    file->count = file->header.npart[HALO];
    if (file->count == 0) return complain(path, "no particles of type 1");
    if (file->count > INT32_MAX / (3 * sizeof(float))) return complain(path, "a record of 2 GiB or more");

    size_t bytes = 3 * file->count * sizeof(float);
    file->position = malloc(bytes);
    file->velocity = malloc(bytes);
    file->id = malloc(file->count * sizeof *file->id);
    if (file->position == NULL || file->velocity == NULL || file->id == NULL) return complain(path, "no memory left");
    if (gadget_read_record(stream, file->position, bytes) != 0) return complain(path, "the record of positions is broken");
    if (gadget_read_record(stream, file->velocity, bytes) != 0) return complain(path, "the record of velocities is broken");
    if (read_ids(file, stream) != 0) return complain(path, "the record of ids is broken");
    if (fgetc(stream) != EOF) return complain(path, "something follows the ids");
    return 0;
}

int gadget_read(struct gadget_file *file, const char *path) {
    memset(file, 0, sizeof *file);
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) return complain(path, strerror(errno));
    int outcome = read_records(file, path, stream);
    fclose(stream);
    return outcome;
}

double gadget_unit(const struct gadget_header *header) {
    double mass = header->mass[HALO] * (double)header->npart[HALO];
    double box_size = cbrt(mass / (CRITICAL_DENSITY * header->omega_0)), units[] = {GADGET_KPC, GADGET_MPC};
    for (int i = 0; i < 2; i++) {
        if (fabs(header->box_size / (box_size * units[i]) - 1.0) < 0.03) return units[i];
    }
    return 0.0;
}

void gadget_close(struct gadget_file *file) {
    free(file->position);
    free(file->velocity);
    free(file->id);
    memset(file, 0, sizeof *file);
}
