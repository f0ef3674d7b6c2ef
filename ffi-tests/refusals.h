/*
 * The machine behind refusals.c. A subject is one function with one good call, all of whose memory lies in one arena with canaries
 * between the pieces. The machine spoils one argument at a time, calls, and asks for the exact status; then it asks
 * that no byte of the arena has changed: outputs, inputs, and canaries.
 */
#ifndef FIXPAIR_REFUSALS_H
#define FIXPAIR_REFUSALS_H

#include <float.h>
#include <math.h>

#include "hosts.h"

enum { ARENA = 1 << 19, REGIONS = 32, POINTERS = 14, LENGTHS = 8 };

/* The arguments of any function of the library. */
typedef struct {
    void *p[POINTERS];
    size_t n[LENGTHS];
    double d[6];
    int32_t i[2];
    uint64_t u, v, w;
} arguments;

typedef fixpair_status_t (*call_function)(const arguments *);

typedef enum { NONE, OUT, IN, WORK, EXEC } role;

/* What a length may be: as it is, as it is or more, as scratch asks, or anything. */
typedef enum { EXACT, LEAST, SCRATCH, FREE } rule;

typedef struct {
    role role;
    int optional;
    size_t size, align;
} slot;

static struct {
    const char *name;
    call_function call;
    arguments a, good;
    slot slots[POINTERS];
    rule rules[LENGTHS];
    int lengths[LENGTHS];
    /* Parts of the arena that a call may write: scratch, and outputs. */
    struct {
        size_t start, size;
        role role;
    } regions[REGIONS];
    int region_count;
    size_t used;
    unsigned char *memory, *pristine, *before;
} t;

static void begin(const char *name, call_function call) {
    int i;
    t.name = name;
    t.call = call;
    memset(&t.a, 0, sizeof t.a);
    memset(t.slots, 0, sizeof t.slots);
    for (i = 0; i < LENGTHS; i++) {
        t.lengths[i] = 0;
    }
    t.region_count = 0;
    t.used = 0;
    memset(t.memory, CANARY_BYTE, ARENA);
}

/* Memory of the arena, on a cache line, zeros, with a canary after it. */
static void *lay(size_t size, role role) {
    size_t start = t.used + CANARY;
    t.used = start + (size + CANARY - 1) / CANARY * CANARY;
    if (t.used + CANARY > ARENA || t.region_count == REGIONS) {
        printf("the arena is too small for %s\n", t.name);
        exit(2);
    }
    memset(t.memory + start, 0, size);
    if (role == OUT || role == WORK) {
        t.regions[t.region_count].start = start;
        t.regions[t.region_count].size = size;
        t.regions[t.region_count++].role = role;
    }
    return t.memory + start;
}

/* Argument p[pointer]. */
static void *argument(int pointer, role role, size_t size, size_t align) {
    t.slots[pointer].role = role;
    t.slots[pointer].size = size;
    t.slots[pointer].align = align;
    t.slots[pointer].optional = role == EXEC;
    return t.a.p[pointer] = lay(size, role == EXEC ? IN : role);
}

#define STRUCT(pointer, role, type) ((type *)argument(pointer, role, sizeof(type), sizeof(void *)))
#define ARRAY(pointer, role, type, count) ((type *)argument(pointer, role, (count) * sizeof(type), sizeof(type)))
#define SCRATCH_OF(pointer, size) argument(pointer, WORK, size, 64)

static void length(int number, size_t value, rule rule) {
    t.a.n[number] = value;
    t.rules[number] = rule;
    t.lengths[number] = 1;
}

static void restore(void) {
    memcpy(t.memory, t.pristine, ARENA);
    t.a = t.good;
}

/* Is the arena as it was before the call, but for scratch, and but for outputs where they may be written? */
static int untouched(int outputs_too) {
    int i;
    for (i = 0; i < t.region_count; i++) {
        if (t.regions[i].role == WORK || !outputs_too) {
            memcpy(t.before + t.regions[i].start, t.memory + t.regions[i].start, t.regions[i].size);
        }
    }
    /* The padding of structs that the library filled means nothing. */
    MEMORY_DEFINED(t.before, ARENA);
    MEMORY_DEFINED(t.memory, ARENA);
    return memcmp(t.before, t.memory, ARENA) == 0;
}

static void attempt(fixpair_status_t expected, int outputs_too, const char *what) {
    fixpair_status_t status;
    memcpy(t.before, t.memory, ARENA);
    status = t.call(&t.a);
    check_checks += 2;
    if (status != expected) {
        check_failures++;
        printf("%s: %s: status %d, not %d\n", t.name, what, (int)status, (int)expected);
    }
    if (!untouched(outputs_too)) {
        check_failures++;
        printf("%s: %s: touched memory\n", t.name, what);
    }
}

