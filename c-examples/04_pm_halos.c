/*
 * From a seed to halos on one process: fixed initial conditions, particle-mesh gravity, friends of friends.
 *
 *     04_pm_halos [options]            04_pm_halos --help
 *
 * At each redshift asked for, on the way by interpolation and at the end: the power spectrum of matter beside linear theory, a
 * catalogue of halos with the masses of spheres about them, and a picture. A checkpoint after each step, from which a run that was
 * stopped or killed goes on with the same bits. --by-hand runs the universe again through the kernels one by one, which is how a host
 * with a loop of its own calls them, and compares every bit. Exits with 0 only if all that must hold does.
 */

/* mkdir */
#define _POSIX_C_SOURCE 200112L

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "by_hand.h"
#include "check.h"
#include "fixpair.h"
#include "groups.h"
#include "matter.h"
#include "memory.h"
#include "options.h"
#include "picture.h"
#include "simulation.h"

/* Of P, by ten steps from z = 9: leapfrog loses 2%, COLA gains 1%, FastPM is exact. */
#define STEPPER_ERROR 0.02

enum { MOST_OUTPUTS = 16, PATH_LENGTH = 4096, PIXELS = 512, LARGEST = 2 };

struct options {
    struct simulation_choice choice;
    const char *folder, *resume;
    double outputs[MOST_OUTPUTS]; /* redshifts, the earliest first */
    size_t outputs_len, threads, stop;
    int pair, by_hand;
};

struct laboratory {
    struct options options;
    fixpair_threads *threads;
    struct fixpair_exec exec;
    struct simulation simulation;
    struct matter matter;
    struct groups groups;
    struct fixpair_outputs_f32 outputs;
    double output_times[MOST_OUTPUTS];
    float *output_position, *output_velocity;
    double growth[2][MOST_OUTPUTS + 1]; /* by phase, at the outputs and the end: see check_growth */
    int broken, failures;
};

static void help(FILE *stream) {
    fputs("usage: 04_pm_halos [options]\n\n"
          "  --particles N     on a side; default: 64\n"
          "  --mesh-factor B   cells over particles on a side, 1 to 3; default: 1\n"
          "  --box L           in Mpc/h; default: 128. In less than 100 even the largest modes do not grow as claimed\n"
          "  --steps N         equal in the scale factor; default: 10\n"
          "  --seed S          default: 1\n"
          "  --stepper S       fastpm, leapfrog or cola; default: fastpm\n"
          "  --start Z         redshift of the initial conditions; default: 9\n"
          "  --redshift Z      of the end; default: 0\n"
          "  --outputs Z,...   redshifts on the way, the earliest first; default: none\n"
          "  --pair            the inverted universe too\n"
          "  --by-hand         again, kernel by kernel: the same bits\n"
          "  --stop N          stop after step N, as if there were no more time\n"
          "  --resume FILE     go on from a checkpoint; all that shapes the run is in there\n"
          "  --output FOLDER   default: build/pm\n"
          "  --threads N       default: 2; results do not depend on it\n",
          stream);
}

/* ---- What is found in one universe at one time. */

static const char *phase_name(const struct simulation *simulation) {
    return simulation->choice.phase == FIXPAIR_PHASE_ORIGINAL ? "original" : "inverted";
}

/* FOLDER/original_z0.halos.csv; the file of a whole run has no redshift. */
static const char *path_of(char path[PATH_LENGTH], const struct laboratory *lab, double redshift, const char *what) {
    char when[32] = "";
    if (redshift >= 0.0) snprintf(when, sizeof when, "_z%g", redshift);
    snprintf(path, PATH_LENGTH, "%s/%s%s.%s", lab->options.folder, phase_name(&lab->simulation), when, what);
    return path;
}

/*
 * P over linear theory for the modes with |n| < 3, 1 in fixed initial conditions. Coupling to other modes changes it by some 0.1 D in
 * a box of 128 Mpc/h, to one side in a universe and to the other in its pair; by some 0.05 D^2 in both alike.
 */
