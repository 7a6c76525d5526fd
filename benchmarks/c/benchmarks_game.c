/* The n-body problem of the Benchmarks Game by semi-implicit Euler, pair by pair: benchmarks_game STEPS
   Prints the energy at the start, the energy at the end, and nanoseconds per step of the loop alone. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { BODIES = 5 };

static const double PI = 3.141592653589793, DAYS_PER_YEAR = 365.24, STEP = 0.01;

/* Mass (Sun = 1), position (au), velocity (au/day): Sun, Jupiter, Saturn, Uranus, Neptune. */
static const double data[BODIES][7] = {
    {1, 0, 0, 0, 0, 0, 0},
    {9.54791938424326609e-04, 4.84143144246472090e+00, -1.16032004402742839e+00, -1.03622044471123109e-01,
     1.66007664274403694e-03, 7.69901118419740425e-03, -6.90460016972063023e-05},
    {2.85885980666130812e-04, 8.34336671824457987e+00, 4.12479856412430479e+00, -4.03523417114321381e-01,
     -2.76742510726411899e-03, 4.99852801234917238e-03, 2.30417297573763929e-05},
    {4.36624404335156298e-05, 1.28943695621391310e+01, -1.51111514016986312e+01, -2.23307578892655734e-01,
     2.96460137564761618e-03, 2.37847173959480950e-03, -2.96589568540237556e-05},
    {5.15138902046611451e-05, 1.53796971148509165e+01, -2.59193146099879641e+01, 1.79258772950371181e-01,
     2.68067772490389322e-03, 1.62824170038242295e-03, -9.51592254519715870e-05},
};

struct body {
    double x[3], v[3], mass;
};

static struct body bodies[BODIES];

/* Units of au, years and 4 pi^2 solar masses, so that G = 1; the Sun takes the opposite momentum of the planets. */
static void start(void)
{
    double sun = 4 * PI * PI;
    for (int i = 0; i < BODIES; i++) {
        bodies[i].mass = data[i][0] * sun;
        for (int k = 0; k < 3; k++) {
            bodies[i].x[k] = data[i][1 + k];
            bodies[i].v[k] = data[i][4 + k] * DAYS_PER_YEAR;
        }
    }
    for (int i = 1; i < BODIES; i++)
        for (int k = 0; k < 3; k++)
            bodies[0].v[k] -= bodies[i].mass * bodies[i].v[k] / sun;
}

static void kick(double h)
{
    for (int i = 0; i < BODIES; i++)
        for (int j = i + 1; j < BODIES; j++) {
            double d[3], r2 = 0;
            for (int k = 0; k < 3; k++) {
                d[k] = bodies[i].x[k] - bodies[j].x[k];
                r2 += d[k] * d[k];
            }
            double w = h / (r2 * sqrt(r2));
            for (int k = 0; k < 3; k++) {
                bodies[i].v[k] -= d[k] * bodies[j].mass * w;
                bodies[j].v[k] += d[k] * bodies[i].mass * w;
            }
        }
}

static void drift(double h)
{
    for (int i = 0; i < BODIES; i++)
        for (int k = 0; k < 3; k++)
            bodies[i].x[k] += h * bodies[i].v[k];
}

static double energy(void)
{
    double total = 0;
    for (int i = 0; i < BODIES; i++) {
        for (int k = 0; k < 3; k++)
            total += 0.5 * bodies[i].mass * bodies[i].v[k] * bodies[i].v[k];
        for (int j = i + 1; j < BODIES; j++) {
            double r2 = 0;
            for (int k = 0; k < 3; k++)
                r2 += (bodies[i].x[k] - bodies[j].x[k]) * (bodies[i].x[k] - bodies[j].x[k]);
            total -= bodies[i].mass * bodies[j].mass / sqrt(r2);
        }
    }
    return total;
}

int main(int count, char **arguments)
{
    long steps = count > 1 ? atol(arguments[1]) : 1000;
    struct timespec begin, end;
    start();
    printf("%.17g\n", energy());
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (long step = 0; step < steps; step++) {
        kick(STEP);
        drift(STEP);
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("%.17g\n", energy());
    printf("%.17g\n", ((end.tv_sec - begin.tv_sec) * 1e9 + (end.tv_nsec - begin.tv_nsec)) / steps);
    return 0;
}
