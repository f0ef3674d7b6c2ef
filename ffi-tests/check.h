/*
 * What the programs of this folder share: the file of cases, hashes, memory with canaries around it, and a count of failures.
 * For C99 and C++11.
 */
#ifndef FIXPAIR_CHECK_H
#define FIXPAIR_CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixpair.h"

/* Around code of the host, in a hook too, that may allocate; allocations.h tells it from the library's. */
#ifndef HOST_ENTER
#define HOST_ENTER() ((void)0)
#define HOST_LEAVE() ((void)0)
#endif

/* What Valgrind's memcheck cannot know. */
#ifdef FIXPAIR_MEMCHECK
#include <valgrind/memcheck.h>
#define MEMORY_DEFINED(memory, size) ((void)VALGRIND_MAKE_MEM_DEFINED(memory, size))
#define MEMORY_UNDEFINED(memory, size) ((void)VALGRIND_MAKE_MEM_UNDEFINED(memory, size))
#else
#define MEMORY_DEFINED(memory, size) ((void)0)
#define MEMORY_UNDEFINED(memory, size) ((void)0)
#endif

static int check_failures = 0;
static int check_checks = 0;

/* Counts a claim, and says where it is false. */
#define CHECK(claim) check_claim((claim) ? 1 : 0, #claim, __FILE__, __LINE__)

static inline void check_claim(int holds, const char *claim, const char *file, int line) {
    check_checks++;
    if (!holds) {
        check_failures++;
        printf("%s:%d: not so: %s\n", file, line, claim);
    }
}

