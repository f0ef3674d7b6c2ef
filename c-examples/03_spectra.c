/*
 * Power spectrum and squeezed bispectrum of Gadget-2 files: those of 01_fixed_paired_png, or your own.
 *
 *     03_spectra [options] FILE...            03_spectra --help
 *
 * Prints P_0, P_2, P_4 in shells of one 2 pi/L, and B(Delta k, k, k) with counts of triangles, shot noise and the reduced Q, as
 * tables with commented columns; common/spectra does the measuring. With --claims the files of 01 are compared with linear
 * theory, one another, and the template of local non-Gaussianity. Exits with 0 only if all of it holds.
 */

/* mkdir */
#define _POSIX_C_SOURCE 200112L

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "check.h"
#include "claims.h"
#include "fixpair.h"
#include "gadget.h"
#include "memory.h"
#include "options.h"
#include "spectra.h"

#define PI 3.141592653589793

struct options {
    size_t mesh; /* 0: chosen */
    int32_t window;
    int plain, rsd, subtract_noise;
    double highest; /* 0: chosen */
    double width, unit; /* unit 0: found out */
    size_t threads;
    const char *counts, *tables, *claims;
    char **files;
    size_t files_len;
};

struct survey {
    struct options options;
    fixpair_threads *threads;
    struct fixpair_exec exec;
    struct spectra spectra;
    struct gadget_header header; /* of the first file, which the others have to match */
    double box_size;             /* Mpc/h */
    struct spectra_result *results;
    int failures;
};

static void help(FILE *stream) {
    fputs("usage: 03_spectra [options] FILE...\n\n"
          "P_0, P_2, P_4 about z and the squeezed bispectrum of Gadget-2 files (format 1, particles of type 1), all of one box.\n\n"
          "  --mesh N          cells on a side; default: twice the particles on a side\n"
          "  --window W        ngp, cic, tsc or pcs; default: tsc. For particles that still sit near a lattice pcs is better\n"
          "  --plain           one deposit in place of two interlaced ones\n"
          "  --highest K       largest k in h/Mpc; default: half the Nyquist frequency of the mesh\n"
          "  --width W         width of the bispectrum's shells in 2 pi/L; default: 3\n"
          "  --unit U          of lengths in the files, kpc or mpc (over h); default: what agrees with masses and omega_0\n"
          "  --rsd             redshift space: z moves by v_z/(a H)\n"
          "  --subtract-noise  Q of P and B less shot noise: for points that sample the field at random. The particles of\n"
          "                    initial conditions do not: they come from a lattice, and have none\n"
          "  --threads N       default: 2; results do not depend on it\n"
          "  --counts FILE     counts of triangles, read from there if they fit, else counted and written there\n"
          "  --tables FOLDER   write tables to NAME.power.txt and NAME.bispectrum.txt there, not to the output\n"
          "  --claims TABLE    compare the files of 01_fixed_paired_png with theory, for --window pcs; TABLE is the one 01 was given\n",
          stream);
}

/* ---- Options. */

static int choose(int32_t *choice, const char *text, const char *const *names, int32_t count) {
    for (*choice = 0; *choice < count; ++*choice) {
        if (strcmp(text, names[*choice]) == 0) return 0;
    }
    return 1;
}

