#include "universe.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"
#include "options.h"

const char *const universe_usage =
    "  --particles N     on a side; default: 32\n"
    "  --mesh-factor B   cells over particles on a side, 1 to 3; default: 2\n"
    "  --box L           in Mpc/h; default: 32\n"
    "  --seed S          default: 1\n"
    "  --scheme N        FIXPAIR_SCHEME_...; default: 0\n"
    "  --amplitude N     FIXPAIR_AMPLITUDE_...; default: 1, fixed\n"
    "  --phase N         FIXPAIR_PHASE_...; default: 0\n"
    "  --f-nl F          default: 100\n"
    "  --g-nl G          default: 0\n"
    "  --order N         of perturbation theory; default: 2\n"
    "  --start Z         redshift of the initial conditions; default: 9\n"
    "  --redshift Z      of the end; default: 0\n"
    "  --steps N         equal in the scale factor; default: 8\n";

void universe_defaults(struct universe_choice *choice) {
    memset(choice, 0, sizeof *choice);
    choice->n = 32;
    choice->mesh_factor = 2;
    choice->steps = 8;
    choice->seed = 1;
    choice->scheme = FIXPAIR_SCHEME_NATIVE;
    choice->amplitude = FIXPAIR_AMPLITUDE_FIXED;
    choice->phase = FIXPAIR_PHASE_ORIGINAL;
    choice->order = FIXPAIR_ORDER_SECOND;
    choice->f_nl = 100.0;
    choice->box_size = 32.0;
    choice->start = 9.0;
}

static int whole(size_t *value, const char *text, double least, double most) {
    uint64_t number;
    int wrong = option_whole(&number, text, least, most);
    *value = (size_t)number;
    return wrong;
}

static int enumeration(int32_t *value, const char *text) {
    uint64_t number;
    int wrong = option_whole(&number, text, 0.0, 99.0);
    *value = (int32_t)number;
    return wrong;
}

int universe_option(struct universe_choice *choice, const char *name, const char *text) {
    if (strcmp(name, "particles") == 0) return whole(&choice->n, text, 2.0, 1024.0);
    if (strcmp(name, "mesh-factor") == 0) return whole(&choice->mesh_factor, text, 1.0, 3.0);
    if (strcmp(name, "steps") == 0) return whole(&choice->steps, text, 1.0, 1000.0);
    if (strcmp(name, "seed") == 0) return option_whole(&choice->seed, text, 0.0, 9e15);
    if (strcmp(name, "scheme") == 0) return enumeration(&choice->scheme, text);
    if (strcmp(name, "amplitude") == 0) return enumeration(&choice->amplitude, text);
    if (strcmp(name, "phase") == 0) return enumeration(&choice->phase, text);
    if (strcmp(name, "order") == 0) return enumeration(&choice->order, text);
    if (strcmp(name, "f-nl") == 0) return option_number(&choice->f_nl, text, -1e6, 1e6);
    if (strcmp(name, "g-nl") == 0) return option_number(&choice->g_nl, text, -1e9, 1e9);
    if (strcmp(name, "box") == 0) return option_number(&choice->box_size, text, 1.0, 1e6);
    if (strcmp(name, "start") == 0) return option_number(&choice->start, text, 0.0, 1e3);
    if (strcmp(name, "redshift") == 0) return option_number(&choice->end, text, 0.0, 1e3);
    return -1;
}

int universe_open(struct universe *universe, const struct universe_choice *choice) {
    struct fixpair_conditions *conditions = &universe->conditions;
    struct fixpair_gravity *gravity = &universe->gravity;
    memset(universe, 0, sizeof *universe);
    universe->choice = *choice;
    universe->particles = choice->n * choice->n * choice->n;
    TRY(fixpair_conditions_init(conditions, choice->seed));
    conditions->realisation.scheme = choice->scheme;
    conditions->realisation.amplitude = choice->amplitude;
    conditions->realisation.phase = choice->phase;
    conditions->order = choice->order;
    conditions->f_nl = choice->f_nl;
    conditions->g_nl = choice->g_nl;
    conditions->redshift = choice->start;
    conditions->box_size = choice->box_size;
    TRY(fixpair_gravity_init(gravity));
    gravity->cosmology = conditions->cosmology;
    gravity->box_size = choice->box_size;
    /* On one cell a particle the smoothing of deposit and read-out can be undone. Finer meshes see the lattice that particles start
       from, whose modes that would amplify. */
    if (choice->mesh_factor == 1) gravity->window = gravity->law.window = FIXPAIR_WINDOW_PCS;
    if ((universe->scale_factors = memory_take_doubles(choice->steps + 1)) == NULL) return 1;
    TRY(fixpair_linear_steps(universe->scale_factors, choice->steps + 1, 1.0 / (1.0 + choice->start), 1.0 / (1.0 + choice->end)));
    return 0;
}

void universe_close(struct universe *universe) {
    free(universe->scale_factors);
    memset(universe, 0, sizeof *universe);
}
