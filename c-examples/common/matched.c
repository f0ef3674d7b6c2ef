#include "matched.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "memory.h"

#define PI 3.14159265358979323846

/* Of 8 seeds a scatter is known to 27%. */
enum { FEWEST_SEEDS = 8, FEWEST_BINS = 4 };

const char *const matched_amplitudes[2] = {"normal", "fixed"}, *const matched_phases[2] = {"original", "inverted"};

static const char *const names[] = {"seed", "amplitude", "phase", "f_NL", "k [h/Mpc]", "modes", "linear P [(Mpc/h)^3]",
                                    "P of halos less shot noise [(Mpc/h)^3]", "halos"};
enum { SEED, AMPLITUDE, PHASE, F_NL, K, MODES, LINEAR, POWER, HALOS, NAMES };

/* A line of the table. */
struct row {
    uint64_t seed;
    int amplitude, phase;
    double f_nl, k, modes, linear, power, halos;
};

struct rows {
    struct row *row;
    size_t count, capacity;
};

int matched_open(struct matched *matched, size_t seeds, size_t bins, int present[2][2]) {
    memset(matched, 0, sizeof *matched);
    matched->seeds = seeds;
    matched->bins = bins;
    matched->seed = malloc(seeds * sizeof *matched->seed);
    matched->k = memory_take_doubles(bins);
    matched->modes = memory_take_doubles(bins);
    matched->linear = memory_take_doubles(bins);
    int broken = matched->seed == NULL || matched->k == NULL || matched->modes == NULL || matched->linear == NULL;
    for (int i = 0; i < 8; i++) {
        if (!present[i / 4][i / 2 % 2]) continue;
        double **power = &matched->power[i / 4][i / 2 % 2][i % 2];
        broken = (*power = memory_take_doubles(seeds * bins)) == NULL || broken;
    }
    return broken;
}

void matched_close(struct matched *matched) {
    free(matched->seed);
    free(matched->k);
    free(matched->modes);
    free(matched->linear);
    for (int i = 0; i < 8; i++) free(matched->power[i / 4][i / 2 % 2][i % 2]);
    memset(matched, 0, sizeof *matched);
}

/* ---- Reading. */

static int one_of(int *choice, const char *const options[2], const struct columns_place *place, const char *text) {
    for (*choice = 0; *choice < 2; ++*choice) {
        if (strcmp(text, options[*choice]) == 0) return 0;
    }
    return columns_complain(place, "\"%s\" is neither %s nor %s", text, options[0], options[1]);
}

static int whole_number(uint64_t *number, const struct columns_place *place, const char *text) {
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    *number = value;
    if (errno == 0 && end != text && *end == '\0' && text[0] != '-') return 0;
    return columns_complain(place, "\"%s\" is no number for a seed: it must be whole, 0 or more", text);
}

static int take_row(void *context, const struct columns_place *place, char *const *values) {
    struct rows *rows = context;
    struct row row;
    if (whole_number(&row.seed, place, values[SEED]) != 0) return 1;
    if (one_of(&row.amplitude, matched_amplitudes, place, values[AMPLITUDE]) != 0) return 1;
    if (one_of(&row.phase, matched_phases, place, values[PHASE]) != 0) return 1;
    double *const numbers[] = {&row.f_nl, &row.k, &row.modes, &row.linear, &row.power, &row.halos};
    for (int i = F_NL; i < NAMES; i++) {
        double *number = numbers[i - F_NL];
        if (columns_number(number, place, names[i], values[i]) != 0) return 1;
        if (i == F_NL || i == POWER || *number > 0.0) continue;
        return columns_complain(place, "\"%s\" in the column \"%s\", which must be positive", values[i], names[i]);
    }
    if (rows->count == rows->capacity) {
        size_t capacity = rows->capacity == 0 ? 1024 : 2 * rows->capacity;
        struct row *grown = realloc(rows->row, capacity * sizeof *grown);
        if (grown == NULL) return columns_complain(place, "no memory left");
        rows->row = grown;
        rows->capacity = capacity;
    }
    rows->row[rows->count++] = row;
    return 0;
}

static int order(double a, double b) {
    return (a > b) - (a < b);
}

