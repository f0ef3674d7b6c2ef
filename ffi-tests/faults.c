/*
 * Faults of a host that only an instrument sees, each where the library touches the memory; instruments.sh has each instrument find its own.
 *
 * faults overflow | uninitialised | leak | race | chunks
 */
#define _POSIX_C_SOURCE 200112L

#include <pthread.h>

#include "check.h"
#include "handovers.h"

enum { VALUES = 64 };

typedef struct {
    double *out;
    const double *in;
    fixpair_cosmology cosmology;
} task;

static void *expand(void *argument) {
    task *t = (task *)argument;
    int i;
    for (i = 0; i < 100; i++) {
        fixpair_expansion(t->out, t->in, VALUES, &t->cosmology);
    }
    return NULL;
}

/* Few steps between writes to one place: ThreadSanitizer says nothing of an earlier one whose steps it has forgotten. */
static void *draw(void *argument) {
    const uint32_t counter[4] = {0, 0, 0, 0}, key[2] = {0, 0};
    int i;
    for (i = 0; i < 20000; i++) {
        fixpair_philox4x32_10((uint32_t *)argument, counter, key);
    }
    return NULL;
}

/* Long enough for all threads of a pool to take one, even while one of them waits for ThreadSanitizer to look up what it says nothing about. */
static void expand_chunk(void *argument, size_t index) {
    (void)index;
    expand(argument);
}

int main(int count, char **arguments) {
    const char *fault = count > 1 ? arguments[1] : "";
    size_t size = VALUES * sizeof(double), i;
    double *in = (double *)malloc(size), *out;
    uint32_t numbers[4];
    task t;
    /* Half of what is stated. */
    out = (double *)malloc(strcmp(fault, "overflow") == 0 ? size / 2 : size);
    if (in == NULL || out == NULL) {
        return 2;
    }
    MUST(fixpair_cosmology_init(&t.cosmology));
    for (i = 0; strcmp(fault, "uninitialised") != 0 && i < VALUES; i++) {
        in[i] = (double)(i + 1) / VALUES;
    }
    t.in = in;
    t.out = out;
    expand(&t);
    if (strcmp(fault, "leak") == 0) {
        fixpair_threads *threads;
        fixpair_exec pool;
        MUST(fixpair_threads_create(&threads, &pool, 1));
        threads = NULL;
        memset(&pool, 0, sizeof pool);
    }
    if (strcmp(fault, "chunks") == 0) {
        fixpair_threads *threads;
        fixpair_exec pool, hook;
        MUST(fixpair_threads_create(&threads, &pool, 4));
        hook = followed(&pool);
        CHECK(hook.parallel_for(hook.context, 64, expand_chunk, &t) == 0);
        fixpair_threads_destroy(threads);
    }
    if (strcmp(fault, "race") == 0) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, draw, numbers) != 0) {
            return 2;
        }
        draw(numbers);
        pthread_join(thread, NULL);
    }
    free(in);
    free(out);
    return 0;
}
