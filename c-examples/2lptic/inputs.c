#include "inputs.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boltzmann.h"
#include "check.h"
#include "gadget.h"
#include "memory.h"

#define PI 3.14159265358979323846

enum { PATH_LENGTH = 1024, HALO = 1 };

/* Two columns. */
static int write_columns(const char *folder, const char *name, const double *first, const double *second, size_t rows) {
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    for (size_t i = 0; i < rows; i++) fprintf(file, "%.17g %.17g\n", first[i], second[i]);
    return fclose(file) != 0;
}

static int write_spectrum(const struct boltzmann_table *table, const char *folder, double *work) {
    double *logk = work, *logd = work + table->rows;
    for (size_t i = 0; i < table->rows; i++) {
        logk[i] = log10(table->k[i]);
        logd[i] = log10(pow(table->k[i], 3.0) * table->value[i] / (2.0 * PI * PI));
    }
    return write_columns(folder, "input_spectrum.dat", logk, logd, table->rows);
}

static int write_transfer(const struct boltzmann_table *table, const char *folder, double *work) {
    struct fixpair_conditions conditions;
    TRY(fixpair_conditions_init(&conditions, 0));
    struct fixpair_linear linear = boltzmann_linear(table, 0.0);
    TRY(fixpair_linear_transfer(work, table->k, table->rows, &conditions.cosmology, &linear));
    return write_columns(folder, "input_transfer.dat", table->k, work, table->rows);
}

/* `side`^3 particles about the points of a lattice, moved by up to a third of its spacing. */
static int write_glass(const char *folder, const char *name, size_t side, double moved) {
    struct gadget_header header;
    char path[PATH_LENGTH];
    double position[3 * 8], velocity[3 * 8] = {0.0};
    uint64_t id[8];
    uint32_t random = 1;
    size_t count = side * side * side;
    for (size_t i = 0; i < count; i++) {
        size_t index[3] = {i / (side * side), i / side % side, i % side};
        id[i] = i + 1;
        for (size_t axis = 0; axis < 3; axis++) {
            /* Any numbers will do: those of Numerical Recipes' quick generator. */
            random = random * 1664525u + 1013904223u;
            position[3 * i + axis] = ((double)index[axis] + moved * (random / 4294967296.0)) / (double)side;
        }
    }
    memset(&header, 0, sizeof header);
    header.npart[HALO] = header.npart_total[HALO] = (uint32_t)count;
    header.num_files = 1;
    header.box_size = 100000.0;
    struct gadget_particles particles = {count, position, velocity, id};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return gadget_write_file(path, &header, &particles, header.box_size, 1.0, 4);
}

int inputs_write(const char *path, const char *folder) {
    struct boltzmann_table table;
    int outcome = boltzmann_read(&table, path);
    double *work = outcome == 0 ? memory_take_doubles(2 * table.rows) : NULL;
    outcome = work == NULL || write_spectrum(&table, folder, work) != 0 || write_transfer(&table, folder, work) != 0 ||
              write_glass(folder, "glass1", 1, 0.0) != 0 || write_glass(folder, "glass8", 2, 2.0 / 3.0) != 0;
    free(work);
    boltzmann_close(&table);
    return outcome;
}
