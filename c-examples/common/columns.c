#include "columns.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_LINE = 4096 };

struct reader {
    struct columns_place place;
    const char *const *names;
    size_t names_len;
    size_t columns;             /* of the first line; 0 before it */
    size_t where[COLUMNS_MOST]; /* the column of each name */
    char text[LONGEST_LINE];
    char *cells[COLUMNS_MOST];
};

int columns_complain(const struct columns_place *place, const char *format, ...) {
    va_list values;
    va_start(values, format);
    fprintf(stderr, "%s:%lu: ", place->path, place->line);
    vfprintf(stderr, format, values);
    fprintf(stderr, "\n");
    va_end(values);
    return 1;
}

int columns_number(double *number, const struct columns_place *place, const char *name, const char *text) {
    char *end;
    *number = strtod(text, &end);
    if (end != text && *end == '\0' && isfinite(*number)) return 0;
    return columns_complain(place, "\"%s\" is no number for the column \"%s\"", text, name);
}

/* Cuts a line at its commas, and blanks off the ends of what is between. Returns the number of cells; one too many if there are more. */
static size_t split(struct reader *reader) {
    size_t count = 0;
    char *cell = reader->text;
    while (cell != NULL && count < COLUMNS_MOST) {
        char *comma = strchr(cell, ',');
        if (comma != NULL) *comma = '\0';
        cell += strspn(cell, " \t\r\n");
        char *end = cell + strlen(cell);
        while (end > cell && strchr(" \t\r\n", end[-1]) != NULL) end--;
        *end = '\0';
        reader->cells[count++] = cell;
        cell = comma == NULL ? NULL : comma + 1;
    }
    return cell == NULL ? count : count + 1;
}

/* Does a cell of the first line carry this name? Then *unit is the cell's own, or NULL. */
static int carries(const char *cell, const char *name, const char **unit) {
    size_t length = strcspn(cell, "["), wanted = strcspn(name, "[");
    *unit = cell[length] == '[' ? cell + length : NULL;
    while (length > 0 && cell[length - 1] == ' ') length--;
    while (wanted > 0 && name[wanted - 1] == ' ') wanted--;
    return length == wanted && strncmp(cell, name, length) == 0;
}

static int find_columns(struct reader *reader) {
    for (size_t i = 0; i < reader->names_len; i++) {
        const char *name = reader->names[i], *unit = NULL;
        size_t c = 0;
        while (c < reader->columns && !carries(reader->cells[c], name, &unit)) c++;
        if (c == reader->columns) return columns_complain(&reader->place, "there is no column \"%s\"; this line must name it", name);
        if (unit != NULL && strcmp(unit, name + strcspn(name, "[")) != 0) {
            return columns_complain(&reader->place, "\"%s\" must be \"%s\": convert the column and its name", reader->cells[c], name);
        }
        reader->where[i] = c;
    }
    return 0;
}

static int read_lines(struct reader *reader, FILE *file, columns_row *row, void *context) {
    while (fgets(reader->text, sizeof reader->text, file) != NULL) {
        char *values[COLUMNS_MOST];
        reader->place.line += 1;
        if (strchr(reader->text, '\n') == NULL && !feof(file)) return columns_complain(&reader->place, "a line is too long");
        if (reader->text[strspn(reader->text, " \t\r\n")] == '\0' || reader->text[0] == '#') continue;
        size_t count = split(reader);
        if (count > COLUMNS_MOST) return columns_complain(&reader->place, "more than %d columns", (int)COLUMNS_MOST);
        if (reader->columns == 0) {
            reader->columns = count;
            if (find_columns(reader) != 0) return 1;
            continue;
        }
        if (count != reader->columns) {
            return columns_complain(&reader->place, "%lu columns, where the first line names %lu", (unsigned long)count,
                                    (unsigned long)reader->columns);
        }
        for (size_t i = 0; i < reader->names_len; i++) values[i] = reader->cells[reader->where[i]];
        if (row(context, &reader->place, values) != 0) return 1;
    }
    if (ferror(file)) return columns_complain(&reader->place, "the next line cannot be read");
    if (reader->columns == 0) return columns_complain(&reader->place, "the file is empty");
    return 0;
}

int columns_read(const char *path, const char *const *names, size_t names_len, columns_row *row, void *context) {
    struct reader reader;
    memset(&reader, 0, sizeof reader);
    reader.place.path = path;
    reader.names = names;
    reader.names_len = names_len;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return 1;
    }
    int outcome = read_lines(&reader, file, row, context);
    fclose(file);
    return outcome;
}
