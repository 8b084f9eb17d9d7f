/* The sums of contact.foot_force, vectorised by hand: the mark to compare the compiled loop with.

   Vectors of eight doubles; with AVX-512 the reciprocal square root is the machine's 14-bit estimate
   and two Newton steps. The outer loop repeats the sums at a slightly different speed every time, so
   that no compiler can take them out of it. */

#include <math.h>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

typedef double v8 __attribute__((vector_size(64)));
typedef double v8u __attribute__((vector_size(64), aligned(8)));
typedef long long m8 __attribute__((vector_size(64)));

typedef struct {
    double A00, A10, B01, B_sum, B_diff, C01, C_sum, C_diff, D10;
} law_t;

#define LOAD(p) (*(const v8u *)((p) + i))

static inline v8 rsqrt(v8 a)
{
#ifdef __AVX512F__
    v8 q = (v8)_mm512_rsqrt14_pd((__m512d)a), half = 0.5 * a;
    q = q * (1.5 - half * q * q);
    return q * (1.5 - half * q * q);
#else
    v8 q;
    for (int j = 0; j < 8; j++)
        q[j] = 1.0 / sqrt(a[j]);
    return q;
#endif
}

static inline double sum(v8 a)
{
    double total = 0.0;
    for (int j = 0; j < 8; j++)
        total += a[j];
    return total;
}

static inline __attribute__((always_inline)) void foot_force(
    double *restrict out, const double *restrict X, const double *restrict Z, const double *restrict C2,
    const double *restrict S2, const double *restrict AREA, long n, const law_t *law, double za, double vx,
    double vz, double cs, double sn, double rate, double creep, double c_stage, int jacobian)
{
    const double c2p = cs * cs - sn * sn, s2p = 2.0 * sn * cs, eps2 = creep * creep;
    const double rate_cos = rate * cs, rate_sin = rate * sn;
    const v8 zero = {0};
    v8 fx = zero, fz = zero, power = zero, jxx = zero, jxz = zero, jzx = zero, jzz = zero;
    for (long i = 0; i < n; i += 8) {
        v8 x = LOAD(X), z = LOAD(Z), area = LOAD(AREA), c2 = LOAD(C2), s2 = LOAD(S2);
        v8 rz = sn * x + cs * z;
        v8 depth = -(za + rz);
        m8 wet = depth > 0.0;
        depth = (v8)((m8)depth & wet);
        v8 k = area * depth;
        v8 ux = vx - rate * rz, uz = vz + rate_cos * x - rate_sin * z;
        v8 q = rsqrt(ux * ux + uz * uz + eps2);
        v8 hx = ux * q, hz = uz * q;
        v8 c = c2 * c2p - s2 * s2p, s = s2 * c2p + c2 * s2p;
        v8 mxx = law->C01 + law->C_sum * c, mxz = law->C_diff * s;
        v8 mzx = -law->B_diff * s, mzz = law->B01 + law->B_sum * c;
        v8 px = -law->D10 * s - mxx * hx - mxz * hz;
        v8 pz = law->A00 + law->A10 * c - mzx * hx - mzz * hz;
        fx += k * px;
        fz += k * pz;
        power += k * (px * ux + pz * uz);
        if (jacobian) {
            v8 slope = (v8)((m8)(c_stage * area) & wet), kq = k * q;
            v8 txx = 1.0 - hx * hx, txz = -hx * hz, tzz = 1.0 - hz * hz;
            jxx -= kq * (mxx * txx + mxz * txz);
            jxz -= kq * (mxx * txz + mxz * tzz) + slope * px;
            jzx -= kq * (mzx * txx + mzz * txz);
            jzz -= kq * (mzx * txz + mzz * tzz) + slope * pz;
        }
    }
    out[0] += sum(fx), out[1] += sum(fz), out[2] += sum(power);
    if (jacobian)
        out[3] += sum(jxx), out[4] += sum(jxz), out[5] += sum(jzx), out[6] += sum(jzz);
}

/* motion: za, vx, vz, cos, sin, rate, creep, c; n: plates, whole blocks of eight */
void repeat_sums(
    double *out, const double *x, const double *z, const double *c2, const double *s2, const double *area,
    long n, const law_t *law, const double *m, int jacobian, long repeats, double change)
{
    for (int j = 0; j < 7; j++)
        out[j] = 0.0;
    for (long r = 0; r < repeats; r++) {
        double vx = m[1] + change * (double)r;
        if (jacobian)
            foot_force(out, x, z, c2, s2, area, n, law, m[0], vx, m[2], m[3], m[4], m[5], m[6], m[7], 1);
        else
            foot_force(out, x, z, c2, s2, area, n, law, m[0], vx, m[2], m[3], m[4], m[5], m[6], m[7], 0);
    }
}
