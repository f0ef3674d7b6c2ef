/*
 * The reader of Boltzmann tables against small files in each format that it knows, and against files that are wrong: those have to
 * be refused with the line that is. Writes and removes check_boltzmann.txt in the working directory.
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boltzmann.h"
#include "check.h"

#define PATH "check_boltzmann.txt"

struct good {
    const char *format;
    const char *text;
    int32_t source;
    double value; /* of the second row */
};

struct bad {
    const char *what;
    const char *text;
};

/* Headers and number formats as the codes write them. */
static const struct good goods[] = {
    {"CAMB matter power", "#          k/h    P\n   0.1000E-03   0.4532E+03\n   0.2000E-03   0.8810E+03\n", FIXPAIR_LINEAR_POWER, 881.0},
    {"CLASS P(k)",
     "# Matter power spectrum P(k) at redshift z=0\n# for k=1e-05 to 10 h/Mpc,\n# number of wavenumbers equal to 2\n"
     "#    1:k (h/Mpc)               2:P (Mpc/h)^3\n     1.000000000000e-04      4.532000000000e+02\n"
     "     2.000000000000e-04      8.810000000000e+02\n",
     FIXPAIR_LINEAR_POWER, 881.0},
    {"the GOLIAT table", "# k T P(0) P(1) P(32)\n1e-4 1.0 453.2 176 0.7\n2e-4 0.99 881.0 342 1.4\n", FIXPAIR_LINEAR_POWER, 881.0},
    {"CAMB transfer, 7 columns", "1e-4 1 2 3 4 5 6.5e5\n2e-4 1 2 3 4 5 6.4e5\n", FIXPAIR_LINEAR_TRANSFER, 6.4e5},
    {"CAMB transfer, 13 columns",
     "#  k/h CDM baryon photon nu mass_nu total no_nu total_de Weyl v_CDM v_b v_b-v_c\n"
     "1e-4 1 2 3 4 0 6.5e5 8 9 -10 11 12 13\n2e-4 1 2 3 4 0 6.4e5 8 9 -10 11 12 13\n",
     FIXPAIR_LINEAR_TRANSFER, 6.4e5},
    {"a file from Windows, without a last newline", "\r\n1e-4\t453.2 # first\r\n2e-4\t881.0", FIXPAIR_LINEAR_POWER, 881.0},
};

static const struct bad bads[] = {
    {"a word", "1 2\n2 x\n"},
    {"a number with something behind it", "1 2\n2 3;\n"},
    {"NaN", "1 2\n2 nan\n"},
    {"three columns", "1 2 3\n2 3 4\n"},
    {"fourteen columns", "1 2 3 4 5 6 7 8 9 10 11 12 13 14\n"},
    {"rows of different length", "1 2\n2 3 4 5 6\n"},
    {"k that decreases", "1 2\n0.5 3\n"},
    {"k = 0", "0 2\n1 3\n"},
    {"negative P", "1 2\n2 -3\n"},
    {"one row", "1 2\n"},
    {"nothing", "# only a comment\n"},
    {"a CLASS spectrum of z = 10", "# Matter power spectrum P(k) at redshift z=10\n1 2\n2 3\n"},
};

static int write_text(const char *text) {
    FILE *file = fopen(PATH, "wb");
    int failed = file == NULL || fputs(text, file) < 0;
    if (file != NULL) failed |= fclose(file) != 0;
    if (failed) fprintf(stderr, "%s cannot be written\n", PATH);
    return failed;
}

static int check_good(const struct good *good) {
    struct boltzmann_table table;
    if (write_text(good->text) != 0) return 1;
    int read = boltzmann_read(&table, PATH) == 0 && table.rows == 2 && table.source == good->source && table.k[1] == 2e-4 &&
               table.value[1] == good->value;
    boltzmann_close(&table);
    return claim(read, "%s is read", good->format);
}

static int check_bad(const struct bad *bad) {
    struct boltzmann_table table;
    if (write_text(bad->text) != 0) return 1;
    int refused = boltzmann_read(&table, PATH) != 0;
    boltzmann_close(&table);
    return claim(refused, "%s is refused", bad->what);
}

/* The library takes what was read: a scale-free T(k) gets the sigma8 that it is asked for. */
static int check_sigma8(void) {
    struct boltzmann_table table;
    struct fixpair_cosmology cosmology;
    double sigma8 = 0.0;
    if (write_text("1e-4 0 0 0 0 0 1\n1e-2 0 0 0 0 0 0.5\n1e-1 0 0 0 0 0 0.05\n10 0 0 0 0 0 5e-5\n") != 0) return 1;
    if (boltzmann_read(&table, PATH) == 0 && fixpair_cosmology_init(&cosmology) == FIXPAIR_OK) {
        struct fixpair_linear linear = boltzmann_linear(&table, 0.8);
        fixpair_status_t status = fixpair_linear_sigma(&sigma8, 8.0, &cosmology, &linear);
        if (status != FIXPAIR_OK) report_status(__FILE__, __LINE__, status);
    }
    boltzmann_close(&table);
    return claim(fabs(sigma8 - 0.8) < 1e-7, "a transfer function is normalised to sigma8 = %.6f", sigma8);
}

int main(void) {
    int failures = 0;
    for (size_t i = 0; i < sizeof goods / sizeof *goods; i++) failures += check_good(&goods[i]);
    /* The messages are for people; here they go where the claims go, in order. */
    fflush(stdout);
    for (size_t i = 0; i < sizeof bads / sizeof *bads; i++) {
        failures += check_bad(&bads[i]);
        fflush(stdout);
    }
    failures += check_sigma8();
    remove(PATH);
    return failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