/* By type, half, seed and k. |f_NL| first, so that the half nearer to 0 is the first one. */
static int by_simulation(const void *first, const void *second) {
    const struct row *a = first, *b = second;
    int by = a->amplitude - b->amplitude;
    if (by == 0) by = a->phase - b->phase;
    if (by == 0) by = order(fabs(a->f_nl), fabs(b->f_nl));
    if (by == 0) by = order(a->f_nl, b->f_nl);
    if (by == 0) by = (a->seed > b->seed) - (a->seed < b->seed);
    return by == 0 ? order(a->k, b->k) : by;
}

static int same_type(const struct row *a, const struct row *b) {
    return a->amplitude == b->amplitude && a->phase == b->phase;
}

static int same_simulation(const struct row *a, const struct row *b) {
    return same_type(a, b) && a->f_nl == b->f_nl && a->seed == b->seed;
}

static int complain(const struct row *row, const char *what) {
    fprintf(stderr, "seed %llu, %s %s, f_NL = %g: %s\n", (unsigned long long)row->seed, matched_amplitudes[row->amplitude],
            matched_phases[row->phase], row->f_nl, what);
    return 1;
}

/* Every simulation has the bins of the first. */
static int check_bins(const struct rows *rows, size_t *bins) {
    const struct row *row = rows->row;
    for (*bins = 1; *bins < rows->count && same_simulation(row, row + *bins); ++*bins) {
    }
    for (size_t i = 0; i < rows->count; i++) {
        const struct row *expected = row + i % *bins, *start = row + (i - i % *bins);
        if (i > 0 && same_simulation(row + i, row + i - 1) && row[i].k == row[i - 1].k) {
            return complain(row + i, "the same k twice; is the simulation in the table twice?");
        }
        if (!same_simulation(row + i, start) || (i % *bins == 0 && i > 0 && same_simulation(row + i, row + i - 1))) {
            return complain(start, "not as many bins as the other simulations");
        }
        if (row[i].k != expected->k || row[i].modes != expected->modes || row[i].linear != expected->linear) {
            return complain(row + i, "another k, number of modes or linear P than the other simulations: bin all alike");
        }
    }
    if (rows->count % *bins != 0) return complain(row + rows->count - 1, "not as many bins as the other simulations");
    if (*bins >= FEWEST_BINS) return 0;
    fprintf(stderr, "%lu bins are too few to fit anything; %d at least\n", (unsigned long)*bins, (int)FEWEST_BINS);
    return 1;
}

/* All seeds of the table, each once and increasing: as many as are returned. */
static size_t list_seeds(uint64_t *seed, const struct rows *rows, size_t bins) {
    size_t seeds = 0;
    for (size_t i = 0; i < rows->count; i += bins) {
        size_t place = 0;
        while (place < seeds && seed[place] < rows->row[i].seed) place++;
        if (place < seeds && seed[place] == rows->row[i].seed) continue;
        memmove(seed + place + 1, seed + place, (seeds - place) * sizeof *seed);
        seed[place] = rows->row[i].seed;
        seeds++;
    }
    return seeds;
}

/* 0 and another one. */
static int find_halves(double f_nl[2], const struct rows *rows) {
    int found = 0;
    f_nl[0] = f_nl[1] = 0.0;
    for (size_t i = 0; i < rows->count; i++) {
        double value = rows->row[i].f_nl;
        if (f_nl[1] == 0.0) f_nl[1] = value;
        found = found || value == 0.0;
        if (value != 0.0 && value != f_nl[1]) return complain(rows->row + i, "a third f_NL; matched are two, 0 and another");
    }
    if (found && f_nl[1] != 0.0) return 0;
    return complain(rows->row, "and no other f_NL in the table. Matched are the same seeds at two: at 0, where estimates are known "
                               "whatever p is, and at another");
}

/* Copies the simulations of one type and half, which follow each other from *i on, and moves *i to their end. */
static int take_simulations(struct matched *matched, const struct rows *rows, size_t *i, int amplitude, int phase, int half) {
    struct row wanted = {0, amplitude, phase, matched->f_nl[half], 0.0, 0.0, 0.0, 0.0, 0.0};
    for (size_t s = 0; s < matched->seeds; s++, *i += matched->bins) {
        const struct row *row = rows->row + *i;
        wanted.seed = matched->seed[s];
        if (*i == rows->count || !same_simulation(row, &wanted)) {
            return complain(&wanted, "missing. Matching needs every seed at both f_NL and in every type: add it, or take the seed out");
        }
        for (size_t b = 0; b < matched->bins; b++) matched->power[amplitude][phase][half][s * matched->bins + b] = row[b].power;
        matched->halos[half] += row->halos;
    }
    return 0;
}

