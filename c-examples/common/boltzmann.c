#include "boltzmann.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_LINE = 1024, MOST_COLUMNS = 13 };

struct reader {
    const char *path;
    unsigned long line;
    size_t columns;  /* of the first row; 0 before it */
    size_t column;   /* the one to read, counted from 0 */
    size_t capacity; /* rows that the table has memory for */
};

static int complain(const struct reader *reader, const char *what) {
    fprintf(stderr, "%s:%lu: %s\n", reader->path, reader->line, what);
    return 1;
}

/* CLASS: "# Matter power spectrum P(k) at redshift z=0". */
static int check_comment(const struct reader *reader, const char *comment) {
    const char *redshift = strstr(comment, "redshift z=");
    if (redshift == NULL || strtod(redshift + strlen("redshift z="), NULL) == 0.0) return 0;
    return complain(reader, "this is a spectrum of another redshift; fixpair takes that of z = 0 and scales it back itself");
}

/* Splits a line into numbers; *count of them. */
static int parse(const struct reader *reader, const char *text, double *numbers, size_t *count) {
    *count = 0;
    for (;;) {
        char *end;
        text += strspn(text, " \t\r\n");
        if (*text == '\0') return 0;
        if (*count == MOST_COLUMNS) return complain(reader, "more than 13 columns");
        numbers[*count] = strtod(text, &end);
        if (end == text || strchr(" \t\r\n", *end) == NULL) return complain(reader, "not a number");
        if (!isfinite(numbers[*count])) return complain(reader, "a number that is not finite");
        *count += 1;
        text = end;
    }
}

/* What the number of columns says about the file. */
static int recognise(struct boltzmann_table *table, struct reader *reader, size_t columns) {
    reader->columns = columns;
    switch (columns) {
    case 2:
        reader->column = 1;
        table->source = FIXPAIR_LINEAR_POWER;
        return 0;
    case 5:
        reader->column = 2;
        table->source = FIXPAIR_LINEAR_POWER;
        return 0;
    case 7:
    case 13:
        reader->column = 6;
        table->source = FIXPAIR_LINEAR_TRANSFER;
        return 0;
    default:
        return complain(reader, "neither 2, 5, 7 nor 13 columns: no format that is known here");
    }
}

static int grow(struct boltzmann_table *table, struct reader *reader) {
    size_t capacity = reader->capacity == 0 ? 256 : 2 * reader->capacity;
    double *k = realloc(table->k, capacity * sizeof *k);
    if (k != NULL) table->k = k;
    double *value = realloc(table->value, capacity * sizeof *value);
    if (value != NULL) table->value = value;
    if (k == NULL || value == NULL) return complain(reader, "no memory left");
    reader->capacity = capacity;
    return 0;
}

static int add_row(struct boltzmann_table *table, struct reader *reader, const double *numbers, size_t count) {
    if (reader->columns == 0 && recognise(table, reader, count) != 0) return 1;
    if (count != reader->columns) return complain(reader, "another number of columns than in the rows above");
    if (numbers[0] <= 0.0) return complain(reader, "k is not positive");
    if (table->rows > 0 && numbers[0] <= table->k[table->rows - 1]) return complain(reader, "k does not increase");
    if (numbers[reader->column] <= 0.0) return complain(reader, "P or T is not positive");
    if (table->rows == reader->capacity && grow(table, reader) != 0) return 1;
    table->k[table->rows] = numbers[0];
    table->value[table->rows] = numbers[reader->column];
    table->rows += 1;
    return 0;
}

static int read_lines(struct boltzmann_table *table, struct reader *reader, FILE *file) {
    char text[LONGEST_LINE];
    while (fgets(text, sizeof text, file) != NULL) {
        double numbers[MOST_COLUMNS];
        size_t count;
        reader->line += 1;
        if (strchr(text, '\n') == NULL && !feof(file)) return complain(reader, "a line of more than 1022 characters");
        char *comment = strchr(text, '#');
        if (comment != NULL) {
            if (check_comment(reader, comment) != 0) return 1;
            *comment = '\0';
        }
        if (parse(reader, text, numbers, &count) != 0) return 1;
        if (count > 0 && add_row(table, reader, numbers, count) != 0) return 1;
    }
    if (ferror(file)) return complain(reader, "the next line cannot be read");
    if (table->rows < 2) return complain(reader, "the file ends before its second row");
    return 0;
}

int boltzmann_read(struct boltzmann_table *table, const char *path) {
    struct reader reader = {path, 0, 0, 0, 0};
    memset(table, 0, sizeof *table);
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    int outcome = read_lines(table, &reader, file);
    fclose(file);
    return outcome;
}

void boltzmann_close(struct boltzmann_table *table) {
    free(table->k);
    free(table->value);
    memset(table, 0, sizeof *table);
}

struct fixpair_linear boltzmann_linear(const struct boltzmann_table *table, double sigma8) {
    struct fixpair_linear linear;
    memset(&linear, 0, sizeof linear);
    linear.struct_size = sizeof linear;
    linear.source = table->source;
    linear.normalisation = table->source == FIXPAIR_LINEAR_POWER ? FIXPAIR_NORMALISE_AS_GIVEN : FIXPAIR_NORMALISE_SIGMA8;
    linear.k = table->k;
    linear.value = table->value;
    linear.rows = table->rows;
    linear.amount = sigma8;
    return linear;
}
