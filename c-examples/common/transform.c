#include "transform.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

int transform_open(struct transform *transform, size_t n, const struct fixpair_exec *exec) {
    struct fixpair_layout tables, scratch;
    memset(transform, 0, sizeof *transform);
    TRY(fixpair_fft_tables_scratch_f64(&tables, n));
    TRY(fixpair_fft_scratch_f64(&scratch, n));
    transform->tables = memory_take(tables);
    transform->scratch = memory_take(scratch);
    if (transform->tables == NULL || transform->scratch == NULL) return 1;

    TRY(fixpair_fft_tables_init_f64(transform->tables, tables.size, n));
    TRY(fixpair_fft_init_f64(&transform->hook, transform->tables, tables.size, fixpair_fft_padding_f64(n), transform->scratch,
                             scratch.size, exec));
    return 0;
}

void transform_close(struct transform *transform) {
    free(transform->tables);
    free(transform->scratch);
    memset(transform, 0, sizeof *transform);
}

int transform_open_f32(struct transform_f32 *transform, size_t n, const struct fixpair_exec *exec) {
    struct fixpair_layout tables, scratch;
    memset(transform, 0, sizeof *transform);
    TRY(fixpair_fft_tables_scratch_f32(&tables, n));
    TRY(fixpair_fft_scratch_f32(&scratch, n));
    transform->tables = memory_take(tables);
    transform->scratch = memory_take(scratch);
    if (transform->tables == NULL || transform->scratch == NULL) return 1;

    TRY(fixpair_fft_tables_init_f32(transform->tables, tables.size, n));
    TRY(fixpair_fft_init_f32(&transform->hook, transform->tables, tables.size, fixpair_fft_padding_f32(n), transform->scratch,
                             scratch.size, exec));
    return 0;
}

void transform_close_f32(struct transform_f32 *transform) {
    free(transform->tables);
    free(transform->scratch);
    memset(transform, 0, sizeof *transform);
}