static int check_growth(struct laboratory *lab, size_t output, const struct fixpair_conditions *conditions) {
    const struct matter *matter = &lab->matter;
    const double *original = lab->growth[FIXPAIR_PHASE_ORIGINAL], *inverted = lab->growth[FIXPAIR_PHASE_INVERTED];
    double redshift = conditions->redshift, a = 1.0 / (1.0 + redshift), modes = 0.0, ratio = 0.0;
    struct fixpair_growth growth;
    TRY(fixpair_growth_factors(&growth, &a, 1, &conditions->cosmology));
    for (size_t b = 0; b < LARGEST; b++) {
        modes += (double)matter->bins[b].count;
        ratio += (double)matter->bins[b].count * matter->power[b] / matter->theory[b];
    }
    ratio /= modes;
    lab->growth[lab->simulation.choice.phase][output] = ratio;
    lab->failures += claim(fabs(ratio - 1.0) < 0.3 * growth.d, "z = %g: P of the largest %.0f modes is %.4f of linear theory", redshift,
                           modes, ratio);
    if (original[output] == 0.0 || inverted[output] == 0.0) return 0;
    double mean = 0.5 * (original[output] + inverted[output]);
    lab->failures += claim(fabs(mean - 1.0) < 0.15 * growth.d * growth.d + STEPPER_ERROR, "z = %g: and %.4f on average over the pair",
                           redshift, mean);
    return 0;
}

static int analyse(struct laboratory *lab, const struct fixpair_components_f32 *position,
                   const struct fixpair_components_f32 *velocity, size_t output) {
    const struct simulation *simulation = &lab->simulation;
    struct fixpair_positions_f32 x = simulation_view(position), v = simulation_view(velocity);
    struct fixpair_conditions conditions = simulation->conditions;
    double box = conditions.box_size;
    double redshift = output < lab->options.outputs_len ? lab->options.outputs[output] : simulation->choice.end;
    struct picture picture = {PIXELS, (size_t)simulation->choice.n, 0.0, 0.0, 0.0};
    char path[PATH_LENGTH];
    picture.box_size = box;
    picture.depth = box / 8.0;
    conditions.redshift = redshift;
    TRY(matter_measure(&lab->matter, &x, &conditions));
    TRY(matter_write(&lab->matter, path_of(path, lab, redshift, "power.txt")));
    TRY(groups_find(&lab->groups, &x, &v, &conditions.cosmology, 1.0 / (1.0 + redshift)));
    TRY(groups_write(&lab->groups, path_of(path, lab, redshift, "halos.csv")));
    TRY(picture_write(&picture, &x, path_of(path, lab, redshift, "ppm")));
    lab->failures += groups_check(&lab->groups, redshift);
    return check_growth(lab, output, &conditions);
}

/* ---- The run. */

/* Told of each step and output by fixpair_evolve_f32. What it returns is whether to stop. */
static int32_t observe(void *context, const struct fixpair_progress *progress) {
    struct laboratory *lab = context;
    char path[PATH_LENGTH];
    /* A run ends after its step, which is told too: after an output that failed, the last checkpoint is from where it comes again. */
    if (lab->broken) return 1;
    if (progress->event == FIXPAIR_EVENT_OUTPUT) {
        lab->broken = analyse(lab, &lab->outputs.position, &lab->outputs.velocity, progress->output);
    } else {
        printf("    step %lu of %lu: z = %.3f\n", (unsigned long)progress->step, (unsigned long)progress->steps,
               1.0 / progress->epoch.position - 1.0);
        lab->broken = simulation_save(&lab->simulation, &progress->epoch, path_of(path, lab, -1.0, "checkpoint"));
    }
    return lab->broken || (progress->event == FIXPAIR_EVENT_STEP && progress->step == lab->options.stop);
}

/* The force of each particle attracts all others as they attract it: to the rounding of single precision nothing is gained. */
static void check_particles(struct laboratory *lab) {
    const struct simulation *simulation = &lab->simulation;
    double sum[3] = {0.0, 0.0, 0.0}, size = 0.0;
    size_t outside = 0;
    for (size_t i = 0; i < 3 * simulation->count; i++) {
        float x = simulation->memory[0][i], v = simulation->memory[1][i];
        outside += !(x >= 0.0f && x < simulation->choice.box_size);
        sum[i % 3] += v;
        size += fabs(v);
    }
    double drift = fmax(fabs(sum[0]), fmax(fabs(sum[1]), fabs(sum[2]))) / size;
    lab->failures += claim(outside == 0, "all %lu particles are in the box", (unsigned long)simulation->count);
    lab->failures += claim(drift < 1e-5, "their momenta cancel, to %.1e", drift);
}

/* ---- The same by hand. */

static int check_by_hand(struct laboratory *lab) {
    const struct simulation *simulation = &lab->simulation;
    size_t size = 3 * simulation->count * sizeof(float);
    struct simulation run;
    int broken = simulation_open(&run, &simulation->choice, &lab->exec) != 0 || simulation_begin(&run) != 0 || by_hand_evolve(&run) != 0;
    if (!broken) {
        int same = memcmp(run.memory[0], simulation->memory[0], size) == 0 && memcmp(run.memory[1], simulation->memory[1], size) == 0;
        lab->failures += claim(same, "by hand, kernel by kernel: the same particles, bit for bit");
    }
    simulation_close(&run);
    return broken;
}