/* After `change` the function returns `code` and touches nothing. */
#define REFUSED(code, change)       \
    do {                            \
        restore();                  \
        change;                     \
        attempt(code, 1, #change);  \
    } while (0)

/* As REFUSED, where outputs are undefined. */
#define SPOILED(code, change)       \
    do {                            \
        restore();                  \
        change;                     \
        attempt(code, 0, #change);  \
    } while (0)

/* After `change` all is well. */
#define ACCEPTED(change) SPOILED(FIXPAIR_OK, change)

static void pointer_fault(fixpair_status_t code, int pointer, void *value, const char *what) {
    char text[96];
    restore();
    t.a.p[pointer] = value;
    snprintf(text, sizeof text, "pointer %d %s", pointer, what);
    attempt(code, 1, text);
}

static void length_fault(fixpair_status_t code, int number, size_t value, const char *what) {
    char text[96];
    restore();
    t.a.n[number] = value;
    snprintf(text, sizeof text, "length %d %s", number, what);
    attempt(code, 1, text);
}

static void overlap_faults(int first, int second) {
    const slot *a = &t.slots[first], *b = &t.slots[second];
    char *start = (char *)t.good.p[first];
    char text[64];
    /* What is only read may overlap, an executor too. */
    int a_read = a->role == IN || a->role == EXEC, b_read = b->role == IN || b->role == EXEC;
    if ((a_read && b_read) || b->role == NONE || a->size == 0) {
        return;
    }
    snprintf(text, sizeof text, "is pointer %d", first);
    pointer_fault(FIXPAIR_ERROR_OVERLAP, second, start, text);
    if (a->size > b->align && a->size % b->align == 0) {
        snprintf(text, sizeof text, "is the end of pointer %d", first);
        pointer_fault(FIXPAIR_ERROR_OVERLAP, second, start + a->size - b->align, text);
    }
}

/* What every function refuses: null, misaligned and overlapping pointers, short, long and huge lengths, loops that fail. */
static void refuse_pointers_and_lengths(void) {
    int i, j;
    memcpy(t.pristine, t.memory, ARENA);
    t.good = t.a;
    ACCEPTED((void)0);
    for (i = 0; i < POINTERS; i++) {
        const slot *slot = &t.slots[i];
        char *good = (char *)t.good.p[i];
        if (slot->role == NONE) {
            continue;
        }
        if (!slot->optional) {
            pointer_fault(FIXPAIR_ERROR_NULL, i, NULL, "null");
        }
        if (slot->align > 1) {
            pointer_fault(FIXPAIR_ERROR_ALIGNMENT, i, good + slot->align / 2, "misaligned");
        }
        for (j = 0; j < i; j++) {
            overlap_faults(j, i);
        }
        if (slot->role == EXEC) {
            fixpair_exec *exec = (fixpair_exec *)t.good.p[i];
            ACCEPTED(t.a.p[i] = NULL);
            REFUSED(FIXPAIR_ERROR_NULL, exec->parallel_for = NULL);
            SPOILED(FIXPAIR_ERROR_HOOK, exec->parallel_for = failing_for);
            SPOILED(FIXPAIR_ERROR_HOOK, exec->parallel_for = skipping_for);
        }
    }
    for (i = 0; i < LENGTHS; i++) {
        size_t good = t.good.n[i];
        if (!t.lengths[i]) {
            continue;
        }
        length_fault(FIXPAIR_ERROR_OVERFLOW, i, SIZE_MAX, "huge");
        if (t.rules[i] == EXACT || t.rules[i] == LEAST) {
            length_fault(FIXPAIR_ERROR_LENGTH, i, good - 1, "short");
        }
        if (t.rules[i] == EXACT) {
            length_fault(FIXPAIR_ERROR_LENGTH, i, good + 1, "long");
        }
        if (t.rules[i] == SCRATCH) {
            length_fault(FIXPAIR_ERROR_SCRATCH, i, good - 1, "short");
            length_fault(FIXPAIR_ERROR_SCRATCH, i, 0, "zero");
        }
    }
    restore();
}

/* A loop of the host's, serial. */
static int32_t serial_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    size_t i;
    (void)context;
    for (i = 0; i < count; i++) {
        body(argument, i);
    }
    return 0;
}

static void exec_at(int pointer) {
    fixpair_exec *exec = STRUCT(pointer, EXEC, fixpair_exec);
    exec->parallel_for = serial_for;
}

/*
 * Faults that many functions share
 */

static void refuse_bricks(fixpair_brick *brick) {
    int32_t other = 1 - brick->space;
    size_t n = brick->n;
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, brick->n = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, brick->n = n + 1);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, brick->n = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, brick->n = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, brick->n = ((size_t)1 << 21) + 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, brick->space = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, brick->space = INT32_MIN);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->space = other);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->start[0] = 1);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->start[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->count[1] = n + 1);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->count[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->stride[2] = 0);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->stride[0] = brick->stride[1]);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, brick->stride[0] = SIZE_MAX);
}

static void refuse_realisations(fixpair_realisation *realisation) {
    REFUSED(FIXPAIR_ERROR_VERSION, realisation->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, realisation->struct_size++);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->scheme = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->selection = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->amplitude = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->amplitude = -1);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->phase = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, realisation->nyquist = INT32_MAX);
}

