/* driver alone|through SECONDS: prints nanoseconds of one evaluation of accelerations, in C and through FMI 3.0. */
#define _POSIX_C_SOURCE 199309L

#include "fmi3Functions.h"
#include "panda_arm_fmu.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void)
{
    struct timespec moment;
    clock_gettime(CLOCK_MONOTONIC, &moment);
    return 1e9 * (double)moment.tv_sec + (double)moment.tv_nsec;
}

int main(int count, char **arguments)
{
    const int through = count > 1 && arguments[1][0] == 't';
    const double length = 1e9 * (count > 2 ? atof(arguments[2]) : 0.1);
    const double tau[SPEEDS] = { 0.0 };
    double state[STATES], rates[STATES], sum = 0.0, begin, taken;
    fmi3Boolean flags[5];
    fmi3Float64 next;
    fmi3Instance fmu = fmi3InstantiateModelExchange("one", PANDA_ARM_FMU_TOKEN, "", false, false, NULL, NULL);
    long calls = 0;
    int status = fmi3EnterInitializationMode(fmu, false, 0.0, 0.0, false, 0.0);
    status |= fmi3ExitInitializationMode(fmu);
    status |= fmi3UpdateDiscreteStates(fmu, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next);
    status |= fmi3EnterContinuousTimeMode(fmu);
    for (size_t i = 0; i < STATES; i++) {
        state[i] = 0.1 + 0.05 * (double)i;
    }
    begin = now();
    do {
        for (int i = 0; i < 100; i++, calls++) {
            state[1] += 1e-9;
            if (through) {
                status |= fmi3SetContinuousStates(fmu, state, STATES);
                status |= fmi3GetContinuousStateDerivatives(fmu, rates, STATES);
            } else {
                status |= panda_arm_forward_dynamics(state, state + COORDINATES, tau, rates + COORDINATES);
            }
            sum += rates[STATES - 1];
        }
        taken = now() - begin;
    } while (taken < length);
    fmi3FreeInstance(fmu);
    printf("%.3f %g\n", taken / (double)calls, sum / (double)calls);
    return status != 0;
}
