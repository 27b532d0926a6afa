/* An importer of an FMU for FMI 2.0: importer GUID STATES. It also calls what must be refused. */
#include "fmi2Functions.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static int messages;

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
    fmi2String format, ...)
{
    va_list arguments;
    (void)environment;
    messages++;
    printf("%s %d %s: ", name, (int)status, category);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

static void require(int condition, const char *what)
{
    if (!condition) {
        printf("failed: %s\n", what);
        exit(1);
    }
}

static fmi2Component start(const char *guid, fmi2Type type, const fmi2CallbackFunctions *functions)
{
    fmi2Component c = fmi2Instantiate("one", type, guid, "", functions, fmi2False, fmi2True);
    require(c != NULL, "fmi2Instantiate");
    require(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "fmi2SetupExperiment");
    require(fmi2EnterInitializationMode(c) == fmi2OK, "fmi2EnterInitializationMode");
    require(fmi2ExitInitializationMode(c) == fmi2OK, "fmi2ExitInitializationMode");
    return c;
}

static void exchange(const char *guid, size_t states, const fmi2CallbackFunctions *functions)
{
    fmi2Component c = start(guid, fmi2ModelExchange, functions);
    double *x = calloc(states, sizeof *x);
    double *rates = calloc(states, sizeof *rates);
    fmi2EventInfo info;
    fmi2ValueReference first = 1;
    double value = 0.0 / 1.0;
    require(fmi2NewDiscreteStates(c, &info) == fmi2OK && !info.newDiscreteStatesNeeded, "fmi2NewDiscreteStates");
    require(fmi2EnterContinuousTimeMode(c) == fmi2OK, "fmi2EnterContinuousTimeMode");
    require(fmi2GetContinuousStates(c, x, states) == fmi2OK, "fmi2GetContinuousStates");
    for (int step = 0; step < 10; step++) {
        require(fmi2SetTime(c, 0.01 * step) == fmi2OK, "fmi2SetTime");
        require(fmi2SetContinuousStates(c, x, states) == fmi2OK, "fmi2SetContinuousStates");
        require(fmi2GetDerivatives(c, rates, states) == fmi2OK, "fmi2GetDerivatives");
        for (size_t i = 0; i < states; i++) {
            x[i] += 0.01 * rates[i];
        }
    }
    require(fmi2GetDerivatives(c, rates, states + 1) == fmi2Error, "another number of states");
    require(fmi2SetReal(c, &first, 1, NULL) == fmi2Error, "no values");
    first = 100000;
    require(fmi2GetReal(c, &first, 1, &value) == fmi2Error, "no such variable");
    require(fmi2DoStep(c, 0.0, 0.1, fmi2True) == fmi2Error, "a step of model exchange");
    require(fmi2Terminate(c) == fmi2OK, "fmi2Terminate");
    fmi2FreeInstance(c);
    free(x);
    free(rates);
}

static void simulate(const char *guid, const fmi2CallbackFunctions *functions)
{
    fmi2Component c = start(guid, fmi2CoSimulation, functions);
    fmi2FMUstate state = NULL, other = NULL;
    fmi2ValueReference first = 1;
    size_t size = 0;
    char *bytes;
    double before = 0.0, after = 1.0, seed = 1.0;
    require(fmi2DoStep(c, 0.0, 0.1, fmi2True) == fmi2OK, "fmi2DoStep");
    require(fmi2GetFMUstate(c, &state) == fmi2OK && state, "fmi2GetFMUstate");
    require(fmi2GetReal(c, &first, 1, &before) == fmi2OK, "fmi2GetReal");
    require(fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK && size, "fmi2SerializedFMUstateSize");
    bytes = malloc(size);
    require(fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK, "fmi2SerializeFMUstate");
    require(fmi2SerializeFMUstate(c, state, bytes, size - 1) == fmi2Error, "too few bytes");
    require(fmi2DoStep(c, 0.1, 0.1, fmi2True) == fmi2OK, "fmi2DoStep");
    require(fmi2DeSerializeFMUstate(c, bytes, size, &other) == fmi2OK, "fmi2DeSerializeFMUstate");
    require(fmi2SetFMUstate(c, other) == fmi2OK, "fmi2SetFMUstate");
    require(fmi2GetReal(c, &first, 1, &after) == fmi2OK && before == after, "the state that was stored");
    require(fmi2GetDirectionalDerivative(c, &first, 1, &first, 1, &seed, &after) == fmi2OK && after == 1.0,
        "fmi2GetDirectionalDerivative");
    require(fmi2SetFMUstate(c, NULL) == fmi2Error, "no state");
    require(fmi2FreeFMUstate(c, &state) == fmi2OK && !state, "fmi2FreeFMUstate");
    require(fmi2FreeFMUstate(c, &other) == fmi2OK, "fmi2FreeFMUstate");
    require(fmi2Reset(c) == fmi2OK, "fmi2Reset");
    require(fmi2DoStep(c, 0.0, 0.1, fmi2True) == fmi2Error, "a step before initialization");
    free(bytes);
    fmi2FreeInstance(c);
}

int main(int count, char **arguments)
{
    fmi2CallbackFunctions functions = { log_message, calloc, free, NULL, NULL };
    require(count == 3, "two arguments");
    require(!fmi2Instantiate("one", fmi2ModelExchange, "another", "", &functions, fmi2False, fmi2False), "GUID");
    require(!fmi2Instantiate("one", fmi2ModelExchange, arguments[1], "", NULL, fmi2False, fmi2False), "NULL");
    require(fmi2GetReal(NULL, NULL, 0, NULL) == fmi2Error, "no instance");
    exchange(arguments[1], (size_t)atoi(arguments[2]), &functions);
    simulate(arguments[1], &functions);
    fmi2FreeInstance(NULL);
    require(messages == 8, "a message for every call that is refused");
    printf("done\n");
    return 0;
}