/* An option with a value. Returns 0 if both are known and sound. */
static int set(struct options *options, const char *name, const char *text) {
    static const char *const windows[] = {"ngp", "cic", "tsc", "pcs"}, *const units[] = {"kpc", "mpc"};
    double value = 0.0;
    int32_t choice;
    int wrong = 0;
    if (strcmp(name, "--mesh") == 0) {
        wrong = option_number(&value, text, 8.0, 65536.0);
        options->mesh = (size_t)value;
        wrong = wrong || (double)options->mesh != value || fixpair_fft_next_side(options->mesh) != options->mesh;
        if (wrong) {
            fprintf(stderr, "sides are even, with factors 2, 3, 5, 7; the next is %lu\n",
                    (unsigned long)fixpair_fft_next_side(options->mesh));
        }
    } else if (strcmp(name, "--window") == 0) {
        wrong = choose(&choice, text, windows, 4);
        options->window = choice + FIXPAIR_WINDOW_NGP;
    } else if (strcmp(name, "--highest") == 0) {
        wrong = option_number(&options->highest, text, 1e-9, 1e9);
    } else if (strcmp(name, "--width") == 0) {
        wrong = option_number(&options->width, text, 1.0, 1e4);
    } else if (strcmp(name, "--unit") == 0) {
        wrong = choose(&choice, text, units, 2);
        options->unit = choice == 0 ? GADGET_KPC : GADGET_MPC;
    } else if (strcmp(name, "--threads") == 0) {
        wrong = option_number(&value, text, 1.0, 4096.0);
        options->threads = (size_t)value;
    } else if (strcmp(name, "--counts") == 0) {
        options->counts = text;
    } else if (strcmp(name, "--tables") == 0) {
        options->tables = text;
    } else if (strcmp(name, "--claims") == 0) {
        options->claims = text;
    } else {
        fprintf(stderr, "unknown option %s; see --help\n", name);
        return 1;
    }
    if (wrong) fprintf(stderr, "%s does not take %s; see --help\n", name, text);
    return wrong;
}

/* Returns 0 to go on, else what the program leaves with, plus 1. */
static int read_options(struct options *options, int argc, char **argv) {
    int i;
    memset(options, 0, sizeof *options);
    options->window = FIXPAIR_WINDOW_TSC;
    options->width = 3.0;
    options->threads = 2;
    for (i = 1; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            help(stdout);
            return 1 + EXIT_SUCCESS;
        } else if (strcmp(argv[i], "--plain") == 0) {
            options->plain = 1;
        } else if (strcmp(argv[i], "--rsd") == 0) {
            options->rsd = 1;
        } else if (strcmp(argv[i], "--subtract-noise") == 0) {
            options->subtract_noise = 1;
        } else if (i + 1 == argc) {
            fprintf(stderr, "%s wants a value, or is unknown; see --help\n", argv[i]);
            return 1 + EXIT_FAILURE;
        } else {
            if (set(options, argv[i], argv[i + 1]) != 0) return 1 + EXIT_FAILURE;
            i++;
        }
    }
    options->files = argv + i;
    options->files_len = (size_t)(argc - i);
    for (; i < argc; i++) {
        if (strncmp(argv[i], "--", 2) != 0) continue;
        fprintf(stderr, "%s: options come before files\n", argv[i]);
        return 1 + EXIT_FAILURE;
    }
    if (options->files_len > 0) return 0;
    help(stderr);
    return 1 + EXIT_FAILURE;
}

/* ---- From files to spectra. */

static int cosmology_of(struct fixpair_cosmology *cosmology, const struct gadget_header *header) {
    TRY(fixpair_cosmology_init(cosmology));
    cosmology->omega_m = header->omega_0;
    cosmology->omega_de = header->omega_lambda;
    cosmology->omega_r = 0.0;
    cosmology->h = header->hubble_param;
    return 0;
}

/* Mpc/h, in redshift space if asked: s = x + v/(a H) along z. Gadget stores v/sqrt(a), and H is 100 E(a) h km/s/Mpc. */
static int take_positions(double *position, const struct survey *survey, const struct gadget_file *file) {
    struct fixpair_cosmology cosmology;
    double a = file->header.time, e;
    TRY(cosmology_of(&cosmology, &file->header));
    TRY(fixpair_expansion(&e, &a, 1, &cosmology));
    double move = survey->options.rsd ? sqrt(a) / (a * 100.0 * e) : 0.0;
    for (size_t i = 0; i < 3 * file->count; i++) {
        position[i] = (double)file->position[i] / survey->options.unit + (i % 3 == 2 ? move * (double)file->velocity[i] : 0.0);
    }
    return 0;
}

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

