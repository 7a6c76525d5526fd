/* Direct summation of gravity, every pair once, by hand for AVX-512: gravity BODIES EVALUATIONS
   Prints the accelerations of the first and the last body, and nanoseconds per interaction (two a pair). */
#include <immintrin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TILE = 128, LANES = 8 };

static const double SOFTENING2 = 1e-4, FAR_AWAY = 1e100;

struct tile {
    double x[TILE], y[TILE], z[TILE], gm[TILE], ax[TILE], ay[TILE], az[TILE];
};

/* r2^-1.5: an estimate to 14 bits, and three terms of (1 - e)^-1.5 for what it leaves, to rounding. */
static inline __m512d inverse_cube(__m512d r2)
{
    __m512d y = _mm512_rsqrt14_pd(r2), one = _mm512_set1_pd(1.0);
    __m512d e = _mm512_fnmadd_pd(r2, _mm512_mul_pd(y, y), one), cube = _mm512_mul_pd(_mm512_mul_pd(y, y), y);
    __m512d series = _mm512_fmadd_pd(e, _mm512_set1_pd(2.1875), _mm512_set1_pd(1.875));
    series = _mm512_fmadd_pd(e, series, _mm512_set1_pd(1.5));
    return _mm512_fmadd_pd(_mm512_mul_pd(cube, e), series, cube);
}

struct row {
    __m512d x, y, z, gm, ax, ay, az;
};

static inline struct row row_of(const struct tile *a, int i)
{
    __m512d zero = _mm512_setzero_pd();
    return (struct row){_mm512_set1_pd(a->x[i]), _mm512_set1_pd(a->y[i]), _mm512_set1_pd(a->z[i]),
                        _mm512_set1_pd(a->gm[i]), zero, zero, zero};
}

static inline void finish(struct tile *a, int i, const struct row *row)
{
    a->ax[i] += _mm512_reduce_add_pd(row->ax);
    a->ay[i] += _mm512_reduce_add_pd(row->ay);
    a->az[i] += _mm512_reduce_add_pd(row->az);
}

/* A row and eight columns attract each other: add to the row, and what the columns get to s. */
static inline void meet(struct row *row, const struct tile *b, int j, __mmask8 which, __m512d s[3])
{
    __m512d dx = _mm512_sub_pd(_mm512_load_pd(b->x + j), row->x);
    __m512d dy = _mm512_sub_pd(_mm512_load_pd(b->y + j), row->y);
    __m512d dz = _mm512_sub_pd(_mm512_load_pd(b->z + j), row->z);
    __m512d r2 = _mm512_fmadd_pd(dx, dx, _mm512_set1_pd(SOFTENING2));
    r2 = _mm512_fmadd_pd(dz, dz, _mm512_fmadd_pd(dy, dy, r2));
    __m512d w = _mm512_maskz_mov_pd(which, inverse_cube(r2));
    __m512d mine = _mm512_mul_pd(w, _mm512_load_pd(b->gm + j)), theirs = _mm512_mul_pd(w, row->gm);
    row->ax = _mm512_fmadd_pd(mine, dx, row->ax);
    row->ay = _mm512_fmadd_pd(mine, dy, row->ay);
    row->az = _mm512_fmadd_pd(mine, dz, row->az);
    s[0] = _mm512_fnmadd_pd(theirs, dx, s[0]);
    s[1] = _mm512_fnmadd_pd(theirs, dy, s[1]);
    s[2] = _mm512_fnmadd_pd(theirs, dz, s[2]);
}

static inline void load_sums(const struct tile *b, int j, __m512d s[3])
{
    s[0] = _mm512_load_pd(b->ax + j), s[1] = _mm512_load_pd(b->ay + j), s[2] = _mm512_load_pd(b->az + j);
}

static inline void store_sums(struct tile *b, int j, const __m512d s[3])
{
    _mm512_store_pd(b->ax + j, s[0]), _mm512_store_pd(b->ay + j, s[1]), _mm512_store_pd(b->az + j, s[2]);
}

static void between(struct tile *a, struct tile *b)
{
    for (int i = 0; i < TILE; i += 2) {
        struct row p = row_of(a, i), q = row_of(a, i + 1);
        for (int j = 0; j < TILE; j += LANES) {
            __m512d s[3];
            load_sums(b, j, s);
            meet(&p, b, j, 0xFF, s);
            meet(&q, b, j, 0xFF, s);
            store_sums(b, j, s);
        }
        finish(a, i, &p), finish(a, i + 1, &q);
    }
}

static void within(struct tile *a)
{
    for (int i = 0; i < TILE; i++) {
        struct row p = row_of(a, i);
        for (int j = i / LANES * LANES; j < TILE; j += LANES) {
            __m512d s[3];
            load_sums(a, j, s);
            meet(&p, a, j, j < i ? (__mmask8)(0xFE << (i - j)) : 0xFF, s);
            store_sums(a, j, s);
        }
        finish(a, i, &p);
    }
}

static void evaluate(struct tile *tiles, int count)
{
    for (int i = 0; i < count; i++)
        memset(tiles[i].ax, 0, 3 * TILE * sizeof(double));
    for (int i = 0; i < count; i++) {
        within(&tiles[i]);
        for (int j = 0; j < i; j++)
            between(&tiles[i], &tiles[j]);
    }
}

int main(int arguments, char **argument)
{
    int n = arguments > 1 ? atoi(argument[1]) : 1000, evaluations = arguments > 2 ? atoi(argument[2]) : 1;
    int count = (n + TILE - 1) / TILE;
    struct tile *tiles = aligned_alloc(64, count * sizeof(struct tile));
    for (int i = 0; i < count * TILE; i++) {
        struct tile *tile = &tiles[i / TILE];
        int k = i % TILE;
        tile->x[k] = i < n ? fmod(i * 0.6180339887498949, 1.0) : FAR_AWAY;
        tile->y[k] = i < n ? fmod(i * 0.7548776662466927, 1.0) : FAR_AWAY;
        tile->z[k] = i < n ? fmod(i * 0.8191725133961645, 1.0) : FAR_AWAY;
        tile->gm[k] = i < n ? 1.0 / n : 0.0;
    }
    struct timespec begin, end;
    evaluate(tiles, count);
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (int k = 0; k < evaluations; k++)
        evaluate(tiles, count);
    clock_gettime(CLOCK_MONOTONIC, &end);
    for (int i = 0; i < n; i += n - 1) {
        const struct tile *tile = &tiles[i / TILE];
        printf("%.17g\n%.17g\n%.17g\n", tile->ax[i % TILE], tile->ay[i % TILE], tile->az[i % TILE]);
    }
    double ns = (end.tv_sec - begin.tv_sec) * 1e9 + (end.tv_nsec - begin.tv_nsec);
    printf("%.17g\n", ns / evaluations / n / (n - 1));
    return 0;
}
