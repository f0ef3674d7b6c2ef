#include "options.h"

#include <math.h>
#include <stdlib.h>

int option_number(double *value, const char *text, double least, double most) {
    char *end;
    *value = strtod(text, &end);
    return end == text || *end != '\0' || !(*value >= least && *value <= most);
}

int option_whole(uint64_t *value, const char *text, double least, double most) {
    double real = 0.0;
    int wrong = option_number(&real, text, least, most) || real != floor(real);
    *value = wrong ? 0 : (uint64_t)real;
    return wrong;
}