/* The first file decides on box, mesh and shells. */
static int open_survey(struct survey *survey, const struct gadget_file *file) {
    struct options *options = &survey->options;
    struct spectra_choice choice;
    survey->header = file->header;
    if (options->unit == 0.0) options->unit = gadget_unit(&file->header);
    if (options->unit == 0.0) {
        fprintf(stderr, "%s: box and masses fit neither kpc/h nor Mpc/h; say --unit kpc or --unit mpc\n", options->files[0]);
        return 1;
    }
    survey->box_size = file->header.box_size / options->unit;
    choice.n = options->mesh;
    if (choice.n == 0) choice.n = fixpair_fft_next_side((size_t)ceil(2.0 * cbrt((double)file->count) - 1e-6));
    choice.box_size = survey->box_size;
    choice.window = options->window;
    choice.interlaced = !options->plain;
    choice.highest = options->highest > 0.0 ? options->highest : 0.5 * PI * (double)choice.n / survey->box_size;
    choice.width = options->width;
    choice.subtract_noise = options->subtract_noise;
    choice.progress = stderr;
    TRY(spectra_open(&survey->spectra, &choice, &survey->exec));

    struct spectra *spectra = &survey->spectra;
    if (options->counts != NULL && spectra_load_counts(spectra, options->counts) == 0) {
        fprintf(stderr, "counts of triangles: %s\n", options->counts);
        return 0;
    }
    fprintf(stderr, "counting triangles of %lu shells on %lu^3 cells\n", (unsigned long)spectra->wide.count, (unsigned long)choice.n);
    TRY(spectra_count(spectra));
    return options->counts == NULL ? 0 : spectra_save_counts(spectra, options->counts);
}

/* Counts depend on nothing but the geometry, and are numbers of modes: those in the file are those that are counted now. */
static int check_counts(struct survey *survey) {
    struct spectra *spectra = &survey->spectra;
    size_t shells = spectra->wide.count;
    if (survey->options.counts == NULL) return 0;
    uint64_t *counted = malloc(shells * sizeof *counted);
    if (counted == NULL) return 1;
    int broken = spectra_count(spectra);
    memcpy(counted, spectra->counts, shells * sizeof *counted);
    memset(spectra->counts, 0, shells * sizeof *counted);
    broken = broken || spectra_load_counts(spectra, survey->options.counts) != 0;
    survey->failures += claim(!broken && memcmp(counted, spectra->counts, shells * sizeof *counted) == 0,
                              "counts of triangles in %s are those of this mesh", survey->options.counts);
    free(counted);
    return broken;
}

static int measure_file(struct survey *survey, size_t which) {
    const char *path = survey->options.files[which];
    struct gadget_file file;
    fprintf(stderr, "%lu of %lu: %s\n", (unsigned long)which + 1, (unsigned long)survey->options.files_len, path);
    double *x = NULL;
    int broken = gadget_read(&file, path) != 0 || (which == 0 && open_survey(survey, &file) != 0);
    if (!broken && (file.header.box_size != survey->header.box_size || file.header.time != survey->header.time)) {
        broken = 1;
        fprintf(stderr, "%s: another box or redshift than %s; measure them apart\n", path, survey->options.files[0]);
    }
    broken = broken || (x = memory_take_doubles(3 * file.count)) == NULL || take_positions(x, survey, &file) != 0;
    size_t count = file.count;
    gadget_close(&file);
    if (!broken) {
        struct fixpair_positions_f64 position = {x, x + 1, x + 2, 3, count};
        broken = spectra_measure(&survey->spectra, &survey->results[which], &position);
    }
    free(x);
    return broken;
}

/* ---- Tables. */

static void print_power(FILE *stream, const struct survey *survey, const struct spectra_result *result) {
    const struct spectra_shells *shells = &survey->spectra.narrow;
    double k_f = 2.0 * PI / survey->box_size;
    fprintf(stream, "# shot noise is in P_0 only where points sample the field at random; it is not subtracted\n"
                    "# 1: k [h/Mpc]  2: modes  3, 4, 5: P_0, P_2, P_4 [(Mpc/h)^3]  6: shot noise V/N [(Mpc/h)^3]\n");
    for (size_t s = 0; s < shells->count; s++) {
        const double *p = result->power + 3 * s;
        fprintf(stream, "%9.6f %9llu %14.7g %14.7g %14.7g %12.5g\n", k_f * shells->bins[s].first,
                (unsigned long long)shells->bins[s].count, p[0], p[1], p[2], result->noise);
    }
}

