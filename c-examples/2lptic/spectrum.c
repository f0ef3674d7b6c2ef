#include "spectrum.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

#define PI 3.14159265358979323846

enum { ROWS_PER_DECADE = 256, INTERVALS = 1 << 14 };

/* Where fits are sampled, in h/Mpc. */
#define LEAST_K 1e-5
#define LARGEST_K 1e3

static int complain(const char *path, const char *what) {
    fprintf(stderr, "%s: %s\n", path, what);
    return 1;
}

static int is_fit_of_library(const struct parameters *parameters) {
    return parameters->which_spectrum == SPECTRUM_EISENSTEIN_HU ||
           (parameters->which_spectrum == SPECTRUM_TRANSFER && parameters->which_transfer == TRANSFER_EISENSTEIN_HU);
}

static int read_rows(struct spectrum *spectrum, const char *path, FILE *file) {
    int logarithms = spectrum->parameters->which_spectrum == SPECTRUM_TABLE;
    double k, value;
    size_t rows = 0, capacity = 0;
    while (fscanf(file, " %lf %lf ", &k, &value) == 2) {
        if (!logarithms) {
            if (!(k > 0.0 && value > 0.0)) return complain(path, "k or T is not positive");
            k = log10(k);
            value = log10(value);
        }
        if (!isfinite(k) || !isfinite(value)) return complain(path, "a number that is not finite");
        if (rows > 0 && k <= spectrum->table_k[rows - 1]) return complain(path, "k does not increase");
        if (rows == capacity) {
            capacity = capacity == 0 ? 1024 : 2 * capacity;
            double *more_k = realloc(spectrum->table_k, capacity * sizeof k);
            if (more_k != NULL) spectrum->table_k = more_k;
            double *more_values = realloc(spectrum->table_value, capacity * sizeof value);
            if (more_values != NULL) spectrum->table_value = more_values;
            if (more_k == NULL || more_values == NULL) return complain(path, "no memory left");
        }
        spectrum->table_k[rows] = k;
        spectrum->table_value[rows] = value;
        rows += 1;
    }
    spectrum->table_rows = rows;
    if (!feof(file)) return complain(path, "something that is not two numbers a line");
    return rows < 2 ? complain(path, "fewer than two rows") : 0;
}

static int read_table(struct spectrum *spectrum, const char *path) {
    FILE *file = fopen(path, "r");
    if (file == NULL) return complain(path, strerror(errno));
    int outcome = read_rows(spectrum, path, file);
    fclose(file);
    return outcome;
}

/* log10 of what the table holds at log10 k within it. */
static double interpolate(const struct spectrum *spectrum, double logk) {
    size_t low = 0, high = spectrum->table_rows - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (logk < spectrum->table_k[middle]) {
            high = middle;
        } else {
            low = middle;
        }
    }
    double u = (logk - spectrum->table_k[low]) / (spectrum->table_k[high] - spectrum->table_k[low]);
    return (1.0 - u) * spectrum->table_value[low] + u * spectrum->table_value[high];
}

/* P up to a factor, k in h/Mpc. */
static double shape(const struct spectrum *spectrum, double k) {
    const struct parameters *p = spectrum->parameters;
    double tilt = p->primordial_index, scale = p->unit_length / CM_PER_MPC;
    if (p->which_spectrum == SPECTRUM_GAMMA) {
        double a = 6.4 / p->shape_gamma * k, b = 3.0 / p->shape_gamma * k, c = 1.7 / p->shape_gamma * k, nu = 1.13;
        return pow(k, tilt) / pow(1.0 + pow(a + pow(b, 1.5) + c * c, nu), 2.0 / nu);
    }
    double value = pow(10.0, interpolate(spectrum, log10(k * (p->input_spectrum_unit_length / CM_PER_MPC))));
    if (p->which_spectrum == SPECTRUM_TRANSFER) return pow(k, tilt) * value * value;
    /* The tilt is that of k in the unit of the output, which matters only where nothing normalises. */
    return 2.0 * PI * PI * value / (k * k * k) * pow(k * scale, tilt - 1.0);
}

double spectrum_power(const struct spectrum *spectrum, double k) {
    return spectrum->factor * shape(spectrum, k);
}

/* sigma^2 in spheres of 8 Mpc/h, by Simpson's rule in ln k. */
static double variance(const struct spectrum *spectrum, double low, double high) {
    double sum = 0.0, step = log(high / low) / INTERVALS;
    for (int i = 0; i <= INTERVALS; i++) {
        /* The ends are those of the table, to the last bit. */
        double k = i == 0 ? low : i == INTERVALS ? high : low * exp(i * step), x = 8.0 * k;
        double window = x < 1e-2 ? 1.0 - x * x / 10.0 : 3.0 * (sin(x) - x * cos(x)) / (x * x * x);
        double weight = i == 0 || i == INTERVALS ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * k * k * k * shape(spectrum, k) * window * window;
    }
    return sum * step / 3.0 / (2.0 * PI * PI);
}

