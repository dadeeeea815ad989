/* Taylor models of order 3 in four variables, a cell of places and three sectors, and the search for a gamma in each cell:
   what one_maximum.c and two_maxima.c share.  ROWS, how many functions there are, is theirs, and so is rows_of.
   W cells at a time.  c: coefficients, variables from -1 to 1; r: what a function differs from the polynomial at most,
   rounding included (EPS: 512 units in the last place of all that is added up, sums have 200 terms at most). */
#include <math.h>
#include <string.h>
#define W 8
#define N 35
#define EPS 0x1p-44
#define LANES for (int l = 0; l < W; l++)
typedef struct { double c[N][W], r[W]; } T;
static int monomial[N][4], degree[N], pairs[200][3], n_pairs, square[4], ready;

static int find(const int *m) {
    for (int k = 0; k < N; k++)
        if (!memcmp(m, monomial[k], sizeof monomial[k])) return k;
    return -1;
}
static void prepare(void) {
    int k = 0;
    if (ready) return;
    for (int d = 0; d <= 3; d++)
        for (int a = d; a >= 0; a--) for (int b = d - a; b >= 0; b--) for (int c = d - a - b; c >= 0; c--) {
            int m[4] = {a, b, c, d - a - b - c};
            memcpy(monomial[k], m, sizeof m); degree[k++] = d;
        }
    n_pairs = 0;
    for (int i = 0; i < N; i++) for (int j = 0; j < N; j++) if (degree[i] + degree[j] <= 3) {
        int m[4]; for (int v = 0; v < 4; v++) m[v] = monomial[i][v] + monomial[j][v];
        pairs[n_pairs][0] = i; pairs[n_pairs][1] = j; pairs[n_pairs++][2] = find(m);
    }
    for (int v = 0; v < 4; v++) { int m[4] = {0}; m[v] = 2; square[v] = find(m); }
    ready = 1;
}
static void zero(T *a) { memset(a, 0, sizeof *a); }
static void norms(const T *a, double n[4][W]) {
    memset(n, 0, 4 * sizeof *n);
    for (int k = 0; k < N; k++) LANES n[degree[k]][l] += fabs(a->c[k][l]);
}
static void size(const T *a, double *s) {
    double n[4][W]; norms(a, n);
    LANES s[l] = (n[0][l] + n[1][l] + n[2][l] + n[3][l]) * (1 + EPS) + a->r[l];
}
static T add(const T *a, const T *b, double f) { /* a + f b */
    T o;
    for (int k = 0; k < N; k++) LANES o.c[k][l] = a->c[k][l] + f * b->c[k][l];
    LANES o.r[l] = 0;
    for (int k = 0; k < N; k++) LANES o.r[l] += fabs(a->c[k][l]) + fabs(f * b->c[k][l]);
    LANES o.r[l] = (a->r[l] + fabs(f) * b->r[l]) * (1 + EPS) + EPS * o.r[l];
    return o;
}
static T sum(T a, T b) { return add(&a, &b, 1); }
static T less(T a, T b) { return add(&a, &b, -1); }
static T times(T a, double f) { T z; zero(&z); return add(&z, &a, f); }
static T plus(T a, const double *x) {
    LANES { a.c[0][l] += x[l]; a.r[l] += EPS * (fabs(a.c[0][l]) + fabs(x[l])); }
    return a;
}
static T plus1(T a, double x) { double v[W]; LANES v[l] = x; return plus(a, v); }
static T mul(T a, T b) {
    T o; double x[4][W], y[4][W]; zero(&o);
    for (int p = 0; p < n_pairs; p++) {
        double *t = o.c[pairs[p][2]]; const double *u = a.c[pairs[p][0]], *v = b.c[pairs[p][1]];
        LANES t[l] += u[l] * v[l];
    }
    norms(&a, x); norms(&b, y);
    LANES {
        double A = x[0][l] + x[1][l] + x[2][l] + x[3][l], B = y[0][l] + y[1][l] + y[2][l] + y[3][l];
        o.r[l] = (A * b.r[l] + a.r[l] * (B + b.r[l]) + x[1][l] * y[3][l] + x[2][l] * (y[2][l] + y[3][l])
                  + x[3][l] * (y[1][l] + y[2][l] + y[3][l])) * (1 + EPS) + EPS * A * B;
    }
    return o;
}
static T lanes(T a, const double *f) { /* times a number a lane */
    double n[4][W]; norms(&a, n);
    for (int k = 0; k < N; k++) LANES a.c[k][l] *= f[l];
    LANES a.r[l] = (a.r[l] * (1 + EPS) + EPS * (n[0][l] + n[1][l] + n[2][l] + n[3][l])) * fabs(f[l]) * (1 + EPS);
    return a;
}
static T relative(const T *a, double *m, double *n) {
    T e = *a;
    LANES m[l] = a->c[0][l];
    for (int k = 0; k < N; k++) LANES e.c[k][l] /= m[l];
    LANES { e.c[0][l] = 0; e.r[l] = a->r[l] / fabs(m[l]) * (1 + EPS); }
    size(&e, n); LANES { e.r[l] += EPS * (1 + n[l]); n[l] += EPS * (1 + n[l]); }
    return e;
}
static T inv(T a) {
    double m[W], n[W], f[W]; T e = relative(&a, m, n), e2 = mul(e, e), o = plus1(less(e2, sum(e, mul(e, e2))), 1);
    LANES { o.r[l] = n[l] < 0.7 ? o.r[l] + pow(n[l], 4) / (1 - n[l]) * (1 + EPS) : INFINITY; f[l] = 1 / m[l]; }
    return lanes(o, f);
}
static T root(T a) {
    double m[W], n[W], f[W]; T e = relative(&a, m, n), e2 = mul(e, e), e3 = mul(e, e2);
    T o = plus1(add(&e3, &e2, -2), 0); o = times(o, 1. / 16); o = plus1(add(&o, &e, 0.5), 1);
    LANES {
        o.r[l] = n[l] < 0.7 && m[l] > 0 ? o.r[l] + 5. / 128 * pow(n[l], 4) / pow(1 - n[l], 3.5) * (1 + EPS) : INFINITY;
        f[l] = sqrt(m[l]);
    }
    return lanes(o, f);
}
/* sum of f[k] d^k/k! and a bound f[4] of the fourth derivative */
static T compose(T d, double f[5][W]) {
    double n[W]; T d2, d3, o; LANES d.c[0][l] = 0;
    size(&d, n); d2 = mul(d, d); d3 = mul(d, d2);
    o = lanes(d, f[1]); o = sum(o, times(lanes(d2, f[2]), 0.5)); o = sum(o, times(lanes(d3, f[3]), 1. / 6)); o = plus(o, f[0]);
    LANES o.r[l] += f[4][l] * pow(n[l], 4) / 24 * (1 + EPS) + 8 * EPS * (fabs(f[0][l]) + fabs(f[1][l]) * n[l]);
    return o;
}
static void sincos_of(T x, T *s, T *c) {
    double f[5][W], g[5][W];
    LANES {
        double a = sin(x.c[0][l]), b = cos(x.c[0][l]);
        f[0][l] = a; f[1][l] = b; f[2][l] = -a; f[3][l] = -b; f[4][l] = 1;
        g[0][l] = b; g[1][l] = -a; g[2][l] = -b; g[3][l] = a; g[4][l] = 1;
    }
    *s = compose(x, f); *c = compose(x, g);
}
/* twice the angle with tangent y/x: its value in the middle, and the angle from there */
static T angle(const T *y, const T *x) {
    T num, den, z, z3, phi; double y0[W], x0[W], at0[W], nz[W];
    LANES { y0[l] = y->c[0][l]; x0[l] = x->c[0][l]; at0[l] = 2 * atan2(y0[l], x0[l]); }
    num = less(lanes(*y, x0), lanes(*x, y0)); den = sum(lanes(*x, x0), lanes(*y, y0));
    z = mul(num, inv(den)); size(&z, nz); z3 = mul(z, mul(z, z)); phi = add(&z, &z3, -1. / 3);
    LANES phi.r[l] = nz[l] < 0.7 ? phi.r[l] + pow(nz[l], 5) / 5 * (1 + EPS) / (1 - nz[l]) : INFINITY;
    phi = plus(times(phi, 2), at0); LANES phi.r[l] += 1e-14;
    return phi;
}
static void low(const T *a, const T *b, const double *g, double *o) { /* least of a + g b, over the middle value */
    T t = sum(*a, lanes(*b, g));
    double n[4][W]; norms(&t, n);
    LANES {
        double q = n[2][l];
        for (int v = 0; v < 4; v++) { double x = t.c[square[v]][l]; if (x > 0) q -= x; }
        double m = t.c[0][l] - n[1][l] - q - n[3][l] - t.r[l] - EPS * (n[0][l] + n[1][l] + n[2][l] + n[3][l]);
        o[l] = isfinite(m) ? m / (fabs(t.c[0][l]) + 1e-300) : -INFINITY;
    }
}
/* Vertices about one: sectors [deg], and what each gains [rad] in half a width of the three variables. */
typedef struct { const double *cent; double by[4][3]; } Box;
/* sine of a sector, or of the sum of two (i, j) */
static T sine(const Box *b, int i, int j) {
    T x, s, c; zero(&x);
    LANES {
        x.c[0][l] = (b->cent[i] + (j < 0 ? 0 : b->cent[j])) * (M_PI / 180); x.r[l] = 8e-15;
        for (int v = 0; v < 3; v++) x.c[2 + v][l] = b->by[i][v] + (j < 0 ? 0 : b->by[j][v]);
    }
    sincos_of(x, &s, &c); return s;
}
/* of the branch on which the first crease leads (or, branch = 1, the second): q, 1 - q, the q of its neighbours,
   tanh(d)^2, and (1 - q)/(1 - tanh(d)^2) of its neighbours */