/* ---- One universe, from its seed or its checkpoint. */

static void print_power(const struct matter *matter) {
    printf("\n%10s %12s %12s\n", "k h/Mpc", "P", "linear");
    for (size_t b = 0; b < matter->shells; b += matter->shells / 8 + 1) {
        printf("%10.4f %12.4f %12.4f\n", matter->k[b], matter->power[b], matter->theory[b]);
    }
    printf("\n");
}

/* All memory, and the particles that the run begins with. */
static int open_universe(struct laboratory *lab) {
    struct options *options = &lab->options;
    struct simulation *simulation = &lab->simulation;
    TRY(simulation_open(simulation, &options->choice, &lab->exec));
    TRY(matter_open(&lab->matter, &simulation->fft.hook, simulation->count, &lab->exec));
    TRY(groups_open(&lab->groups, simulation->count, options->choice.box_size, &simulation->conditions.cosmology, &lab->exec));
    if (options->outputs_len > 0) {
        if ((lab->output_position = memory_take_floats(3 * simulation->count)) == NULL) return 1;
        if ((lab->output_velocity = memory_take_floats(3 * simulation->count)) == NULL) return 1;
        for (size_t i = 0; i < options->outputs_len; i++) lab->output_times[i] = 1.0 / (1.0 + options->outputs[i]);
        lab->outputs.scale_factors = lab->output_times;
        lab->outputs.length = options->outputs_len;
        lab->outputs.position = simulation_triples(lab->output_position, simulation->count);
        lab->outputs.velocity = simulation_triples(lab->output_velocity, simulation->count);
    }
    printf("\n%s universe of seed %llu, %llu^3 particles\n\n", phase_name(simulation), (unsigned long long)options->choice.seed,
           (unsigned long long)options->choice.n);
    return options->resume == NULL ? simulation_begin(simulation) : simulation_load(simulation, options->resume);
}

static void close_universe(struct laboratory *lab) {
    simulation_close(&lab->simulation);
    matter_close(&lab->matter);
    groups_close(&lab->groups);
    free(lab->output_position);
    free(lab->output_velocity);
    lab->output_position = lab->output_velocity = NULL;
}

static int run_universe(struct laboratory *lab) {
    struct simulation *simulation = &lab->simulation;
    struct fixpair_observer observer = {lab, observe};
    char path[PATH_LENGTH];
    int32_t status = simulation_evolve(simulation, lab->options.outputs_len > 0 ? &lab->outputs : NULL, &observer);
    if (lab->broken) return 1;
    if (status == FIXPAIR_ERROR_STOPPED) {
        printf("\nstopped; --resume %s goes on\n", path_of(path, lab, -1.0, "checkpoint"));
        return 0;
    }
    TRY(status);
    TRY(simulation_save(simulation, &simulation->epoch, path_of(path, lab, -1.0, "checkpoint")));
    TRY(analyse(lab, &simulation->position, &simulation->velocity, lab->options.outputs_len));
    print_power(&lab->matter);
    check_particles(lab);
    return lab->options.by_hand ? check_by_hand(lab) : 0;
}

static int run(struct laboratory *lab) {
    struct options *options = &lab->options;
    int broken = 0;
    TRY(fixpair_threads_create(&lab->threads, &lab->exec, options->threads));
    for (int universe = 0; universe <= options->pair && !broken; universe++) {
        if (options->pair) options->choice.phase = universe == 0 ? FIXPAIR_PHASE_ORIGINAL : FIXPAIR_PHASE_INVERTED;
        broken = open_universe(lab) != 0 || run_universe(lab) != 0;
        close_universe(lab);
    }
    return broken;
}

/* ---- Options. */

static int list(struct options *options, const char *text) {
    char *end = "";
    for (options->outputs_len = 0; options->outputs_len < MOST_OUTPUTS; text = end + 1) {
        double redshift = strtod(text, &end);
        if (end == text || !(redshift >= 0.0) || (*end != ',' && *end != '\0')) return 1;
        options->outputs[options->outputs_len++] = redshift;
        if (*end == '\0') return 0;
    }
    return 1;
}

