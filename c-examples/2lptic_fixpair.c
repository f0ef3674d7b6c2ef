/*
 * Initial conditions from a parameter file of 2LPTic, of its versions with primordial non-Gaussianity, or of N-GenIC: the same
 * file in, the same universe in the same Gadget files out, and Fixed, Paired and Matched ones.
 *
 *     2lptic_fixpair [flags] PARAMETERFILE
 *
 * Keys beyond those of 2LPTic, all optional: FixedAmplitude, PhaseFlip (0 or 1), Fnl, WhichTransfer, FileWithInputTransfer. What
 * those codes decide when they are compiled, flags do:
 *
 *     --shape NAME    of Fnl: local (the default), equilateral, orthogonal, orthogonal-lss, folded
 *     --zeldovich     first order alone (ONLY_ZA)
 *     --third         third order as well
 *     --dealias       products free of aliasing, which those codes let alias
 *     --files N       as many files as N MPI processes would write; else NumFilesWrittenInParallel, the fewest that 2LPTic runs with
 *     --long-ids      ids of 8 bytes even where 4 suffice
 *     --threads N     1 by default; any number gives the same bits
 *
 * docs/adding-fixpair-to-your-code.md says what is equal to those codes, to how much, and what is not.
 */

/* mkdir */
#define _POSIX_C_SOURCE 200112L

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "2lptic/parameters.h"
#include "2lptic/snapshot.h"
#include "2lptic/universe.h"
#include "check.h"
#include "options.h"

struct options {
    const char *path;
    struct choices choices;
    uint64_t files; /* 0 for what the file says */
    int long_ids;
};

static const struct {
    const char *name;
    int32_t shape;
} shapes[] = {
    {"local", FIXPAIR_SHAPE_LOCAL},
    {"equilateral", FIXPAIR_SHAPE_EQUILATERAL},
    {"orthogonal", FIXPAIR_SHAPE_ORTHOGONAL},
    {"orthogonal-lss", FIXPAIR_SHAPE_ORTHOGONAL_LSS},
    {"folded", FIXPAIR_SHAPE_FOLDED},
};

static int read_shape(int32_t *shape, const char *name) {
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (strcmp(shapes[i].name, name) == 0) {
            *shape = shapes[i].shape;
            return 0;
        }
    }
    return 1;
}

/* One flag, or the file. Returns how many arguments it took; 0 if it is wrong. */
static int read_argument(struct options *options, const char *flag, const char *value) {
    struct choices *choices = &options->choices;
    uint64_t threads;
    if (strcmp(flag, "--zeldovich") == 0) {
        choices->order = FIXPAIR_ORDER_FIRST;
    } else if (strcmp(flag, "--third") == 0) {
        choices->order = FIXPAIR_ORDER_THIRD;
    } else if (strcmp(flag, "--dealias") == 0) {
        choices->dealias = 1;
    } else if (strcmp(flag, "--long-ids") == 0) {
        options->long_ids = 1;
    } else if (flag[0] != '-' && options->path == NULL) {
        options->path = flag;
    } else if (value == NULL) {
        return 0;
    } else if (strcmp(flag, "--shape") == 0) {
        return read_shape(&choices->shape, value) == 0 ? 2 : 0;
    } else if (strcmp(flag, "--files") == 0) {
        return option_whole(&options->files, value, 1.0, 1e5) == 0 ? 2 : 0;
    } else if (strcmp(flag, "--threads") == 0) {
        if (option_whole(&threads, value, 1.0, 4096.0) != 0) return 0;
        choices->threads = (size_t)threads;
        return 2;
    } else {
        return 0;
    }
    return 1;
}

static int read_options(struct options *options, int argc, char **argv) {
    memset(options, 0, sizeof *options);
    options->choices.shape = FIXPAIR_SHAPE_LOCAL;
    options->choices.order = FIXPAIR_ORDER_SECOND;
    options->choices.threads = 1;
    for (int i = 1; i < argc;) {
        int taken = read_argument(options, argv[i], i + 1 < argc ? argv[i + 1] : NULL);
        if (taken == 0) fprintf(stderr, "%s: no such flag, or a wrong value\n", argv[i]);
        if (taken == 0) return 1;
        i += taken;
    }
    if (options->path != NULL) return 0;
    fprintf(stderr, "usage: %s [--shape NAME] [--zeldovich|--third] [--dealias] [--files N] [--long-ids] [--threads N] PARAMETERFILE\n",
            argv[0]);
    return 1;
}

static void report(const struct universe *universe, size_t files) {
    const struct parameters *p = universe->parameters;
    double square = 0.0, box = universe->conditions.box_size;
    for (size_t i = 0; i < 3 * universe->glass.count; i++) {
        double moved = universe->position[i] - box * glass_coordinate(&universe->glass, i / 3, i % 3);
        moved -= box * floor(moved / box + 0.5);
        square += moved * moved;
    }
    printf("%s/%s: %lu particles in %lu file%s, z = %g, moved by %.5g Mpc/h r.m.s.; %s amplitudes, %s phases, Fnl = %g\n",
           p->output_dir, p->file_base, (unsigned long)universe->glass.count, (unsigned long)files, files == 1 ? "" : "s at most",
           p->redshift, sqrt(square / (double)universe->glass.count), p->fixed_amplitude ? "fixed" : "normal",
           p->phase_flip ? "inverted" : "original", p->f_nl);
}

static int run(const struct options *options, const struct parameters *parameters, struct universe *universe) {
    size_t files = options->files > 0 ? (size_t)options->files : (size_t)parameters->num_files;
    TRY(universe_open(universe, parameters, &options->choices));
    TRY(universe_make(universe));
    if (mkdir(parameters->output_dir, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", parameters->output_dir, strerror(errno));
        return 1;
    }
    TRY(snapshot_write(parameters, &universe->glass, universe->position, universe->velocity, files, options->long_ids));
    TRY(snapshot_write_spectrum(parameters, &universe->conditions, universe->growth));
    report(universe, files);
    return 0;
}

int main(int argc, char **argv) {
    struct options options;
    struct parameters parameters;
    struct universe universe;
    memset(&universe, 0, sizeof universe);
    if (read_options(&options, argc, argv) != 0 || parameters_read(&parameters, options.path) != 0) return EXIT_FAILURE;
    int broken = run(&options, &parameters, &universe);
    universe_close(&universe);
    return broken ? EXIT_FAILURE : EXIT_SUCCESS;
}
