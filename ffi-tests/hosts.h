/*
 * Hooks of a host: a loop over POSIX threads, and a transform that keeps its modes transposed.
 */
#ifndef FIXPAIR_HOSTS_H
#define FIXPAIR_HOSTS_H

#include <pthread.h>

#include "check.h"

typedef struct {
    void (*body)(void *, size_t);
    void *argument;
    size_t first, count, step;
} part_of_loop;

static inline void *run_part(void *argument) {
    const part_of_loop *part = (const part_of_loop *)argument;
    size_t i;
    for (i = part->first; i < part->count; i += part->step) {
        part->body(part->argument, i);
    }
    return NULL;
}

/* Starts three threads for each loop; the context counts loops. */
static inline int32_t posix_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    enum { THREADS = 3 };
    pthread_t thread[THREADS];
    part_of_loop part[THREADS];
    size_t i;
    int failed = 0;
    for (i = 0; i < THREADS; i++) {
        part[i].body = body;
        part[i].argument = argument;
        part[i].first = i;
        part[i].count = count;
        part[i].step = THREADS;
    }
    HOST_ENTER();
    for (i = 1; i < THREADS; i++) {
        if (pthread_create(&thread[i], NULL, run_part, &part[i]) != 0) {
            printf("no thread\n");
            exit(2);
        }
    }
    HOST_LEAVE();
    run_part(&part[0]);
    HOST_ENTER();
    for (i = 1; i < THREADS; i++) {
        failed |= pthread_join(thread[i], NULL) != 0;
    }
    HOST_LEAVE();
    ++*(size_t *)context;
    return failed;
}

/* Hooks that break their contracts. */
static inline int32_t failing_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    (void)context, (void)count, (void)body, (void)argument;
    return 7;
}

static inline int32_t skipping_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    size_t i;
    (void)context;
    for (i = 1; i < count; i++) {
        body(argument, i);
    }
    return 0;
}

#endif
