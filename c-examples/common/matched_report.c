#include "matched_report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const matched_report_types[CONSTRAINTS_TYPES] = {"Normal", "Fixed", "Fixed-Paired", "Normal-Paired"};

/* Edges in k, h/Mpc, of the groups of bins that scatter is averaged over: one bin of 41 seeds is known to 11% only. */
static const double groups[] = {0.0, 0.03, 0.09, 0.2, 0.4};
enum { GROUPS = sizeof groups / sizeof *groups - 1 };

/* ---- For people. */

/* The quadratic mean of sigma/sigma_th. */
static void print_scatter(const struct constraints *constraints, const struct matched *matched) {
    printf("\nScatter per simulation over Gaussian theory, sigma/sigma_th\n%-14s %5s", "k [h/Mpc]", "f_NL");
    for (int g = 0; g < GROUPS; g++) printf("  %4.2f-%4.2f", groups[g], groups[g + 1]);
    printf("\n");
    for (int t = 0; t < CONSTRAINTS_TYPES; t++) {
        for (int h = 0; h < 2 && constraints->type[t].present; h++) {
            const struct constraints_half *half = &constraints->type[t].half[h];
            printf("%-14s %5g", matched_report_types[t], matched->f_nl[h]);
            for (int g = 0; g < GROUPS; g++) {
                double sum = 0.0, count = 0.0;
                for (size_t b = 0; b < matched->bins; b++) {
                    double ratio = half->sigma[b] / half->theory[b];
                    if (!(matched->k[b] >= groups[g] && matched->k[b] < groups[g + 1])) continue;
                    sum += ratio * ratio;
                    count += 1.0;
                }
                if (count > 0.0) printf("  %9.3f", sqrt(sum / count));
                else printf("  %9s", "--");
            }
            printf("\n");
        }
    }
}

static int was_fitted(const struct constraints_half *half) {
    return half->fit.degrees > 0;
}

static void print_fits(const struct constraints *constraints, const struct matched *matched) {
    /* tab:fits of Avila & Adame 2022, by type and half. */
    static const double paper[2][2][3] = {{{0.141, 0.114, 1.174}, {0.110, 0.110, 1.081}}, {{0.177, 0.224, 1.224}, {0.120, 0.156, 1.056}}};
    printf("\nFits of sigma_r to the scatter below the highest k [tab:fits of the paper, f_NL = 0 and 100]\n"
           "%-14s %5s  %-24s %-24s %-24s  chi^2/bins\n", "", "f_NL", "R_cv", "k_soft [h/Mpc]", "f_sn");
    for (int i = 0; i < 4; i++) {
        int t = i / 2 == 0 ? CONSTRAINTS_FIXED : CONSTRAINTS_FIXED_PAIRED, h = i % 2;
        const struct constraints_half *half = &constraints->type[t].half[h];
        const struct fixpair_suppression *value = &half->fit.value, *error = &half->fit.error;
        const double *known = paper[i / 2][h];
        if (!constraints->type[t].present || !was_fitted(half)) continue;
        printf("%-14s %5g  %.3f +- %.3f [%.3f]  %.3f +- %.3f [%.3f]  %.3f +- %.3f [%.3f]   %.0f/%lu\n", matched_report_types[t],
               matched->f_nl[h], value->cosmic_variance, error->cosmic_variance, known[0], value->softening, error->softening, known[1],
               value->shot_noise, error->shot_noise, known[2], half->fit.chi_squared, (unsigned long)constraints->scatter_bins);
    }
}

static void print_volume(double volume, double on_mean) {
    if (isnan(volume)) printf("  %12s", "--");
    else printf("  %5.1f [%4.1f]", volume, on_mean);
}

