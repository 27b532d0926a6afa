/* An importer of an FMU for FMI 3.0: importer TOKEN STATES. It also calls what must be refused. */
#include "fmi3Functions.h"

#include <stdio.h>
#include <stdlib.h>

static int messages;

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
    fmi3String message)
{
    (void)environment;
    messages++;
    printf("%d %s: %s\n", (int)status, category, message);
}

static void require(int condition, const char *what)
{
    if (!condition) {
        printf("failed: %s\n", what);
        exit(1);
    }
}

static void start(fmi3Instance c)
{
    require(c != NULL, "an instance");
    require(fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0) == fmi3OK, "fmi3EnterInitializationMode");
    require(fmi3ExitInitializationMode(c) == fmi3OK, "fmi3ExitInitializationMode");
}

static void exchange(const char *token, size_t states)
{
    fmi3Instance c = fmi3InstantiateModelExchange("one", token, "", false, true, NULL, log_message);
    double *x = calloc(states, sizeof *x);
    double *rates = calloc(states, sizeof *rates);
    fmi3Boolean flags[5];
    fmi3Float64 next, value = 0.0;
    fmi3ValueReference first = 1;
    size_t found = 0;
    start(c);
    require(fmi3UpdateDiscreteStates(c, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next) == fmi3OK, "update");
    require(fmi3EnterContinuousTimeMode(c) == fmi3OK, "fmi3EnterContinuousTimeMode");
    require(fmi3GetNumberOfContinuousStates(c, &found) == fmi3OK && found == states, "number of states");
    require(fmi3GetContinuousStates(c, x, states) == fmi3OK, "fmi3GetContinuousStates");
    for (int step = 0; step < 10; step++) {
        require(fmi3SetTime(c, 0.01 * step) == fmi3OK, "fmi3SetTime");
        require(fmi3SetContinuousStates(c, x, states) == fmi3OK, "fmi3SetContinuousStates");
        require(fmi3GetContinuousStateDerivatives(c, rates, states) == fmi3OK, "rates");
        for (size_t i = 0; i < states; i++) {
            x[i] += 0.01 * rates[i];
        }
    }
    require(fmi3GetContinuousStateDerivatives(c, rates, states + 1) == fmi3Error, "another number of states");
    require(fmi3SetFloat64(c, &first, 1, NULL, 1) == fmi3Error, "no values");
    require(fmi3GetFloat64(c, &first, 1, &value, 2) == fmi3Error, "too many values");
    first = 100000;
    require(fmi3GetFloat64(c, &first, 1, &value, 1) == fmi3Error, "no such variable");
    require(fmi3GetInt32(c, &first, 1, NULL, 1) == fmi3Error, "no such type");
    require(fmi3GetInt32(c, NULL, 0, NULL, 0) == fmi3OK, "nothing of another type");
    require(fmi3EnterStepMode(c) == fmi3Error, "a step of model exchange");
    require(fmi3Terminate(c) == fmi3OK, "fmi3Terminate");
    fmi3FreeInstance(c);
    free(x);
    free(rates);
}

static void simulate(const char *token)
{
    fmi3Instance c = fmi3InstantiateCoSimulation("one", token, "", false, true, false, false, NULL, 0, NULL,
        log_message, NULL);
    fmi3FMUState state = NULL, other = NULL;
    fmi3ValueReference first = 1;
    fmi3Boolean flags[3];
    fmi3Byte *bytes;
    size_t size = 0;
    double before = 0.0, after = 1.0, seed = 1.0, last = 0.0;
    start(c);
    require(fmi3DoStep(c, 0.0, 0.1, true, flags, flags + 1, flags + 2, &last) == fmi3OK && last == 0.1, "fmi3DoStep");
    require(fmi3GetFMUState(c, &state) == fmi3OK && state, "fmi3GetFMUState");
    require(fmi3GetFloat64(c, &first, 1, &before, 1) == fmi3OK, "fmi3GetFloat64");
    require(fmi3SerializedFMUStateSize(c, state, &size) == fmi3OK && size, "fmi3SerializedFMUStateSize");
    bytes = malloc(size);
    require(fmi3SerializeFMUState(c, state, bytes, size) == fmi3OK, "fmi3SerializeFMUState");
    require(fmi3SerializeFMUState(c, state, bytes, size - 1) == fmi3Error, "too few bytes");
    require(fmi3DoStep(c, 0.1, 0.1, true, flags, flags + 1, flags + 2, &last) == fmi3OK, "fmi3DoStep");
    require(fmi3DeserializeFMUState(c, bytes, size, &other) == fmi3OK, "fmi3DeserializeFMUState");
    require(fmi3SetFMUState(c, other) == fmi3OK, "fmi3SetFMUState");
    require(fmi3GetFloat64(c, &first, 1, &after, 1) == fmi3OK && before == after, "the state that was stored");
    require(fmi3GetDirectionalDerivative(c, &first, 1, &first, 1, &seed, 1, &after, 1) == fmi3OK && after == 1.0,
        "fmi3GetDirectionalDerivative");
    require(fmi3GetAdjointDerivative(c, &first, 1, &first, 1, &seed, 1, &after, 1) == fmi3OK && after == 1.0,
        "fmi3GetAdjointDerivative");
    require(fmi3SetFMUState(c, NULL) == fmi3Error, "no state");
    require(fmi3FreeFMUState(c, &state) == fmi3OK && !state, "fmi3FreeFMUState");
    require(fmi3FreeFMUState(c, &other) == fmi3OK, "fmi3FreeFMUState");
    require(fmi3Reset(c) == fmi3OK, "fmi3Reset");
    require(fmi3DoStep(c, 0.0, 0.1, true, flags, flags + 1, flags + 2, &last) == fmi3Error, "a step too early");
    free(bytes);
    fmi3FreeInstance(c);
}

int main(int count, char **arguments)
{
    require(count == 3, "two arguments");
    require(!fmi3InstantiateModelExchange("one", "another", "", false, false, NULL, log_message), "token");
    require(fmi3GetFloat64(NULL, NULL, 0, NULL, 0) == fmi3Error, "no instance");
    exchange(arguments[1], (size_t)atoi(arguments[2]));
    simulate(arguments[1]);
    fmi3FreeInstance(NULL);
    require(messages == 10, "a message for every call that is refused");
    printf("done\n");
    return 0;
}