/* Modes up to the last bin fill a sphere of the box's own grid: N = V k^3/(6 pi^2). */
static int check_box(const struct matched *matched) {
    size_t bins = matched->bins;
    double inside = 0.0;
    double width = (matched->k[bins - 1] - matched->k[0]) / (double)(bins - 1);
    double outer = matched->k[bins - 1] + 0.5 * width, inner = matched->k[0] - 0.5 * width;
    for (size_t b = 0; b < bins; b++) inside += matched->modes[b];
    double volume = inside * 6.0 * PI * PI / (outer * outer * outer - inner * inner * inner);
    if (fabs(volume / pow(matched->box_size, 3.0) - 1.0) < 0.25) return 0;
    fprintf(stderr, "k and modes are those of a box of %.0f Mpc/h, not of %g: say --box L. (Modes count k and -k.)\n", cbrt(volume),
            matched->box_size);
    return 1;
}

static int arrange(struct matched *matched, struct rows *rows, double box_size) {
    size_t bins, types = 0, place = 0;
    int present[2][2] = {{0, 0}, {0, 0}};
    double f_nl[2];
    if (rows->count == 0) {
        fprintf(stderr, "there is no simulation in the table\n");
        return 1;
    }
    qsort(rows->row, rows->count, sizeof *rows->row, by_simulation);
    if (check_bins(rows, &bins) != 0 || find_halves(f_nl, rows) != 0) return 1;
    for (size_t i = 0; i < rows->count; i++) present[rows->row[i].amplitude][rows->row[i].phase] = 1;
    uint64_t *seed = malloc(rows->count / bins * sizeof *seed);
    if (seed == NULL) return 1;
    size_t seeds = list_seeds(seed, rows, bins);
    int broken = matched_open(matched, seeds, bins, present);
    if (!broken) memcpy(matched->seed, seed, seeds * sizeof *seed);
    free(seed);
    if (broken) return 1;
    if (seeds < FEWEST_SEEDS) {
        fprintf(stderr, "%lu seeds are too few for a scatter; run %d at least. (It is known to 1/sqrt(2 (N - 1)): 27%% from 8, 11%% from "
                "41.)\n", (unsigned long)seeds, (int)FEWEST_SEEDS);
        return 1;
    }
    matched->box_size = box_size;
    memcpy(matched->f_nl, f_nl, sizeof f_nl);
    for (size_t b = 0; b < bins; b++) {
        matched->k[b] = rows->row[b].k;
        matched->modes[b] = rows->row[b].modes;
        matched->linear[b] = rows->row[b].linear;
    }
    for (int type = 0; type < 4; type++) {
        if (!present[type / 2][type % 2]) continue;
        types++;
        for (int half = 0; half < 2; half++) {
            if (take_simulations(matched, rows, &place, type / 2, type % 2, half) != 0) return 1;
        }
    }
    for (int half = 0; half < 2; half++) matched->halos[half] /= (double)(types * seeds);
    return check_box(matched);
}

int matched_read(struct matched *matched, char *const *paths, size_t paths_len, double box_size) {
    struct rows rows = {NULL, 0, 0};
    int broken = 0;
    memset(matched, 0, sizeof *matched);
    for (size_t i = 0; i < paths_len && !broken; i++) broken = columns_read(paths[i], names, NAMES, take_row, &rows);
    broken = broken || arrange(matched, &rows, box_size);
    free(rows.row);
    return broken;
}

/* ---- Writing. */

int matched_write(const struct matched *matched, const char *path) {
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    for (int i = 0; i < NAMES; i++) fprintf(file, "%s%c", names[i], i + 1 < NAMES ? ',' : '\n');
    for (size_t s = 0; s < matched->seeds; s++) {
        for (int i = 0; i < 8; i++) {
            const double *power = matched->power[i / 4][i / 2 % 2][i % 2];
            for (size_t b = 0; power != NULL && b < matched->bins; b++) {
                fprintf(file, "%llu,%s,%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", (unsigned long long)matched->seed[s],
                        matched_amplitudes[i / 4], matched_phases[i / 2 % 2], matched->f_nl[i % 2], matched->k[b], matched->modes[b],
                        matched->linear[b], power[s * matched->bins + b], matched->halos[i % 2]);
            }
        }
    }
    int broken = ferror(file);
    broken = fclose(file) != 0 || broken;
    if (broken) fprintf(stderr, "%s: cannot be written\n", path);
    return broken;
}