static void numbers(const Box *b, int branch, T *v) {
    T s1 = sine(b, 0, -1), s2 = sine(b, 1, -1), s3 = sine(b, 2, -1), s4 = sine(b, 3, -1), t;
    T s12 = sine(b, 2, 3), s13 = sine(b, 0, 2), s23 = sine(b, 1, 2);
    if (branch) { t = s2; s2 = s4; s4 = t; s12 = s23; }
    T i23 = inv(mul(s2, s3)), i34 = inv(mul(s3, s4)), i24 = inv(mul(s2, s4));
    v[0] = mul(mul(s1, s4), i23);
    v[1] = times(mul(mul(s12, s13), i23), -1);
    v[2] = mul(mul(s1, s2), i34);
    v[3] = mul(mul(s1, s3), i24);
    v[4] = times(mul(mul(s13, s2), inv(mul(s12, s3))), -1);
}
static const double share[7] = {.5, .35, .65, .2, .8, .1, .9};
static T rows[8][ROWS][2];
/* Narrow lo, hi to the gammas that are good at the middle of a block of cells, one pair a lane. */
static void narrow(T r[ROWS][2], double *lo, double *hi) {
    for (int k = 0; k < ROWS; k++) LANES {
        double a = r[k][0].c[0][l], b = r[k][1].c[0][l], x = -a / b;
        if (b > 0 && x > lo[l]) lo[l] = x;
        if (b < 0 && x < hi[l]) hi[l] = x;
    }
}
static void close_up(double *lo, double *hi) {
    if (!isfinite(*lo)) *lo = isfinite(*hi) ? *hi - 1 - fabs(*hi) : 0;
    if (!isfinite(*hi)) *hi = *lo + 1 + fabs(*lo);
}
typedef void Rows(const T *v, const double *mid, const double *half, int end, T rows[ROWS][2]);
/* Whether there is a gamma for each cell of [0, pi/2 - zone]; cells are halved down to half the width finest.
   -1: there is none at the middle of one, so that smaller boxes about the vertex in the middle are of no use. */