/* Pairs cost two simulations: their volumes are in the row below, where errors are per simulation. */
static void print_row(const struct constraints_type *type, const char *name) {
    const struct fixpair_difference *d = &type->difference;
    const struct fixpair_posterior *none = &type->half[0].on_mean, *some = &type->half[1].on_mean;
    int paired = type->simulations == 2;
    printf("%-14s %6.1f +- %5.1f  %6.1f +- %5.1f  %6.1f +- %5.1f  %6.1f +- %5.1f", name, d->mean_second, d->deviation_second, none->centre,
           none->half_width, d->mean_first, d->deviation_first, some->centre, some->half_width);
    print_volume(paired ? NAN : type->volume, type->volume_on_mean);
    printf("  %5.2f  %6.1f +- %4.1f  %6.1f +- %4.1f", d->correlation, d->mean, d->deviation, type->gauss, type->gauss_sigma);
    print_volume(paired ? NAN : type->matched_volume, type->matched_volume_on_mean);
    printf("\n");
    if (!paired) return;
    double r = sqrt(2.0);
    printf("%14s %6s +- %5.1f  %6s +- %5.1f  %6s +- %5.1f  %6s +- %5.1f", "x sqrt(2)", "", r * d->deviation_second, "",
           r * none->half_width, "", r * d->deviation_first, "", r * some->half_width);
    print_volume(type->volume, type->volume_on_mean);
    printf("  %5s  %6s +- %4.1f  %6s +- %4.1f", "", "", r * d->deviation, "", r * type->gauss_sigma);
    print_volume(type->matched_volume, type->matched_volume_on_mean);
    printf("\n");
}

static void print_table(const struct constraints *constraints, const struct matched *matched) {
    printf("\nf_NL of each simulation or pair, mean +- scatter; of the mean spectrum; V_eff/V over a Normal simulation by scatter "
           "[by the mean]\n");
    printf("%-14s %-15s  %-15s  %-15s  %-15s  %12s  %5s  %-14s  %-14s  %12s\n", "", "  <f0> +- std", "  Mean", "  <f1> +- std", "  Mean",
           "V_eff/V", "rho", " <f1 - f0>", " Gaussian", "V_eff/V");
    for (int t = 0; t < CONSTRAINTS_FITTED; t++) {
        if (constraints->type[t].present) print_row(&constraints->type[t], matched_report_types[t]);
    }
    printf("f0, f1: universes of f_NL = %g, %g\n", matched->f_nl[0], matched->f_nl[1]);
}

static void print_worth(const struct constraints *constraints, const struct matched *matched) {
    printf("\nMatched: f1 - beta f0, errors of the means of %lu; and p from f1, and from f1 - f0, mean +- scatter\n"
           "%-14s %-16s %-16s  %8s  %6s %-16s  %8s  %-16s %-16s\n", (unsigned long)matched->seeds, "", "  f1", "  beta = 1", "gain", "beta",
           "  optimal beta", "gain", "  p from f1", "  p from f1 - f0");
    for (int t = 0; t < CONSTRAINTS_FITTED; t++) {
        const struct constraints_type *type = &constraints->type[t];
        const struct fixpair_difference *d = &type->difference;
        if (!type->present) continue;
        printf("%-14s %7.2f +- %5.2f %7.2f +- %5.2f  %8.2f  %6.3f %7.2f +- %5.2f  %8.2f  %6.3f +- %5.3f  %6.3f +- %5.3f\n",
               matched_report_types[t], d->mean_first, d->deviation_first / sqrt((double)matched->seeds), d->mean, d->error_of_mean,
               type->difference_gain, type->control.beta, type->control.mean, type->control.error, type->control.gain, type->p[0],
               type->p_deviation[0], type->p[1], type->p_deviation[1]);
    }
    for (int t = 0; t < CONSTRAINTS_FITTED; t++) {
        const struct fixpair_difference *d = &constraints->type[t].difference;
        if (!constraints->type[t].present) continue;
        double off = d->mean_second / (d->deviation_second / sqrt((double)matched->seeds));
        if (fabs(off) < 3.0) continue;
        printf("%s: <f0> is %.1f errors from the 0 that the optimal beta supposes. Does the model hold up to the highest k?\n"
               "Trust beta = 1, from which drops out what both share\n", matched_report_types[t], off);
    }
    printf("\nErrors of V_eff/V, by bootstrap over seeds\n");
    for (int t = CONSTRAINTS_FIXED; t < CONSTRAINTS_FITTED; t++) {
        const struct constraints_type *type = &constraints->type[t];
        if (!type->present || isnan(type->volume)) continue;
        printf("%-14s %5.1f +- %4.1f, matched %5.1f +- %4.1f\n", matched_report_types[t], type->volume, type->volume_error,
               type->matched_volume, type->matched_volume_error);
    }
}

void matched_report_print(const struct constraints *constraints, const struct matched *matched) {
    printf("%lu seeds, V = (%g Mpc/h)^3, %.0f halos; %lu bins: %lu for the scatter, %lu for f_NL\n", (unsigned long)matched->seeds,
           matched->box_size, matched->halos[0], (unsigned long)matched->bins, (unsigned long)constraints->scatter_bins,
           (unsigned long)constraints->bias_bins);
    print_scatter(constraints, matched);
    print_fits(constraints, matched);
    print_table(constraints, matched);
    print_worth(constraints, matched);
}

