/* Read a file of numbers of the type REAL. */
#include <stdio.h>
#include <stdlib.h>

static REAL *read_array(const char *name, size_t count)
{
    REAL *values = malloc(count * sizeof *values);
    FILE *file = fopen(name, "rb");
    if (!values || !file || fread(values, sizeof *values, count, file) != count) exit(1);
    fclose(file);
    return values;
}