static int inner(Rows *rows_of, const T *v, int n, double zone, double finest) {
    static double at_[4096], half_[4096]; int left = n; double step = (M_PI_2 - zone) / n;
    for (int k = 0; k < n; k++) { at_[k] = step * (k + .5); half_[k] = step / 2; }
    while (left > 0) {
        double mid[W], wide[W], lo[W], hi[W], best[W]; int many = left < W ? left : W;
        LANES {
            int k = left - 1 - (l < many ? l : 0);
            mid[l] = at_[k]; wide[l] = half_[k] * (1 + 1e-9); lo[l] = -INFINITY; hi[l] = INFINITY; best[l] = -INFINITY;
        }
        left -= many;
        rows_of(v, mid, wide, 0, rows[0]);
        narrow(rows[0], lo, hi);
        LANES { close_up(&lo[l], &hi[l]); if (lo[l] >= hi[l]) return -1; }
        for (int t = 0; t < 7; t++) {
            double g[W], worst[W], o[W]; int all = 1;
            LANES { g[l] = lo[l] + share[t] * (hi[l] - lo[l]); worst[l] = INFINITY; }
            for (int k = 0; k < ROWS; k++) { low(&rows[0][k][0], &rows[0][k][1], g, o); LANES worst[l] = fmin(worst[l], o[l]); }
            LANES { best[l] = fmax(best[l], worst[l]); if (!(best[l] > 0)) all = 0; }
            if (all) break;
        }
        for (int l = 0; l < many; l++) if (!(best[l] > 0)) {
            double x = mid[l], r = wide[l] / (1 + 1e-9) / 2;
            if (r < finest || left > 4000) return 0;
            at_[left] = x + r; half_[left++] = r; at_[left] = x - r; half_[left++] = r;
        }
    }
    return 1;
}