/* Stops the program where nothing sensible can follow. */
#define MUST(call)                                                                              \
    do {                                                                                        \
        fixpair_status_t must_status = (call);                                                  \
        if (must_status != FIXPAIR_OK) {                                                        \
            printf("%s:%d: %s: %s\n", __FILE__, __LINE__, #call, fixpair_status_message(must_status)); \
            exit(2);                                                                            \
        }                                                                                       \
    } while (0)

/* The last lines of main. */
static inline int check_report(const char *program) {
    printf("%s: %d checks, %d failures\n", program, check_checks, check_failures);
    return check_failures == 0 ? 0 : 1;
}

/*
 * Hashes and cases
 */

#define HASH_START UINT64_C(0xcbf29ce484222325)

/* FNV-1a of 64 bits, continued. */
static inline uint64_t hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *bytes = (const unsigned char *)data;
    size_t i;
    for (i = 0; i < size; i++) {
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static inline uint64_t hash_layout(uint64_t hash, fixpair_layout layout) {
    uint64_t numbers[2];
    numbers[0] = layout.size;
    numbers[1] = layout.align;
    return hash_bytes(hash, numbers, sizeof numbers);
}

/* The elements of `size` bytes of a brick, in the order of their indices. */
static inline uint64_t hash_brick(uint64_t hash, const void *data, const fixpair_brick *brick, size_t size) {
    const size_t *s = brick->stride;
    size_t a, b, c;
    if (brick->space == FIXPAIR_SPACE_FOURIER) {
        size *= 2;
    }
    for (a = 0; a < brick->count[0]; a++) {
        for (b = 0; b < brick->count[1]; b++) {
            for (c = 0; c < brick->count[2]; c++) {
                const char *at = (const char *)data + (a * s[0] + b * s[1] + c * s[2]) * size;
                hash = hash_bytes(hash, at, size);
            }
        }
    }
    return hash;
}

enum { MOST_CASES = 512 };

static struct {
    char name[64];
    uint64_t hash;
} cases[MOST_CASES];
static size_t case_count = 0;

/* Reads the cases that the Rust interface computed. */
static inline void read_cases(const char *path) {
    FILE *file = fopen(path, "r");
    unsigned long long hash;
    if (file == NULL) {
        printf("cannot open %s\n", path);
        exit(2);
    }
    while (case_count < MOST_CASES && fscanf(file, "%63s %llx", cases[case_count].name, &hash) == 2) {
        cases[case_count++].hash = (uint64_t)hash;
    }
    fclose(file);
}

/* Is this case's hash the one that Rust got? */
static inline void check_case(const char *name, uint64_t hash) {
    size_t i;
    check_checks++;
    for (i = 0; i < case_count; i++) {
        if (strcmp(cases[i].name, name) == 0) {
            if (cases[i].hash != hash) {
                check_failures++;
                printf("%s: other bits than Rust\n", name);
            }
            return;
        }
    }
    check_failures++;
    printf("%s: no such case\n", name);
}

/* A number in [-1, 1) that looks random, as ffi-tests/vectors.rs makes it. */
static inline double noise(size_t i) {
    return (double)(uint32_t)((uint32_t)i * UINT32_C(2654435761) + UINT32_C(12345)) / 2147483648.0 - 1.0;
}

/* Sides, box, seed and padding of ffi-tests/vectors.rs. */
enum { N = 12, FINE = 18, FINER = 24, PADDING = 3, ROWS = 40 };
#define BOX 200.0
#define SEED UINT64_C(0x0123456789abcdef)

/* Rows of k, P and T. */
static inline void fill_rows(double *k, double *power, double *transfer) {
    int row;
    for (row = 0; row < ROWS; row++) {
        double square = (double)(row + 1) * (double)(row + 1);
        k[row] = 0.0005 * square;
        power[row] = 20000.0 / (1.0 + 0.05 * square);
        transfer[row] = 1.0 / (1.0 + 0.05 * square);
    }
}

/* k, T_m, T_s, V_s, and what the linear spectrum stands for. */
enum { COLUMNS = 5 };

static inline void fill_columns(double (*columns)[ROWS]) {
    double power[ROWS];
    int row;
    fill_rows(columns[0], power, columns[1]);
    for (row = 0; row < ROWS; row++) {
        double square = (double)(row + 1) * (double)(row + 1);
        columns[2][row] = 1.25 / (1.0 + 0.0625 * square);
        columns[3][row] = 0.875 / (1.0 + 0.04 * square);
        columns[4][row] = 1.0 / (1.0 + 0.045 * square);
    }
}

/* A species without and one with a reference. */
static inline void make_species(fixpair_species *species, double (*columns)[ROWS]) {
    int i;
    for (i = 0; i < 2; i++) {
        MUST(fixpair_species_init(&species[i]));
        species[i].rows = ROWS;
        species[i].k = columns[0];
        species[i].matter = columns[1];
        species[i].density = columns[2];
        species[i].velocity = columns[3];
        species[i].reference = i == 0 ? NULL : columns[4];
    }
}

/*
 * Memory with canaries
 */

enum { CANARY = 64, CANARY_BYTE = 0xa5 };

/* The canaries of an allocation of `take` that are not what they were. */
#define CHECK_CANARIES(pointer) CHECK(canaries_live(pointer))

/* `size` bytes of zeros that begin on a cache line, with 64 bytes of canary before and after. */
static inline void *take(size_t size) {
    char *raw, *start;
    HOST_ENTER();
    raw = (char *)malloc(size + 4 * CANARY);
    HOST_LEAVE();
    if (raw == NULL) {
        printf("out of memory\n");
        exit(2);
    }
    start = raw + (CANARY - (size_t)((uintptr_t)raw % CANARY)) + CANARY;
    memset(raw, CANARY_BYTE, size + 4 * CANARY);
    memset(start, 0, size);
    /* How to give it back, and where it ends, stand at the start of the canary before it. */
    memcpy(start - CANARY, &raw, sizeof raw);
    memcpy(start - CANARY + sizeof raw, &size, sizeof size);
    return start;
}

/* Scratch, of which nobody may know what is in it: every number NaN, or -1. */
static inline void *take_scratch(size_t size) {
    void *scratch = take(size);
    memset(scratch, 0xff, size);
    MEMORY_UNDEFINED(scratch, size);
    return scratch;
}

static inline int canaries_live(const void *pointer) {
    const unsigned char *start = (const unsigned char *)pointer;
    size_t size, i;
    memcpy(&size, start - CANARY + sizeof(char *), sizeof size);
    for (i = sizeof(char *) + sizeof size; i < CANARY; i++) {
        if ((start - CANARY)[i] != CANARY_BYTE) {
            return 0;
        }
    }
    for (i = 0; i < CANARY; i++) {
        if (start[size + i] != CANARY_BYTE) {
            return 0;
        }
    }
    return 1;
}

/* Checks the canaries and frees. */
static inline void give_back(void *pointer) {
    char *raw;
    CHECK_CANARIES(pointer);
    memcpy(&raw, (char *)pointer - CANARY, sizeof raw);
    HOST_ENTER();
    free(raw);
    HOST_LEAVE();
}

#endif
