/*
 * ekf_double_pendulum.c -- an extended Kalman filter in single precision, as it runs on a microcontroller.
 *
 * It estimates both angles and both speeds of a double pendulum from noisy measurements of the first angle. A
 * step of the model and its exact derivatives come from double_pendulum.h; memory is static, and nothing is
 * allocated. examples/ekf_double_pendulum.py writes measurements.h and draws what this program prints.
 */
#include <stdio.h>

#include "double_pendulum.h"
#include "measurements.h"

enum { N = 4, COLUMNS = 11 }; /* states; columns of derivatives: by states, generalized forces, parameters */

static const float STEP[1] = {0.01f};          /* s, between measurements */
static const float MEASUREMENT = 4e-4f;        /* rad^2, variance of a measurement */
static const float DISTURBANCE[N] = {1e-8f, 1e-8f, 1e-5f, 1e-5f}; /* variances that a step adds */

/* What the filter knows: the state {x}, {y} and the covariance of its error. */
struct filter {
    float prepared[DOUBLE_PENDULUM_PREPARED];
    float state[N];
    float P[N][N];
};

/* Follows the model over a step: P becomes F P F' + Q, with F the derivatives of the step. */
static int predict(struct filter *filter)
{
    static const float tau[2] = {0.0f, 0.0f};
    float next[N], F[N*COLUMNS], FP[N][N];
    const int status = double_pendulum_step_rk4_derivatives(
        filter->prepared, filter->state, filter->state + 2, tau, STEP, next, next + 2, F);
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            FP[i][j] = 0.0f;
            for (int k = 0; k < N; ++k) {
                FP[i][j] += F[COLUMNS*i + k]*filter->P[k][j];
            }
        }
    }
    for (int i = 0; i < N; ++i) {
        filter->state[i] = next[i];
        for (int j = 0; j <= i; ++j) {
            float sum = i == j ? DISTURBANCE[i] : 0.0f;
            for (int k = 0; k < N; ++k) {
                sum += FP[i][k]*F[COLUMNS*j + k];
            }
            filter->P[i][j] = filter->P[j][i] = sum;
        }
    }
    return status;
}

/* Takes a measurement of the first angle into account. */
static void correct(struct filter *filter, float angle)
{
    const float variance = filter->P[0][0] + MEASUREMENT;
    const float surprise = angle - filter->state[0];
    float column[N];
    for (int i = 0; i < N; ++i) {
        column[i] = filter->P[i][0];
        filter->state[i] += column[i]*surprise/variance;
    }
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            filter->P[i][j] -= column[i]*column[j]/variance;
        }
    }
}

int main(void)
{
    static const float parameters[DOUBLE_PENDULUM_PARAMETERS] = {9.81f, 1.0f, 1.0f, 0.5f, 0.7f};
    static struct filter filter; /* begins at rest, hanging down: far from the truth */
    for (int i = 0; i < N; ++i) {
        filter.P[i][i] = 1.0f;
    }
    if (double_pendulum_prepare(parameters, filter.prepared) != 0) {
        return 1;
    }
    for (int i = 0; i < MEASUREMENTS; ++i) {
        if (i > 0 && predict(&filter) > 0) {
            return 2; /* the state is lost: a controller would stop here */
        }
        correct(&filter, measured[i]);
        for (int k = 0; k < N; ++k) {
            printf("%.9g ", (double)filter.state[k]);
        }
        printf("%.9g\n", (double)filter.P[1][1]);
    }
    return 0;
}
