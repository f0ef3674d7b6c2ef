#include "check.h"

#include <stdarg.h>
#include <stdio.h>

#include "fixpair.h"

void report_status(const char *file, int line, int32_t status) {
    fprintf(stderr, "%s:%d: status %d: %s\n", file, line, (int)status, fixpair_status_message(status));
}

int claim(int holds, const char *format, ...) {
    va_list values;
    va_start(values, format);
    printf(holds ? "  holds  " : "  FAILS  ");
    vprintf(format, values);
    printf("\n");
    va_end(values);
    return holds ? 0 : 1;
}
