#include "parameters.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind { WHOLE, REAL, TEXT };
enum need { OPTIONAL, NEEDED };
enum { LONGEST_LINE = 1024 };

struct key {
    const char *name;
    enum kind kind;
    enum need need;
    size_t offset;
};

#define KEY(name, kind, need, member) {name, kind, need, offsetof(struct parameters, member)}

/* Needed is what a universe cannot be made without; 2LPTic itself wants all of its keys in every file. */
static const struct key keys[] = {
    KEY("Nmesh", WHOLE, NEEDED, n_mesh),
    KEY("Nsample", WHOLE, NEEDED, n_sample),
    KEY("Box", REAL, NEEDED, box),
    KEY("FileBase", TEXT, NEEDED, file_base),
    KEY("OutputDir", TEXT, NEEDED, output_dir),
    KEY("GlassFile", TEXT, OPTIONAL, glass_file),
    KEY("GlassTileFac", WHOLE, OPTIONAL, glass_tile_fac),
    KEY("TileFac", WHOLE, OPTIONAL, glass_tile_fac),
    KEY("GlassTileFacSampleNumerator", WHOLE, OPTIONAL, glass_sample_numerator),
    KEY("GlassTileFacSampleDenom", WHOLE, OPTIONAL, glass_sample_denominator),
    KEY("Omega", REAL, NEEDED, omega),
    KEY("OmegaLambda", REAL, NEEDED, omega_lambda),
    KEY("OmegaBaryon", REAL, NEEDED, omega_baryon),
    KEY("OmegaDM_2ndSpecies", REAL, OPTIONAL, omega_2nd_species),
    KEY("HubbleParam", REAL, NEEDED, hubble_param),
    KEY("Redshift", REAL, NEEDED, redshift),
    KEY("Sigma8", REAL, NEEDED, sigma8),
    KEY("PrimordialIndex", REAL, NEEDED, primordial_index),
    KEY("ShapeGamma", REAL, OPTIONAL, shape_gamma),
    KEY("SphereMode", WHOLE, NEEDED, sphere_mode),
    KEY("WhichSpectrum", WHOLE, NEEDED, which_spectrum),
    KEY("FileWithInputSpectrum", TEXT, OPTIONAL, spectrum_file),
    KEY("InputSpectrum_UnitLength_in_cm", REAL, OPTIONAL, input_spectrum_unit_length),
    KEY("ReNormalizeInputSpectrum", WHOLE, OPTIONAL, renormalise_input_spectrum),
    KEY("WhichTransfer", WHOLE, OPTIONAL, which_transfer),
    KEY("FileWithInputTransfer", TEXT, OPTIONAL, transfer_file),
    KEY("Seed", WHOLE, NEEDED, seed),
    KEY("Fnl", REAL, OPTIONAL, f_nl),
    KEY("FixedAmplitude", WHOLE, OPTIONAL, fixed_amplitude),
    KEY("PhaseFlip", WHOLE, OPTIONAL, phase_flip),
    KEY("NumFilesWrittenInParallel", WHOLE, OPTIONAL, num_files),
    KEY("UnitLength_in_cm", REAL, NEEDED, unit_length),
    KEY("UnitMass_in_g", REAL, NEEDED, unit_mass),
    KEY("UnitVelocity_in_cm_per_s", REAL, NEEDED, unit_velocity),
    KEY("WDM_On", WHOLE, OPTIONAL, wdm_on),
    KEY("WDM_Vtherm_On", WHOLE, OPTIONAL, wdm_vtherm_on),
    KEY("WDM_PartMass_in_kev", REAL, OPTIONAL, wdm_mass),
};

enum { KEYS = sizeof keys / sizeof *keys };

static int complain(const char *path, const char *name, const char *what) {
    fprintf(stderr, "%s: %s: %s\n", path, name, what);
    return 1;
}

static const struct key *find(const char *name) {
    for (size_t i = 0; i < KEYS; i++) {
        if (strcmp(keys[i].name, name) == 0) return &keys[i];
    }
    return NULL;
}

/* Returns NULL, or what is wrong with the value. */
static const char *take(struct parameters *parameters, const struct key *key, const char *text) {
    char *end, *target = (char *)parameters + key->offset;
    if (key->kind == TEXT) {
        if (strlen(text) >= TEXT_LENGTH) return "longer than 255 characters";
        strcpy(target, text);
        return NULL;
    }
    double real = strtod(text, &end);
    /* A comment may follow at once. */
    if (end == text || (*end != '\0' && *end != '%') || !isfinite(real)) return "not a number";
    if (key->kind == REAL) {
        *(double *)(void *)target = real;
        return NULL;
    }
    if (real != floor(real) || fabs(real) > INT_MAX) return "not a whole number of 32 bits";
    *(long *)(void *)target = (long)real;
    return NULL;
}

/* One line; `seen` says which members have their value, by the index of the first key that fills them. */
static int take_line(struct parameters *parameters, const char *path, char *text, int *seen) {
    const char *blanks = " \t\r\n";
    char *name = strtok(text, blanks), *value = strtok(NULL, blanks);
    if (name == NULL || name[0] == '%' || name[0] == '#') return 0;
    const struct key *key = find(name);
    if (key == NULL) return complain(path, name, "no such key");
    if (value == NULL || value[0] == '%') return complain(path, name, "has no value");

    size_t member = 0;
    while (keys[member].offset != key->offset) member++;
    if (seen[member]) return complain(path, name, "is there twice");
    seen[member] = 1;
    const char *wrong = take(parameters, key, value);
    return wrong == NULL ? 0 : complain(path, name, wrong);
}

