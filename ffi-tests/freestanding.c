/*
 * One initial condition where there is nothing: no C library, no heap, no threads, no main. Linux on x86-64; exits with 0 if the particles
 * are there, else with a number that says where it stopped.
 */
#define FIXPAIR_NO_THREADS
#include "fixpair.h"

enum { SIDE = 16, PARTICLES = SIDE * SIDE * SIDE, MEMORY = 1 << 20 };

static unsigned char memory[MEMORY] __attribute__((aligned(64)));
static size_t used;
static float position[3 * PARTICLES], velocity[3 * PARTICLES];

/* What a compiler may call on its own. */
void *memcpy(void *restrict to, const void *restrict from, size_t size) {
    unsigned char *t = to;
    const unsigned char *f = from;
    while (size--) {
        *t++ = *f++;
    }
    return to;
}

void *memmove(void *to, const void *from, size_t size) {
    unsigned char *t = to;
    const unsigned char *f = from;
    if (t <= f) {
        return memcpy(to, from, size);
    }
    while (size--) {
        t[size] = f[size];
    }
    return to;
}

void *memset(void *to, int value, size_t size) {
    unsigned char *t = to;
    while (size--) {
        *t++ = (unsigned char)value;
    }
    return to;
}

int memcmp(const void *a, const void *b, size_t size) {
    const unsigned char *x = a, *y = b;
    for (; size--; x++, y++) {
        if (*x != *y) {
            return *x - *y;
        }
    }
    return 0;
}

static void leave(int status) {
    for (;;) {
        __asm__ volatile("syscall" : : "a"(60), "D"(status) : "rcx", "r11", "memory");
    }
}

/* A piece of the one buffer. */
static void *piece(fixpair_layout layout) {
    unsigned char *start = memory + used;
    if (layout.size > MEMORY - used) {
        leave(100);
    }
    used += (layout.size + 63) / 64 * 64;
    return start;
}

static void must(fixpair_status_t status, int where) {
    if (status != FIXPAIR_OK) {
        leave(where);
    }
}

static void make(void) {
    fixpair_conditions conditions;
    fixpair_fft_f32 fft;
    fixpair_layout table_layout, work_layout, layout;
    fixpair_components_f32 x, v;
    void *tables, *work, *scratch;
    int i, moved = 0;
    must(fixpair_fft_tables_scratch_f32(&table_layout, SIDE), 1);
    must(fixpair_fft_scratch_f32(&work_layout, SIDE), 2);
    tables = piece(table_layout);
    work = piece(work_layout);
    must(fixpair_fft_tables_init_f32(tables, table_layout.size, SIDE), 3);
    must(fixpair_fft_init_f32(&fft, tables, table_layout.size, 0, work, work_layout.size, NULL), 4);
    must(fixpair_conditions_init(&conditions, 7), 5);
    conditions.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    conditions.f_nl = 100.0;
    must(fixpair_initial_conditions_scratch_f32(&layout, &conditions, &fft, NULL), 6);
    scratch = piece(layout);
    x.x = position;
    x.y = position + 1;
    x.z = position + 2;
    x.stride = 3;
    x.length = PARTICLES;
    v = x;
    v.x = velocity;
    v.y = velocity + 1;
    v.z = velocity + 2;
    must(fixpair_initial_conditions_f32(&x, &v, &conditions, &fft, NULL, scratch, layout.size, NULL), 7);
    for (i = 0; i < 3 * PARTICLES; i++) {
        if (!(position[i] >= 0 && position[i] < 1000)) {
            leave(8);
        }
        moved += velocity[i] != 0;
    }
    leave(moved == 3 * PARTICLES ? 0 : 9);
}

/* The kernel leaves the stack aligned as main would find it only after a call. */
__asm__(".globl _start\n_start:\n xorl %ebp, %ebp\n andq $-16, %rsp\n call begin\n");

void begin(void);

__attribute__((used)) void begin(void) {
    make();
}
