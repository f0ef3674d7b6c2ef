/*
 * From P(k) of halos in matched simulations to the table of the paper: f_NL with its error for each type of initial conditions, and what
 * fixing, pairing and matching are worth (Avila & Adame 2022, arXiv:2204.11103, tab:fits and tab:rho).
 *
 *     05_matched_fnl TABLE...          spectra that somebody measured, as power_z1.csv of the example goliat; see common/matched.h
 *     05_matched_fnl --mock            spectra drawn from the paper's universe, and whether what was put in is found
 *     05_matched_fnl --help
 *
 * 05_matched_fnl.py does the same in Python.
 */

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boltzmann.h"
#include "check.h"
#include "constraints.h"
#include "fixpair.h"
#include "matched.h"
#include "matched_report.h"
#include "mock_claims.h"
#include "mock_spectra.h"
#include "options.h"

/* From the folder of the library, or from this one. */
static const char *const usual_tables[] = {"examples/data/camb_goliat_linear.txt", "../examples/data/camb_goliat_linear.txt"};

#define SIGMA8 0.8 /* of transfer functions, which have no amplitude; alpha does not depend on it */

struct options {
    struct constraints_choice analysis;
    struct mock_choice universe;
    double box_size;
    const char *linear, *table, *write;
    int mock;
    char **files;
    size_t files_len;
};

static void help(FILE *stream) {
    fputs("usage: 05_matched_fnl [options] TABLE...\n"
          "       05_matched_fnl [options] --mock\n\n"
          "TABLE is CSV, a row a simulation and bin, with the columns seed, amplitude (normal, fixed), phase (original, inverted), f_NL,\n"
          "k [h/Mpc], modes, linear P [(Mpc/h)^3], P of halos less shot noise [(Mpc/h)^3], halos: such as power_z1.csv of the example\n"
          "goliat.\n\n"
          "  --box L           Mpc/h; default: 1000\n"
          "  --redshift Z      of the halos; default: 1\n"
          "  --linear FILE     CAMB's or CLASS's P(k) or T(k) at z = 0; default: the library's own, camb_goliat_linear.txt\n"
          "  --omega-m O       of that file; default: 0.27. Flat\n"
          "  --n-s N           of that file; default: 0.96\n"
          "  --lss             f_NL in the LSS convention, not in that of the CMB\n"
          "  --k-scatter K     sigma_r is fitted below, h/Mpc; default: 0.4\n"
          "  --k-bias K        f_NL is fitted up to there, h/Mpc; default: 0.09\n"
          "  --measured        fit f_NL with the measured scatter, not with sigma_th and the fits of sigma_r\n"
          "  --table FILE      write all numbers as CSV\n\n"
          "  --mock            draw spectra: V = 1 (Gpc/h)^3, n = 2.5e-4, b_g = 2.32, f_NL = 0 and 100, scatter of tab:fits\n"
          "  --seeds N         how many; default: 41\n"
          "  --random R        other draws; default: 1. Claims allow 3 errors: in every fourth set of draws one of all fails by chance\n"
          "  --p P             of the mocks' halos; default: 0.9. The analysis supposes p = 1, as the paper's\n"
          "  --write FILE      write the mocks as such a TABLE\n",
          stream);
}

/* ---- Options. */

