/*
 * The hook of a pool, as ThreadSanitizer can follow it. It does not see how Rust's standard library, which comes compiled without it, wakes the
 * threads of the pool and waits for them. It is told that, and no more: a loop begins before its chunks, and they end before
 * it. The chunks it watches.
 */
#ifndef FIXPAIR_HANDOVERS_H
#define FIXPAIR_HANDOVERS_H

#include "fixpair.h"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FIXPAIR_THREAD_SANITIZER
#endif
#endif

#ifdef FIXPAIR_THREAD_SANITIZER

void __tsan_acquire(void *);
void __tsan_release(void *);

typedef struct {
    void (*body)(void *, size_t);
    void *argument;
    char begun, ended;
} told_loop;

static inline void told_chunk(void *argument, size_t index) {
    told_loop *loop = (told_loop *)argument;
    __tsan_acquire(&loop->begun);
    loop->body(loop->argument, index);
    __tsan_release(&loop->ended);
}

/* The context is the pool's own hook. */
static inline int32_t told_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    const fixpair_exec *pool = (const fixpair_exec *)context;
    told_loop loop;
    int32_t status;
    loop.body = body;
    loop.argument = argument;
    loop.begun = loop.ended = 0;
    __tsan_release(&loop.begun);
    status = pool->parallel_for(pool->context, count, told_chunk, &loop);
    __tsan_acquire(&loop.ended);
    return status;
}

/* `pool` lives as long as the hook. */
static inline fixpair_exec followed(fixpair_exec *pool) {
    fixpair_exec told;
    told.context = pool;
    told.parallel_for = told_for;
    return told;
}

#else

static inline fixpair_exec followed(fixpair_exec *pool) {
    return *pool;
}

#endif

#endif
