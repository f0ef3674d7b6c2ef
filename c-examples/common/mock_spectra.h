/*
 * Spectra of halos drawn from what one knows of them, without simulations: the universe and the scatter of Avila & Adame 2022
 * (arXiv:2204.11103). Whoever plans simulations sees what they would be worth; whoever analyses them, whether the analysis finds what was
 * put in.
 *
 * The bins of a simulation are independent. P + 1/n is distributed in each as an average of squares of Gaussian numbers, skewed as a
 * measured spectrum is where modes are few; its scatter is Eq. sigma_th for Normal simulations and Eq. sigma_fix with tab:fits for Fixed
 * ones, of which pairs have the scatter that tab:fits says of them.
 */

#ifndef MOCK_SPECTRA_H
#define MOCK_SPECTRA_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "matched.h"

struct mock_choice {
    double box_size;        /* Mpc/h; bins are one 2 pi/L wide */
    double density;         /* of halos, (h/Mpc)^3 */
    double highest;         /* k in h/Mpc below which bins end */
    double f_nl[2];         /* of both halves */
    struct fixpair_bias bias; /* b_g, p, delta_c; f_nl is not read */
    size_t seeds;
    uint64_t random;        /* another number, other mocks */
};

/* Box, halos and bias of the paper, 41 seeds. */
int mock_choice_init(struct mock_choice *choice);

/* tab:fits: what is left of the scatter of Fixed simulations, [0], and of their pairs, [1], at f_NL = 0 and 100. */
extern const struct fixpair_suppression mock_suppression[2][2];

/* What the draws are made with: by half for `power`, by amplitude and half for the others; a value a bin. */
struct mock_truth {
    double *alpha;
    double *power[2];
    double *sigma[2][2];
    double *sharing[2][2];    /* correlation of Original and Inverted */
    double matching[2][2];    /* correlation of both halves: by amplitude; [0] of averages of pairs, [1] of their differences */
};

/*
 * Draws spectra. `conditions` has cosmology, linear spectrum, redshift, and the convention of f_NL. Returns 0, or 1 after saying what is
 * wrong; matched_close and mock_truth_close in both cases, as of structs of zeros.
 */
int mock_draw(struct matched *matched, struct mock_truth *truth, const struct mock_choice *choice,
              const struct fixpair_conditions *conditions);

/* Covariance of bin b of both halves for a simulation, or for the average of a pair: of halves (0, 0), (0, 1), (1, 1). */
void mock_covariance(double covariance[3], const struct mock_truth *truth, int amplitude, int paired, size_t b);

void mock_truth_close(struct mock_truth *truth);

#endif