/* ---- For programs. */

struct writer {
    FILE *file;
    const char *type;
    char f_nl[64];
};

/* NAN for what is not there. */
static void write_number(FILE *file, double value) {
    if (!isnan(value)) fprintf(file, "%.17g", value);
}

static void write_line(const struct writer *writer, double k, const char *quantity, double value, double error) {
    if (isnan(value)) return;
    fprintf(writer->file, "%s,%s,", writer->type, writer->f_nl);
    write_number(writer->file, k);
    fprintf(writer->file, ",%s,%.17g,", quantity, value);
    write_number(writer->file, error);
    fprintf(writer->file, "\n");
}

static void write_half(const struct writer *writer, const struct constraints_half *half, const struct matched *matched) {
    for (size_t b = 0; b < matched->bins; b++) {
        write_line(writer, matched->k[b], "sigma", half->sigma[b], half->error[b]);
        write_line(writer, matched->k[b], "sigma_th", half->theory[b], NAN);
        write_line(writer, matched->k[b], "sigma of an estimate", half->used[b], NAN);
    }
    if (was_fitted(half)) {
        write_line(writer, NAN, "R_cv", half->fit.value.cosmic_variance, half->fit.error.cosmic_variance);
        write_line(writer, NAN, "k_soft", half->fit.value.softening, half->fit.error.softening);
        write_line(writer, NAN, "f_sn", half->fit.value.shot_noise, half->fit.error.shot_noise);
        write_line(writer, NAN, "chi^2", half->fit.chi_squared, NAN);
    }
    if (half->f_nl == NULL) return;
    write_line(writer, NAN, "f of the mean", half->on_mean.centre, half->on_mean.half_width);
    write_line(writer, NAN, "peak of the mean", half->on_mean.peak, NAN);
}

static void write_type(const struct writer *zero, const struct writer *one, const struct writer *both,
                       const struct constraints_type *type) {
    const struct fixpair_difference *d = &type->difference;
    write_line(zero, NAN, "<f> +- std", d->mean_second, d->deviation_second);
    write_line(one, NAN, "<f> +- std", d->mean_first, d->deviation_first);
    write_line(one, NAN, "V_eff/V", type->volume, type->volume_error);
    write_line(one, NAN, "V_eff/V of the mean", type->volume_on_mean, NAN);
    write_line(one, NAN, "p", type->p[0], type->p_deviation[0]);
    write_line(both, NAN, "rho", d->correlation, d->correlation_error);
    write_line(both, NAN, "<f> +- std", d->mean, d->deviation);
    write_line(both, NAN, "Gaussian", type->gauss, type->gauss_sigma);
    write_line(both, NAN, "V_eff/V", type->matched_volume, type->matched_volume_error);
    write_line(both, NAN, "V_eff/V of the mean", type->matched_volume_on_mean, NAN);
    write_line(both, NAN, "p", type->p[1], type->p_deviation[1]);
    write_line(both, NAN, "gain of beta = 1", type->difference_gain, NAN);
    write_line(both, NAN, "f of the optimal beta", type->control.mean, type->control.error);
    write_line(both, NAN, "optimal beta", type->control.beta, NAN);
    write_line(both, NAN, "gain of the optimal beta", type->control.gain, NAN);
}

int matched_report_write(const struct constraints *constraints, const struct matched *matched, const char *path) {
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    fprintf(file, "type,f_NL,k [h/Mpc],quantity,value,error\n");
    for (int t = 0; t < CONSTRAINTS_TYPES; t++) {
        struct writer writers[3];
        if (!constraints->type[t].present) continue;
        for (int i = 0; i < 3; i++) {
            writers[i].file = file;
            writers[i].type = matched_report_types[t];
            if (i < 2) snprintf(writers[i].f_nl, sizeof writers[i].f_nl, "%g", matched->f_nl[i]);
            else snprintf(writers[i].f_nl, sizeof writers[i].f_nl, "%g-%g", matched->f_nl[1], matched->f_nl[0]);
            if (i < 2) write_half(&writers[i], &constraints->type[t].half[i], matched);
        }
        if (t < CONSTRAINTS_FITTED) write_type(&writers[0], &writers[1], &writers[2], &constraints->type[t]);
    }
    int broken = ferror(file);
    broken = fclose(file) != 0 || broken;
    if (broken) fprintf(stderr, "%s: cannot be written\n", path);
    return broken;
}