static void print_bispectrum(FILE *stream, const struct survey *survey, const struct spectra_result *result) {
    const struct spectra_shells *shells = &survey->spectra.wide;
    double k_f = 2.0 * PI / survey->box_size;
    fprintf(stream, "# shot noise is in P and B only where points sample the field at random; it is subtracted %s\n"
                    "# 1, 2: Delta k, k [h/Mpc]  3: triangles  4: P(k) [(Mpc/h)^3]  5, 6: B(Delta k, k, k), its shot noise [(Mpc/h)^6]  "
                    "7: Q\n",
            survey->options.subtract_noise ? "in Q" : "nowhere");
    for (size_t s = 0; s < shells->count; s++) {
        fprintf(stream, "%9.6f %9.6f %12llu %14.7g %14.7g %12.5g %12.5g\n", k_f * shells->bins[0].first, k_f * shells->bins[s].first,
                (unsigned long long)survey->spectra.counts[s], result->wide_power[s], result->bispectrum[s],
                result->bispectrum_noise[s], result->reduced[s]);
    }
}

typedef void print_table(FILE *, const struct survey *, const struct spectra_result *);

/* To FOLDER/NAME.kind.txt, or to the output as blocks that gnuplot counts by `index`. */
static int write_table(const struct survey *survey, size_t which, const char *kind, print_table *print) {
    const char *folder = survey->options.tables, *name = base_name(survey->options.files[which]);
    FILE *stream = stdout;
    if (folder != NULL) {
        size_t length = strlen(folder) + strlen(name) + strlen(kind) + 8;
        char *path = malloc(length);
        if (path == NULL) return 1;
        snprintf(path, length, "%s/%s.%s.txt", folder, name, kind);
        if ((stream = fopen(path, "w")) == NULL) fprintf(stderr, "%s: %s\n", path, strerror(errno));
        free(path);
        if (stream == NULL) return 1;
    }
    fprintf(stream, "# %s of %s, z = %g, L = %g Mpc/h, %lu^3 cells%s\n", kind, survey->options.files[which], survey->header.redshift,
            survey->box_size, (unsigned long)survey->spectra.choice.n, survey->options.rsd ? ", redshift space" : "");
    print(stream, survey, &survey->results[which]);
    if (folder == NULL) return printf("\n\n") < 0;
    return fclose(stream) != 0;
}

static int run(struct survey *survey) {
    struct options *options = &survey->options;
    if (options->tables != NULL && mkdir(options->tables, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", options->tables, strerror(errno));
        return 1;
    }
    if ((survey->results = calloc(options->files_len, sizeof *survey->results)) == NULL) return 1;
    struct claims claims = {&survey->spectra, survey->results, options->files, options->files_len, 0.0, options->rsd, options->claims};
    if (options->claims != NULL) TRY(claims_ready(&claims));
    TRY(fixpair_threads_create(&survey->threads, &survey->exec, options->threads));
    for (size_t i = 0; i < options->files_len; i++) {
        TRY(measure_file(survey, i));
        TRY(write_table(survey, i, "power", print_power));
        TRY(write_table(survey, i, "bispectrum", print_bispectrum));
    }
    TRY(check_counts(survey));
    if (options->claims == NULL) return 0;
    claims.redshift = survey->header.redshift;
    return claims_check(&claims, &survey->failures);
}

int main(int argc, char **argv) {
    struct survey survey;
    memset(&survey, 0, sizeof survey);
    int leave = read_options(&survey.options, argc, argv);
    if (leave != 0) return leave - 1;
    int broken = run(&survey);
    for (size_t i = 0; survey.results != NULL && i < survey.options.files_len; i++) spectra_release(&survey.results[i]);
    free(survey.results);
    spectra_close(&survey.spectra);
    fixpair_threads_destroy(survey.threads);
    return broken || survey.failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