static void add_rows(struct spectrum *spectrum, double from, double to, int with_end) {
    int count = (int)ceil(ROWS_PER_DECADE * log10(to / from));
    for (int i = 0; i < count + with_end; i++) {
        spectrum->k[spectrum->rows++] = i == count ? to : from * pow(to / from, (double)i / count);
    }
}

/* Rows from `low` to the fundamental mode, at each mode of the mesh, and on to `high`. */
static int sample(struct spectrum *spectrum, double low, double high) {
    const struct parameters *p = spectrum->parameters;
    double fundamental = 2.0 * PI / (p->box * p->unit_length / CM_PER_MPC);
    size_t half = (size_t)p->n_mesh / 2, squares = 3 * half * half, room = squares + 16 * ROWS_PER_DECADE;
    room += (size_t)(ROWS_PER_DECADE * fabs(log10(high / low)));
    spectrum->k = memory_take_doubles(room);
    spectrum->power = memory_take_doubles(room);
    if (spectrum->k == NULL || spectrum->power == NULL) return 1;

    add_rows(spectrum, low, fundamental, 0);
    double k = fundamental;
    for (size_t square = 1; square <= squares && k <= high; square++) {
        spectrum->k[spectrum->rows++] = k;
        k = fundamental * sqrt((double)(square + 1));
    }
    if (k < high) add_rows(spectrum, k, high, 1);
    for (size_t i = 0; i < spectrum->rows; i++) spectrum->power[i] = spectrum_power(spectrum, spectrum->k[i]);
    return 0;
}

/* Are the modes that are drawn within the table? */
static int check_range(const struct spectrum *spectrum, const char *path, double low, double high) {
    const struct parameters *p = spectrum->parameters;
    double fundamental = 2.0 * PI / (p->box * p->unit_length / CM_PER_MPC), half = (double)(p->n_mesh / 2 - 1);
    double corner = sqrt(3.0) * fmin((double)(p->n_sample / 2), half);
    double most = fundamental * (p->sphere_mode == 1 ? fmin((double)(p->n_sample / 2), sqrt(3.0) * half) : corner);
    if (low < fundamental && most <= high) return 0;
    fprintf(stderr, "%s: %g to %g h/Mpc, where the box has modes of %g to %g\n", path, low, high, fundamental, most);
    return 1;
}

int spectrum_open(struct spectrum *spectrum, const struct parameters *parameters, double growth) {
    memset(spectrum, 0, sizeof *spectrum);
    spectrum->parameters = parameters;
    if (is_fit_of_library(parameters)) return 0;

    double low = LEAST_K, high = LARGEST_K;
    const char *path = "ShapeGamma";
    if (parameters->which_spectrum != SPECTRUM_GAMMA) {
        double unit = CM_PER_MPC / parameters->input_spectrum_unit_length;
        path = parameters->which_spectrum == SPECTRUM_TABLE ? parameters->spectrum_file : parameters->transfer_file;
        if (read_table(spectrum, path) != 0) return 1;
        /* Within the table whatever powers and logarithms round to. */
        low = pow(10.0, spectrum->table_k[0]) * unit * (1.0 + 1e-12);
        high = pow(10.0, spectrum->table_k[spectrum->table_rows - 1]) * unit * (1.0 - 1e-12);
    }
    if (check_range(spectrum, path, low, high) != 0) return 1;

    double most = fmin(high, 500.0 / 8.0), square = variance(spectrum, low, most);
    if (low >= most || !(square > 0.0) || !isfinite(square)) return complain(path, "has no finite Sigma8");
    spectrum->factor = parameters->sigma8 * parameters->sigma8 / square;
    if (!parameters->renormalise_input_spectrum) spectrum->factor = 1.0 / (growth * growth);
    return sample(spectrum, low, high);
}

void spectrum_close(struct spectrum *spectrum) {
    free(spectrum->table_k);
    free(spectrum->table_value);
    free(spectrum->k);
    free(spectrum->power);
    memset(spectrum, 0, sizeof *spectrum);
}

struct fixpair_linear spectrum_linear(const struct spectrum *spectrum) {
    struct fixpair_linear linear;
    int fit = spectrum->rows == 0;
    memset(&linear, 0, sizeof linear);
    linear.struct_size = sizeof linear;
    linear.source = fit ? FIXPAIR_LINEAR_EISENSTEIN_HU_SMOOTH : FIXPAIR_LINEAR_POWER;
    linear.normalisation = fit ? FIXPAIR_NORMALISE_SIGMA8 : FIXPAIR_NORMALISE_AS_GIVEN;
    linear.k = spectrum->k;
    linear.value = spectrum->power;
    linear.rows = spectrum->rows;
    linear.amount = spectrum->parameters->sigma8;
    return linear;
}
