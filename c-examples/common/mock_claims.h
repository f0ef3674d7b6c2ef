/*
 * Does the analysis find what mock spectra were drawn from? What it should find of f_NL follows from the scatter and the correlations of the
 * bins, carried through the fit to first order.
 */

#ifndef MOCK_CLAIMS_H
#define MOCK_CLAIMS_H

#include "constraints.h"
#include "matched.h"
#include "mock_spectra.h"

/*
 * Prints claims and adds those that fail to *failures. Each allows three standard errors: of mocks of other random numbers some in a
 * thousand fail by chance. Returns 0, or 1 after saying what is wrong.
 */
int mock_claims_check(const struct constraints *constraints, const struct matched *matched, const struct mock_truth *truth,
                      const struct mock_choice *choice, int *failures);

#endif