static int read_lines(struct parameters *parameters, const char *path, FILE *file) {
    char text[LONGEST_LINE];
    int seen[KEYS] = {0}, failures = 0;
    while (fgets(text, sizeof text, file) != NULL) {
        if (strchr(text, '\n') == NULL && !feof(file)) return complain(path, text, "a line of more than 1022 characters");
        failures += take_line(parameters, path, text, seen);
    }
    for (size_t i = 0; i < KEYS; i++) {
        if (keys[i].need == NEEDED && !seen[i]) failures += complain(path, keys[i].name, "is missing");
    }
    if (ferror(file)) failures += complain(path, "file", "the next line cannot be read");
    return failures > 0;
}

/* What the library checks itself (densities, redshift) is left to it. */
static int check(const struct parameters *p, const char *path) {
    const struct {
        int wrong;
        const char *name, *what;
    } rules[] = {
        {p->n_mesh < 2 || p->n_mesh % 2 != 0, "Nmesh", "must be even and positive"},
        {p->n_sample < 2, "Nsample", "must be 2 or more: modes with a component above Nsample/2 are left out"},
        {p->sphere_mode != 0 && p->sphere_mode != 1, "SphereMode", "must be 0 or 1"},
        {p->glass_tile_fac < 0, "GlassTileFac", "must be positive"},
        {p->glass_file[0] != '\0' && p->glass_tile_fac == 0, "GlassTileFac", "is missing, where a GlassFile is to be tiled"},
        {p->glass_sample_numerator != p->glass_sample_denominator, "GlassTileFacSampleNumerator", "samples of tiles are not supported"},
        {p->num_files < 1, "NumFilesWrittenInParallel", "must be 1 or more"},
        {!(p->box > 0.0), "Box", "must be positive"},
        {!(p->unit_length > 0.0), "UnitLength_in_cm", "must be positive"},
        {!(p->unit_mass > 0.0), "UnitMass_in_g", "must be positive"},
        {!(p->unit_velocity > 0.0), "UnitVelocity_in_cm_per_s", "must be positive"},
        {!(p->input_spectrum_unit_length > 0.0), "InputSpectrum_UnitLength_in_cm", "must be positive"},
        {!(p->sigma8 > 0.0), "Sigma8", "must be positive"},
        {!(p->shape_gamma > 0.0), "ShapeGamma", "must be positive"},
        {p->which_spectrum == SPECTRUM_TABLE && p->spectrum_file[0] == '\0', "FileWithInputSpectrum",
         "is missing, where WhichSpectrum is 2"},
        {p->which_spectrum != SPECTRUM_TRANSFER && p->which_transfer > TRANSFER_NONE, "WhichTransfer",
         "must be 0 unless WhichSpectrum is 0"},
        {p->which_transfer > TRANSFER_TABLE, "WhichTransfer", "must be 1 (Eisenstein & Hu) or 2 (table)"},
        {p->which_transfer == TRANSFER_TABLE && p->transfer_file[0] == '\0', "FileWithInputTransfer",
         "is missing, where WhichTransfer is 2"},
        {p->renormalise_input_spectrum == 0 && p->which_spectrum != SPECTRUM_TABLE, "ReNormalizeInputSpectrum",
         "may be 0 only with a table of the spectrum, WhichSpectrum 2"},
        {p->f_nl != 0.0 && p->which_spectrum == SPECTRUM_TABLE, "Fnl",
         "needs a transfer function, WhichSpectrum 0 or 1: a table of the spectrum does not say what part of its slope is primordial"},
        {p->fixed_amplitude != 0 && p->fixed_amplitude != 1, "FixedAmplitude", "must be 0 or 1"},
        {p->phase_flip != 0 && p->phase_flip != 1, "PhaseFlip", "must be 0 or 1"},
        {p->omega_2nd_species != 0.0, "OmegaDM_2ndSpecies", "a second species is not supported; make it 0"},
        {p->wdm_on != 0, "WDM_On", "warm dark matter is not supported; put its cut-off into the table of the spectrum, and 0 here"},
        {p->wdm_vtherm_on != 0 && p->wdm_on != 0, "WDM_Vtherm_On", "thermal velocities are not supported"},
    };
    int failures = 0;
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        if (rules[i].wrong) failures += complain(path, rules[i].name, rules[i].what);
    }
    return failures > 0;
}

int parameters_read(struct parameters *parameters, const char *path) {
    memset(parameters, 0, sizeof *parameters);
    parameters->glass_sample_numerator = parameters->glass_sample_denominator = 1;
    parameters->renormalise_input_spectrum = 1;
    parameters->num_files = 1;
    parameters->shape_gamma = 0.21;
    parameters->input_spectrum_unit_length = CM_PER_MPC;
    parameters->which_transfer = -1;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    int outcome = read_lines(parameters, path, file);
    fclose(file);
    if (outcome != 0) return 1;

    /* Without WhichTransfer this is a file of plain 2LPTic, whose other numbers all mean the fit by Gamma. */
    int plain = parameters->which_transfer < 0;
    if (parameters->which_spectrum < SPECTRUM_TRANSFER || parameters->which_spectrum > SPECTRUM_GAMMA ||
        (parameters->which_spectrum == SPECTRUM_TRANSFER && plain)) {
        parameters->which_spectrum = SPECTRUM_GAMMA;
    }
    if (plain) parameters->which_transfer = TRANSFER_NONE;
    if (parameters->which_spectrum == SPECTRUM_TRANSFER && parameters->which_transfer == TRANSFER_NONE) {
        return complain(path, "WhichTransfer", "must be 1 (Eisenstein & Hu) or 2 (table) where WhichSpectrum is 0");
    }
    return check(parameters, path);
}
