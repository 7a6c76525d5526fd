/* The Kepler problem in the plane by semi-implicit Euler, from (1, 0) at speed (0, 1.1): kepler STEPS
   Prints x and y at the end, and nanoseconds per step of the loop alone. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int count, char **arguments)
{
    long steps = count > 1 ? atol(arguments[1]) : 1000;
    double h = 0.01, x = 1, y = 0, vx = 0, vy = 1.1;
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (long step = 0; step < steps; step++) {
        double r2 = x * x + y * y;
        double w = -h / (r2 * sqrt(r2));
        vx += w * x;
        vy += w * y;
        x += h * vx;
        y += h * vy;
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("%.17g\n%.17g\n", x, y);
    printf("%.17g\n", ((end.tv_sec - begin.tv_sec) * 1e9 + (end.tv_nsec - begin.tv_nsec)) / steps);
    return 0;
}
