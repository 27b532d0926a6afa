/* Compute [A], {f} and accelerations state by state and as a batch, and print the bits of every number.
 *
 * States are read from the file `states` as bit patterns in text, so that every machine gets the same ones whatever
 * the order of its bytes. All NaN are printed alike. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include HEADER

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define CALL(name) JOIN(MODEL, name)

typedef union {
    STORED number;
    WORD bits;
} view;

static STORED read_number(FILE *file)
{
    uint64_t word;
    view value;
    if (fscanf(file, "%" SCNx64, &word) != 1) exit(1);
    value.bits = (WORD)word;
    return value.number;
}

static void print(const STORED *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        view value;
        value.number = values[i];
        if (value.number != value.number) puts("nan");
        else printf("%" PRIx64 "\n", (uint64_t)value.bits);
    }
}

int main(int argc, char **argv)
{
    const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    STORED *x = malloc(count * M * sizeof *x), *y = malloc(count * N * sizeof *y), *tau = malloc(count * N * sizeof *tau);
    STORED *A = malloc(count * N * N * sizeof *A), *f = malloc(count * N * sizeof *f);
    STORED *found = malloc(count * N * sizeof *found);
    FILE *file = fopen("states", "r");
    if (!x || !y || !tau || !A || !f || !found || !file) return 1;
    for (size_t i = 0; i < count * M; ++i) x[i] = read_number(file);
    for (size_t i = 0; i < count * N; ++i) y[i] = read_number(file);
    for (size_t i = 0; i < count * N; ++i) tau[i] = read_number(file);
    fclose(file);
    for (int batch = 0; batch < 2; ++batch) {
        size_t refused = 0;
        if (batch) {
            CALL(_mass_matrix_batch)(count, x, A);
            CALL(_forcing_batch)(count, x, y, f);
            refused = CALL(_forward_dynamics_batch)(count, x, y, tau, found);
        } else {
            for (size_t i = 0; i < count; ++i) {
                CALL(_mass_matrix)(x + M*i, A + N*N*i);
                CALL(_forcing)(x + M*i, y + N*i, f + N*i);
                refused += CALL(_forward_dynamics)(x + M*i, y + N*i, tau + N*i, found + N*i) != 0;
            }
        }
        print(A, count * N * N), print(f, count * N), print(found, count * N);
        printf("%lu refused\n", (unsigned long)refused);
    }
    free(x), free(y), free(tau), free(A), free(f), free(found);
    return 0;
}
