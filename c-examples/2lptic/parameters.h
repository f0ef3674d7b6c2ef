/*
 * Parameter files of 2LPTic, of its versions with primordial non-Gaussianity, and of N-GenIC: a key and a value a line, the rest
 * of the line and lines that begin with % or # being comments.
 *
 * A key that is not known here, or is there twice, is refused, and so is a file that lacks one that is needed. What the program
 * cannot do, warm dark matter and a second species, is refused where it is asked for.
 */

#ifndef PARAMETERS_H
#define PARAMETERS_H

enum { TEXT_LENGTH = 256 };

/* Centimetres in a Mpc, as those codes have it. */
#define CM_PER_MPC 3.085678e24

/* WhichSpectrum. Any other number than these is SPECTRUM_GAMMA, and so is SPECTRUM_TRANSFER in files without WhichTransfer. */
enum { SPECTRUM_TRANSFER = 0, SPECTRUM_EISENSTEIN_HU = 1, SPECTRUM_TABLE = 2, SPECTRUM_GAMMA = 3 };

/* WhichTransfer, read where WhichSpectrum is SPECTRUM_TRANSFER. */
enum { TRANSFER_NONE = 0, TRANSFER_EISENSTEIN_HU = 1, TRANSFER_TABLE = 2 };

/* Named by their keys. Lengths are in UnitLength_in_cm over h. */
struct parameters {
    long n_mesh, n_sample, glass_tile_fac, glass_sample_numerator, glass_sample_denominator;
    long seed, sphere_mode, which_spectrum, which_transfer, renormalise_input_spectrum, num_files;
    long fixed_amplitude, phase_flip, wdm_on, wdm_vtherm_on;
    double box, omega, omega_lambda, omega_baryon, omega_2nd_species, hubble_param, redshift;
    double sigma8, shape_gamma, primordial_index, f_nl, wdm_mass;
    double unit_length, unit_mass, unit_velocity, input_spectrum_unit_length;
    char file_base[TEXT_LENGTH], output_dir[TEXT_LENGTH];
    char glass_file[TEXT_LENGTH]; /* empty for the lattice of the mesh */
    char spectrum_file[TEXT_LENGTH], transfer_file[TEXT_LENGTH];
};

/* Reads and checks a file. Returns 0, or 1 after saying all that is wrong. */
int parameters_read(struct parameters *parameters, const char *path);

#endif
