/*
 * Counts what the library takes from the heap. conformance.c and refusals.c are compiled with a header, written by
 * allocations.rs, that arms the counter around each call of a function of fixpair.h, and linked with this file, which stands between
 * the program and the allocator of the GNU C library. What any thread takes or gives back while a call runs is laid to
 * the function that was called.
 *
 * allocations FILE: as conformance
 */
#define _GNU_SOURCE

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "counted_calls.h"

int conformance_main(int count, char **arguments);
int refusals_main(void);

/* COUNTED_FUNCTIONS are the names, in quotes. */
static const char *const functions[] = {COUNTED_FUNCTIONS};
enum { FUNCTIONS = sizeof functions / sizeof *functions, NOBODY = -1 };

/* What the header excepts: the pool's memory, and faer's. */
static const char *const excepted[] = {"fixpair_threads_create", "fixpair_threads_destroy", "fixpair_covariance_root",
                                       "fixpair_carpool"};

static struct {
    unsigned long calls, taken, given_back;
} counts[FUNCTIONS];
static int running = NOBODY;
static _Thread_local int in_host;

int counted_enter(int function) {
    __atomic_fetch_add(&counts[function].calls, 1, __ATOMIC_RELAXED);
    return __atomic_exchange_n(&running, function, __ATOMIC_SEQ_CST);
}

void counted_leave(const int *before) {
    __atomic_store_n(&running, *before, __ATOMIC_SEQ_CST);
}

void host_enter(void) {
    in_host++;
}

void host_leave(void) {
    in_host--;
}

static void took(void) {
    int function = __atomic_load_n(&running, __ATOMIC_SEQ_CST);
    if (function != NOBODY && in_host == 0) {
        __atomic_fetch_add(&counts[function].taken, 1, __ATOMIC_RELAXED);
    }
}

static void gave(const void *pointer) {
    int function = __atomic_load_n(&running, __ATOMIC_SEQ_CST);
    if (function != NOBODY && in_host == 0 && pointer != NULL) {
        __atomic_fetch_add(&counts[function].given_back, 1, __ATOMIC_RELAXED);
    }
}

/*
 * The allocator's names, all that Rust's and C's code can reach it by
 */

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

void *malloc(size_t size) {
    took();
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    took();
    return __libc_calloc(count, size);
}

void *realloc(void *pointer, size_t size) {
    took();
    return __libc_realloc(pointer, size);
}

void *memalign(size_t align, size_t size) {
    took();
    return __libc_memalign(align, size);
}

void *aligned_alloc(size_t align, size_t size) {
    took();
    return __libc_memalign(align, size);
}

int posix_memalign(void **pointer, size_t align, size_t size) {
    took();
    *pointer = __libc_memalign(align, size);
    return *pointer == NULL ? ENOMEM : 0;
}

void free(void *pointer) {
    gave(pointer);
    __libc_free(pointer);
}

void *mmap(void *address, size_t size, int protection, int flags, int file, off_t offset) {
    took();
    return (void *)syscall(SYS_mmap, address, size, protection, flags, file, offset);
}

void *mmap64(void *address, size_t size, int protection, int flags, int file, off64_t offset) {
    took();
    return (void *)syscall(SYS_mmap, address, size, protection, flags, file, offset);
}

/*
 * The counter itself
 */

static int failures = 0;

static void must(int holds, const char *claim) {
    if (!holds) {
        failures++;
        printf("not so: %s\n", claim);
    }
}

static void *a_thread(void *pointer) {
    *(void *volatile *)pointer = malloc(1);
    return NULL;
}

/* Each way to take memory is seen, on another thread too, but not the host's, nor outside calls. */
static void the_counter_counts(void) {
    /* Volatile, or a compiler takes away what nobody uses. */
    void *volatile taken[7] = {NULL};
    void *aligned = NULL;
    pthread_t thread;
    int i, before = counted_enter(0);
    unsigned long calls = --counts[0].calls;
    taken[0] = malloc(1);
    taken[1] = calloc(1, 1);
    taken[2] = realloc(NULL, 1);
    taken[3] = aligned_alloc(64, 64);
    must(posix_memalign(&aligned, 64, 64) == 0, "aligned memory");
    taken[4] = aligned;
    taken[5] = mmap(NULL, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    must(counts[0].taken == 6, "six ways to take memory are counted");
    host_enter();
    must(pthread_create(&thread, NULL, a_thread, (void *)&taken[6]) == 0, "a thread");
    must(pthread_join(thread, NULL) == 0, "a thread that ends");
    host_leave();
    must(counts[0].taken == 7, "what another thread takes is counted, the thread itself is the host's");
    free(taken[0]);
    must(counts[0].given_back == 1, "what is given back is counted");
    counted_leave(&before);
    for (i = 1; i < 7; i++) {
        if (i != 5) {
            free(taken[i]);
        }
    }
    munmap(taken[5], 4096);
    must(counts[0].taken == 7 && counts[0].given_back == 1, "outside calls nothing is counted");
    must(counts[0].calls == calls, "the trial is no call");
    memset(&counts[0], 0, sizeof counts[0]);
}

static int may_allocate(const char *name) {
    size_t i;
    for (i = 0; i < sizeof excepted / sizeof *excepted; i++) {
        if (strcmp(excepted[i], name) == 0) {
            return 1;
        }
    }
    return 0;
}

int main(int count, char **arguments) {
    unsigned long calls = 0;
    size_t i;
    int failed;
    the_counter_counts();
    failed = conformance_main(count, arguments) + refusals_main() + failures;
    for (i = 0; i < FUNCTIONS; i++) {
        calls += counts[i].calls;
        if (counts[i].calls == 0) {
            failed++;
            printf("%s was not called\n", functions[i]);
        }
        if (may_allocate(functions[i])) {
            printf("%s: %lu calls took memory %lu times and gave back %lu times\n", functions[i], counts[i].calls,
                   counts[i].taken, counts[i].given_back);
        } else if (counts[i].taken + counts[i].given_back > 0) {
            failed++;
            printf("%s took memory %lu times and gave back %lu times in %lu calls\n", functions[i], counts[i].taken,
                   counts[i].given_back, counts[i].calls);
        }
    }
    printf("allocations: %lu calls of %d functions\n", calls, FUNCTIONS);
    return failed == 0 ? 0 : 1;
}