/* An option with a value. Returns 0 if both are known and sound. */
static int set(struct options *options, const char *name, const char *text) {
    static const char *const steppers[] = {"fastpm", "leapfrog", "cola"};
    struct simulation_choice *choice = &options->choice;
    uint64_t value = 0;
    char *end = "";
    int wrong = 0;
    if (strcmp(name, "--particles") == 0) {
        wrong = option_whole(&choice->n, text, 8.0, 1024.0);
    } else if (strcmp(name, "--mesh-factor") == 0) {
        wrong = option_whole(&choice->mesh_factor, text, 1.0, 3.0);
    } else if (strcmp(name, "--box") == 0) {
        wrong = option_number(&choice->box_size, text, 1.0, 1e5);
    } else if (strcmp(name, "--steps") == 0) {
        wrong = option_whole(&choice->steps, text, 1.0, 1e5);
    } else if (strcmp(name, "--seed") == 0) {
        choice->seed = strtoull(text, &end, 10);
        wrong = end == text || *end != '\0';
    } else if (strcmp(name, "--stepper") == 0) {
        for (choice->stepper = 0; choice->stepper < 3 && strcmp(text, steppers[choice->stepper]) != 0;) choice->stepper++;
        wrong = choice->stepper == 3;
    } else if (strcmp(name, "--start") == 0) {
        wrong = option_number(&choice->start, text, 0.0, 1000.0);
    } else if (strcmp(name, "--redshift") == 0) {
        wrong = option_number(&choice->end, text, 0.0, 1000.0);
    } else if (strcmp(name, "--outputs") == 0) {
        wrong = list(options, text);
    } else if (strcmp(name, "--stop") == 0) {
        wrong = option_whole(&value, text, 1.0, 1e5);
        options->stop = (size_t)value;
    } else if (strcmp(name, "--threads") == 0) {
        wrong = option_whole(&value, text, 1.0, 4096.0);
        options->threads = (size_t)value;
    } else if (strcmp(name, "--resume") == 0) {
        options->resume = text;
    } else if (strcmp(name, "--output") == 0) {
        options->folder = text;
    } else {
        fprintf(stderr, "unknown option %s; see --help\n", name);
        return 1;
    }
    if (wrong) fprintf(stderr, "%s does not take %s; see --help\n", name, text);
    return wrong;
}

/* What no option says alone. */
static int check_options(const struct options *options) {
    const struct simulation_choice *choice = &options->choice;
    size_t side = (size_t)(choice->n * choice->mesh_factor);
    int wrong = choice->start <= choice->end;
    for (size_t i = 0; i < options->outputs_len; i++) {
        double before = i == 0 ? choice->start : options->outputs[i - 1];
        wrong = wrong || options->outputs[i] <= choice->end || options->outputs[i] > before || (i > 0 && options->outputs[i] == before);
    }
    if (wrong) fprintf(stderr, "redshifts decrease from --start over --outputs to --redshift\n");
    if (fixpair_fft_next_side((size_t)choice->n) != choice->n || fixpair_fft_next_side(side) != side) {
        fprintf(stderr, "particles and cells on a side are even, with factors 2, 3, 5, 7\n");
        wrong = 1;
    }
    if (options->pair && options->resume != NULL) {
        fprintf(stderr, "a checkpoint is of one universe: --resume goes without --pair\n");
        wrong = 1;
    }
    if (strlen(options->folder) + 64 > PATH_LENGTH) {
        fprintf(stderr, "the path of the folder is too long\n");
        wrong = 1;
    }
    return wrong;
}

/* Returns 0 to go on, else what the program leaves with, plus 1. */
static int read_options(struct options *options, int argc, char **argv) {
    static const struct simulation_choice usual = {64, 1, 10, 1, 128.0, 9.0, 0.0, FIXPAIR_STEPPER_FASTPM, FIXPAIR_PHASE_ORIGINAL};
    memset(options, 0, sizeof *options);
    options->choice = usual;
    options->folder = "build/pm";
    options->threads = 2;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            help(stdout);
            return 1 + EXIT_SUCCESS;
        } else if (strcmp(argv[i], "--pair") == 0) {
            options->pair = 1;
        } else if (strcmp(argv[i], "--by-hand") == 0) {
            options->by_hand = 1;
        } else if (i + 1 == argc) {
            fprintf(stderr, "%s wants a value, or is unknown; see --help\n", argv[i]);
            return 1 + EXIT_FAILURE;
        } else {
            if (set(options, argv[i], argv[i + 1]) != 0) return 1 + EXIT_FAILURE;
            i++;
        }
    }
    if (options->resume != NULL && simulation_peek(&options->choice, options->resume) != 0) return 1 + EXIT_FAILURE;
    if (check_options(options) != 0) return 1 + EXIT_FAILURE;
    if (mkdir(options->folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", options->folder, strerror(errno));
        return 1 + EXIT_FAILURE;
    }
    return 0;
}

int main(int argc, char **argv) {
    struct laboratory lab;
    memset(&lab, 0, sizeof lab);
    int leave = read_options(&lab.options, argc, argv);
    if (leave != 0) return leave - 1;
    int broken = run(&lab);
    fixpair_threads_destroy(lab.threads);
    return broken || lab.failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
