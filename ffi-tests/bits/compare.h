/*
 * The part of bits.c that compares the numbers of two runs: for each line the largest difference, in units of their root mean square, or of the
 * period where they are places in a box.
 */

static int compare(const char *left, const char *right) {
    FILE *files[2];
    head_of_values heads[2];
    uint64_t i;
    files[0] = fopen(left, "rb");
    files[1] = fopen(right, "rb");
    if (files[0] == NULL || files[1] == NULL) {
        printf("cannot read %s and %s\n", left, right);
        return 2;
    }
    while (fread(&heads[0], sizeof *heads, 1, files[0]) == 1) {
        double most = 0.0, squares = 0.0, scale;
        if (fread(&heads[1], sizeof *heads, 1, files[1]) != 1 || memcmp(&heads[0], &heads[1], sizeof *heads) != 0) {
            printf("%s and %s hold different lines\n", left, right);
            return 2;
        }
        for (i = 0; i < heads[0].count; i++) {
            double pair[2], apart;
            if (fread(&pair[0], sizeof(double), 1, files[0]) != 1 || fread(&pair[1], sizeof(double), 1, files[1]) != 1) {
                printf("%s or %s ends early\n", left, right);
                return 2;
            }
            apart = fabs(pair[0] - pair[1]);
            if (heads[0].period > 0 && apart > heads[0].period / 2) {
                apart = heads[0].period - apart;
            }
            /* A NaN is as far away as can be. */
            most = apart <= most ? most : apart;
            squares += pair[0] * pair[0];
        }
        scale = heads[0].period > 0 ? heads[0].period : sqrt(squares / (double)heads[0].count);
        printf("%-40s %.3e\n", heads[0].name, most / scale);
    }
    fclose(files[0]);
    fclose(files[1]);
    return 0;
}