/* An option with a value. Returns 0 if both are known and sound. */
static int set(struct options *options, const char *name, const char *text) {
    struct constraints_choice *analysis = &options->analysis;
    uint64_t value = 0;
    int wrong = 0;
    if (strcmp(name, "--box") == 0) {
        wrong = option_number(&options->box_size, text, 1.0, 1e6);
    } else if (strcmp(name, "--redshift") == 0) {
        wrong = option_number(&analysis->redshift, text, 0.0, 1000.0);
    } else if (strcmp(name, "--omega-m") == 0) {
        wrong = option_number(&analysis->cosmology.omega_m, text, 0.01, 1.0);
        analysis->cosmology.omega_de = 1.0 - analysis->cosmology.omega_m;
    } else if (strcmp(name, "--n-s") == 0) {
        wrong = option_number(&analysis->cosmology.n_s, text, 0.5, 1.5);
    } else if (strcmp(name, "--k-scatter") == 0) {
        wrong = option_number(&analysis->highest_scatter, text, 1e-4, 100.0);
    } else if (strcmp(name, "--k-bias") == 0) {
        wrong = option_number(&analysis->highest_bias, text, 1e-4, 100.0);
    } else if (strcmp(name, "--seeds") == 0) {
        wrong = option_whole(&value, text, 8.0, 1e5);
        options->universe.seeds = (size_t)value;
    } else if (strcmp(name, "--random") == 0) {
        wrong = option_whole(&value, text, 0.0, 9007199254740992.0);
        options->universe.random = value;
    } else if (strcmp(name, "--p") == 0) {
        wrong = option_number(&options->universe.bias.p, text, -2.0, 2.0);
    } else if (strcmp(name, "--linear") == 0) {
        options->linear = text;
    } else if (strcmp(name, "--table") == 0) {
        options->table = text;
    } else if (strcmp(name, "--write") == 0) {
        options->write = text;
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
    if (constraints_choice_init(&options->analysis) != 0 || mock_choice_init(&options->universe) != 0) return 1 + EXIT_FAILURE;
    options->box_size = options->universe.box_size;
    FILE *table = fopen(usual_tables[1], "r");
    options->linear = usual_tables[table != NULL];
    if (table != NULL) fclose(table);
    for (i = 1; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            help(stdout);
            return 1 + EXIT_SUCCESS;
        } else if (strcmp(argv[i], "--mock") == 0) {
            options->mock = 1;
        } else if (strcmp(argv[i], "--measured") == 0) {
            options->analysis.measured = 1;
        } else if (strcmp(argv[i], "--lss") == 0) {
            options->analysis.convention = FIXPAIR_CONVENTION_LSS;
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
        fprintf(stderr, "%s: options come before tables\n", argv[i]);
        return 1 + EXIT_FAILURE;
    }
    if (options->mock == (options->files_len == 0) && (options->mock || options->write == NULL)) return 0;
    fprintf(stderr, "either tables or --mock, which alone can --write\n\n");
    help(stderr);
    return 1 + EXIT_FAILURE;
}

/* ---- Spectra in, constraints out. */

struct work {
    struct options options;
    struct boltzmann_table linear;
    struct matched matched;
    struct mock_truth truth;
    struct constraints constraints;
    int failures;
};

static int draw(struct work *work) {
    const struct constraints_choice *analysis = &work->options.analysis;
    struct mock_choice *universe = &work->options.universe;
    struct fixpair_conditions conditions;
    TRY(fixpair_conditions_init(&conditions, 0));
    conditions.cosmology = analysis->cosmology;
    conditions.linear = analysis->linear;
    conditions.redshift = analysis->redshift;
    conditions.convention = analysis->convention;
    universe->box_size = conditions.box_size = work->options.box_size;
    TRY(mock_draw(&work->matched, &work->truth, universe, &conditions));
    return work->options.write == NULL ? 0 : matched_write(&work->matched, work->options.write);
}

static int run(struct work *work) {
    struct options *options = &work->options;
    TRY(boltzmann_read(&work->linear, options->linear));
    options->analysis.linear = boltzmann_linear(&work->linear, SIGMA8);
    if (options->mock) TRY(draw(work));
    else TRY(matched_read(&work->matched, options->files, options->files_len, options->box_size));
    TRY(constraints_find(&work->constraints, &work->matched, &options->analysis));
    matched_report_print(&work->constraints, &work->matched);
    if (options->table != NULL) TRY(matched_report_write(&work->constraints, &work->matched, options->table));
    if (!options->mock) return 0;
    return mock_claims_check(&work->constraints, &work->matched, &work->truth, &options->universe, &work->failures);
}

int main(int argc, char **argv) {
    struct work work;
    memset(&work, 0, sizeof work);
    int leave = read_options(&work.options, argc, argv);
    if (leave != 0) return leave - 1;
    int broken = run(&work);
    constraints_close(&work.constraints);
    mock_truth_close(&work.truth);
    matched_close(&work.matched);
    boltzmann_close(&work.linear);
    return broken || work.failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
