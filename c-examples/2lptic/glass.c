#include "glass.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gadget.h"
#include "memory.h"
#include "parameters.h"

static int complain(const char *path, const char *what) {
    fprintf(stderr, "%s: %s\n", path, what);
    return 1;
}

/* Adds the particles of one file to `filled` ones; the first file says how many there are in all. */
static int read_records(struct glass *glass, const char *path, FILE *file, size_t *filled, int32_t *files) {
    struct gadget_header header;
    size_t here = 0, total = 0;
    if (gadget_read_record(file, &header, sizeof header) != 0) return complain(path, "no header of Gadget format 1");
    for (int type = 0; type < 6; type++) {
        here += header.npart[type];
        total += header.npart_total[type];
    }
    if (glass->position == NULL) {
        glass->each = total;
        *files = header.num_files;
        if (total == 0 || !(header.box_size > 0.0)) return complain(path, "no particles, or no box");
        if ((glass->position = memory_take_doubles(3 * total)) == NULL) return 1;
    }
    if (here > glass->each - *filled) return complain(path, "more particles than the header of the first file promises");
    float *read = memory_take_floats(3 * here);
    if (read == NULL) return 1;
    int outcome = gadget_read_record(file, read, 3 * here * sizeof *read);
    for (size_t i = 0; outcome == 0 && i < 3 * here; i++) {
        double x = (double)read[i] / header.box_size;
        if (!isfinite(x)) outcome = 1;
        glass->position[3 * *filled + i] = x - floor(x);
    }
    free(read);
    *filled += here;
    return outcome == 0 ? 0 : complain(path, "the record of positions is broken");
}

static int read_file(struct glass *glass, const char *path, size_t *filled, int32_t *files) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) return complain(path, strerror(errno));
    int outcome = read_records(glass, path, file, filled, files);
    fclose(file);
    return outcome;
}

static int read_all(struct glass *glass, const char *path) {
    char part[TEXT_LENGTH + 16];
    size_t filled = 0;
    int32_t files = 1;
    snprintf(part, sizeof part, "%s.0", path);
    FILE *first = fopen(part, "rb");
    if (first != NULL) fclose(first);
    if (first == NULL) {
        if (read_file(glass, path, &filled, &files) != 0) return 1;
    } else {
        for (int32_t i = 0; i < files; i++) {
            snprintf(part, sizeof part, "%s.%d", path, (int)i);
            if (read_file(glass, part, &filled, &files) != 0) return 1;
        }
    }
    return filled == glass->each ? 0 : complain(path, "fewer particles than its header promises");
}

int glass_open(struct glass *glass, const char *path, size_t tiles) {
    memset(glass, 0, sizeof *glass);
    glass->tiles = tiles;
    if (path[0] == '\0') {
        glass->each = 1;
        if ((glass->position = memory_take_doubles(3)) == NULL) return 1;
    } else if (read_all(glass, path) != 0) {
        return 1;
    }
    if (tiles > 100000 || glass->each > SIZE_MAX / 64 / (tiles * tiles * tiles)) return complain(path, "too many particles");
    glass->count = glass->each * tiles * tiles * tiles;
    return 0;
}

void glass_close(struct glass *glass) {
    free(glass->position);
    memset(glass, 0, sizeof *glass);
}

double glass_coordinate(const struct glass *glass, size_t particle, size_t axis) {
    size_t tile = particle / glass->each, tiles = glass->tiles;
    size_t index[3] = {tile / (tiles * tiles), tile / tiles % tiles, tile % tiles};
    double x = ((double)index[axis] + glass->position[3 * (particle % glass->each) + axis]) / (double)tiles;
    return x < 1.0 ? x : 0.0;
}

int glass_is_mesh(const struct glass *glass, size_t n) {
    const double *corner = glass->position;
    return glass->each == 1 && glass->tiles == n && corner[0] == 0.0 && corner[1] == 0.0 && corner[2] == 0.0;
}