static void refuse_cosmologies(fixpair_cosmology *c) {
    double *members = &c->omega_m;
    int i;
    REFUSED(FIXPAIR_ERROR_VERSION, c->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, c->struct_size++);
    for (i = 0; i < 9; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, members[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, members[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, members[i] = -(double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, members[i] = 1e300);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, c->omega_m = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, c->omega_m = -0.3);
    REFUSED(FIXPAIR_ERROR_RANGE, c->omega_r = -1e-5);
    REFUSED(FIXPAIR_ERROR_RANGE, c->omega_b = 0.3);
    REFUSED(FIXPAIR_ERROR_RANGE, c->h = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, c->t_cmb = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, c->omega_de = 3.0);
    REFUSED(FIXPAIR_ERROR_RANGE, c->w0 = 0.5);
}

static void refuse_laws(fixpair_force_law *law) {
    REFUSED(FIXPAIR_ERROR_VERSION, law->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, law->struct_size++);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->laplacian = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->laplacian = -1);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->gradient = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->gradient = INT32_MIN);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->window = 5);
    REFUSED(FIXPAIR_ERROR_CHOICE, law->window = -1);
    REFUSED(FIXPAIR_ERROR_RANGE, (law->window = FIXPAIR_WINDOW_CIC, law->window_power = 0));
    REFUSED(FIXPAIR_ERROR_RANGE, (law->window = FIXPAIR_WINDOW_CIC, law->window_power = 5));
    REFUSED(FIXPAIR_ERROR_RANGE, (law->window = FIXPAIR_WINDOW_CIC, law->window_power = -1));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, law->split_scale = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, law->split_scale = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, law->split_scale = -1.0);
}

/* `linear` has rows of P; its arrays lie in the arena. `out` is some output. */
static void refuse_linears(fixpair_linear *linear, void *out) {
    double *k = (double *)(uintptr_t)linear->k, *value = (double *)(uintptr_t)linear->value;
    REFUSED(FIXPAIR_ERROR_VERSION, linear->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, linear->source = 4);
    REFUSED(FIXPAIR_ERROR_CHOICE, linear->source = -1);
    REFUSED(FIXPAIR_ERROR_CHOICE, linear->normalisation = 4);
    REFUSED(FIXPAIR_ERROR_CHOICE, (linear->source = FIXPAIR_LINEAR_TRANSFER, linear->normalisation = FIXPAIR_NORMALISE_AS_GIVEN));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, linear->amount = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, (linear->normalisation = FIXPAIR_NORMALISE_AMPLITUDE, linear->amount = (double)INFINITY));
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, (linear->normalisation = FIXPAIR_NORMALISE_A_S, linear->amount = (double)NAN));
    REFUSED(FIXPAIR_ERROR_RANGE, linear->amount = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, (linear->normalisation = FIXPAIR_NORMALISE_A_S, linear->amount = -1.0));
    REFUSED(FIXPAIR_ERROR_RANGE, (linear->normalisation = FIXPAIR_NORMALISE_AMPLITUDE, linear->amount = -1.0));
    REFUSED(FIXPAIR_ERROR_NULL, linear->k = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, linear->value = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, linear->k = (double *)(void *)((char *)k + 4));
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, linear->value = (double *)(void *)((char *)value + 1));
    REFUSED(FIXPAIR_ERROR_OVERLAP, linear->k = (double *)out);
    REFUSED(FIXPAIR_ERROR_OVERLAP, linear->value = (double *)out);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, linear->rows = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_TABLE, linear->rows = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, linear->rows = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, k[3] = k[2]);
    REFUSED(FIXPAIR_ERROR_TABLE, k[3] = k[1]);
    REFUSED(FIXPAIR_ERROR_TABLE, k[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_TABLE, k[0] = -k[0]);
    REFUSED(FIXPAIR_ERROR_TABLE, value[ROWS - 1] = 0.0);
    REFUSED(FIXPAIR_ERROR_TABLE, value[2] = -1.0);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, value[2] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, k[ROWS - 1] = (double)INFINITY);
}

/* A cosmology and a spectrum of rows at p[c] and p[c + 1]. */
static void spectrum_at(int c) {
    fixpair_cosmology *cosmology = STRUCT(c, IN, fixpair_cosmology);
    fixpair_linear *linear = STRUCT(c + 1, IN, fixpair_linear);
    double *k = (double *)lay(ROWS * sizeof *k, IN), *power = (double *)lay(ROWS * sizeof *power, IN);
    double transfer[ROWS];
    MUST(fixpair_cosmology_init(cosmology));
    fill_rows(k, power, transfer);
    linear->struct_size = sizeof *linear;
    linear->source = FIXPAIR_LINEAR_POWER;
    linear->normalisation = FIXPAIR_NORMALISE_SIGMA8;
    linear->amount = 0.8;
    linear->k = k;
    linear->value = power;
    linear->rows = ROWS;
}

#endif
