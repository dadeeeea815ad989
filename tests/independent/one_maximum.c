/* Taylor models of order 3 in four variables, a cell of places and three sectors: what one_maximum.py asks.
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
static void prepare_arc(void);
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
    prepare_arc(); ready = 1;
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
    T b; zero(&b); LANES b.c[0][l] = f[l]; return mul(a, b);
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
/* k-th derivative of 2 acos(z)^2 = sum of 4 (2 (1 - z))^n/(n^2 (2n over n)) at 1 - z = y; |y| < 1.3, k < 9 */
#define TERMS 240
static double coefficient[9][TERMS];
static void prepare_arc(void) {
    double c = 1; /* 2^n/(2n over n): from one to the next by n/(2n - 1) */
    for (int n = 1; n < TERMS; n++) {
        c *= (double)n / (2 * n - 1);
        coefficient[0][n] = 4 * c / ((double)n * n);
        for (int k = 1; k < 9; k++) coefficient[k][n] = coefficient[k - 1][n] * (n - k + 1);
    }
}
static double arc(int k, double y) {
    double s = 0;
    for (int n = TERMS - 1; n >= k; n--) s = s * y + coefficient[k][n];
    return k % 2 ? -s : s;
}
static T arc_of(int k, T z) {
    double f[5][W], n[W]; T d = z; LANES d.c[0][l] = 0; size(&d, n);
    LANES {
        double y = 1 - z.c[0][l], far = fabs(y) + n[l];
        for (int j = 0; j < 4; j++) f[j][l] = arc(k + j, y);
        f[4][l] = far < 1.3 ? fabs(arc(k + 4, far)) * (1 + 1e-9) : INFINITY;
    }
    T o = compose(d, f);
    LANES o.r[l] += 1e-11 * (fabs(f[0][l]) + fabs(f[1][l]) * n[l] + fabs(f[2][l]) * n[l] * n[l] + fabs(f[3][l]) * pow(n[l], 3));
    return o;
}
/* series in the place, n terms */
#define K 6
typedef struct { T t[K]; int n; } J;
static int min2(int a, int b) { return a < b ? a : b; }
static void jmul(const J *a, const J *b, int n, J *o) {
    static J tmp; tmp.n = min2(n, K); 
    for (int k = 0; k < tmp.n; k++) {
        int first = 1;
        for (int j = 0; j <= k; j++) if (j < a->n && k - j < b->n) {
            T p = mul(a->t[j], b->t[k - j]);
            tmp.t[k] = first ? p : sum(tmp.t[k], p); first = 0;
        }
        if (first) zero(&tmp.t[k]);
    }
    *o = tmp;
}
static void jder(const J *a, J *o) { J t; t.n = a->n - 1; for (int k = 0; k < t.n; k++) t.t[k] = times(a->t[k + 1], k + 1); *o = t; }
static void jadd(const J *a, double f, const J *b, double g, J *o) {
    J t; t.n = min2(a->n, b->n);
    for (int k = 0; k < t.n; k++) { T x = times(a->t[k], f); t.t[k] = add(&x, &b->t[k], g); }
    *o = t;
}
#define ROWS 6
static T at(const J *e, int k) { return times(e->t[k], k == 2 ? 2 : 1); }

/* rows[m][0] + gamma rows[m][1]; end: gamma = gamma_1 times what is left to the limit */
static void rows_of(const T *v, const double *mid, const double *half, int end, T rows[ROWS][2]) {
    static J S, C, S2, Wt, dW, P1, P2, CW, E2, E1, E0, x, y, Q, dQ, n, lin, a[5], b[5];
    T q = v[0], c1s = v[1], c3s = mul(c1s, inv(q)), B2 = root(v[4]), th = root(v[3]), A4 = mul(B2, inv(root(v[2])));
    T theta, s, c, xi, i0[4], i1[3], e0[5], e1[4];
    zero(&theta); LANES { theta.c[0][l] = mid[l]; theta.c[1][l] = half[l]; }
    sincos_of(theta, &s, &c);
    zero(&xi); LANES { xi.c[0][l] = M_PI_2 - mid[l]; xi.c[1][l] = -half[l]; xi.r[l] = 1e-15; }
    double f = 1;
    S.n = C.n = K;
    for (int k = 0; k < K; k++) {
        S.t[k] = times(k % 2 ? c : s, k % 4 > 1 ? -f : f);
        C.t[k] = times(k % 2 ? s : c, k % 4 == 1 || k % 4 == 2 ? -f : f);
        f /= k + 1;
    }
    jmul(&S, &S, K, &S2); Wt = S2; Wt.t[0] = sum(Wt.t[0], c3s); jder(&Wt, &dW);
    jder(&C, &x); jmul(&x, &Wt, K - 1, &x); jmul(&C, &dW, K - 1, &y); jadd(&x, 1, &y, -1, &P1);
    jder(&P1, &x); jmul(&x, &Wt, K - 2, &x); jmul(&P1, &dW, K - 2, &y); jadd(&x, 1, &y, -2, &P2);
    jmul(&C, &Wt, 4, &CW); jmul(&CW, &CW, 3, &E2);
    jmul(&CW, &P1, 3, &E1); for (int k = 0; k < 3; k++) E1.t[k] = times(E1.t[k], -3);
    jmul(&P1, &P1, 3, &x); jmul(&C, &P2, 3, &y); jadd(&x, 3, &y, -1, &E0);
    i0[0] = at(&E0, 1); i0[1] = sum(at(&E1, 1), E0.t[0]); i0[2] = sum(at(&E2, 1), E1.t[0]); i0[3] = E2.t[0];
    i1[0] = E0.t[0]; i1[1] = E1.t[0]; i1[2] = E2.t[0];
    if (end) {
        e0[0] = times(at(&E0, 2), -1);
        e0[1] = times(sum(at(&E1, 2), times(at(&E0, 1), 2)), -1);
        e0[2] = times(sum(sum(at(&E2, 2), times(at(&E1, 1), 2)), E0.t[0]), -1);
        e0[3] = times(sum(times(at(&E2, 1), 2), E1.t[0]), -1);
        e0[4] = times(E2.t[0], -1);
        for (int k = 0; k < 3; k++) e1[k] = less(i1[k], mul(xi, i0[k]));
        e1[3] = times(mul(xi, i0[3]), -1);
    }
    int row = 0, top = end ? 4 : 3;
    for (int crease = 0; crease < 3; crease++) { /* the leading one, and its neighbours */
        T A, B;
        if (!crease) { zero(&A); B = root(c1s); }
        else if (crease == 1) { A = mul(th, B2); B = B2; }
        else { A = A4; B = mul(th, A4); }
        lin = C; n = C;
        for (int k = 0; k < K; k++) { lin.t[k] = mul(C.t[k], B); n.t[k] = mul(C.t[k], A); }
        lin.t[0] = sum(lin.t[0], A); n.t[0] = sum(n.t[0], B);
        jmul(&lin, &lin, K, &Q); jadd(&Q, 1, &S2, 1, &Q); jder(&Q, &dQ);
        for (int k = 0; k < K; k++) n.t[k] = times(n.t[k], 2);
        n.n = top + 1; a[0] = n; b[0].n = 0;
        for (int k = 0; k < top; k++) {
            int m = top - k;
            jder(&a[k], &x); jmul(&x, &Q, m, &x); jmul(&a[k], &dQ, m, &y); jadd(&x, 1, &y, -(k + 1), &a[k + 1]);
            jmul(&n, &a[k], m, &b[k + 1]);
            if (k) {
                jder(&b[k], &x); x.n = min2(x.n, m); jmul(&x, &Q, m, &x); jmul(&b[k], &dQ, m, &y); jadd(&x, 1, &y, -(k + 1), &x);
                jadd(&b[k + 1], 1, &x, 1, &b[k + 1]);
            }
        }
        /* the fold: its value in the middle, and the angle from there */
        T xx = lin.t[0], num, den, z, z3, phi; double y0[W], x0[W], at0[W], nz[W];
        LANES { y0[l] = s.c[0][l]; x0[l] = xx.c[0][l]; at0[l] = 2 * atan2(y0[l], x0[l]); }
        num = less(lanes(s, x0), lanes(xx, y0)); den = sum(lanes(xx, x0), lanes(s, y0));
        z = mul(num, inv(den)); size(&z, nz); z3 = mul(z, mul(z, z)); phi = add(&z, &z3, -1. / 3);
        LANES phi.r[l] = nz[l] < 0.7 ? phi.r[l] + pow(nz[l], 5) / 5 * (1 + EPS) / (1 - nz[l]) : INFINITY;
        phi = plus(times(phi, 2), at0); LANES phi.r[l] += 1e-14;
        T Qp[5]; Qp[1] = Q.t[0]; for (int k = 2; k < 5; k++) Qp[k] = mul(Qp[k - 1], Q.t[0]);
        T pa[2], pb[2];
        for (int g = 0; g < 2; g++) {
            zero(&pa[g]); zero(&pb[g]);
            for (int k = 0; k <= top - g; k++) {
                T w = end ? (g ? e1[k] : e0[k]) : (g ? i1[k] : i0[k]);
                if (k < top) w = mul(w, Qp[top - k]);
                pa[g] = sum(pa[g], mul(w, a[k].t[0]));
                if (k) pb[g] = sum(pb[g], mul(w, b[k].t[0]));
            }
        }
        for (int sign = 1; sign >= -1; sign -= 2) {
            if (!crease && sign == 1) continue;
            T psi = plus1(phi, -sign * M_PI); LANES psi.r[l] += 1e-15;
            for (int g = 0; g < 2; g++) rows[row][g] = sum(mul(psi, pa[g]), pb[g]);
            row++;
        }
    }
    /* the leading crease at rest at its limit: by the square of its fold as a series in p */
    T z = mul(s, inv(root(sum(mul(mul(c, c), c1s), mul(s, s)))));
    T ca = times(mul(root(mul(c3s, inv(Wt.t[0]))), inv(root(q))), 0.5), a2 = mul(ca, ca);
    T F1 = arc_of(1, z), F2 = arc_of(2, z), F3 = arc_of(3, z), F4 = arc_of(4, z);
    T g = mul(less(less(mul(F3, a2), times(mul(F2, z), 0.75)), times(F1, 0.25)), ca);
    T d = sum(less(mul(F4, mul(a2, a2)), times(mul(mul(F3, a2), z), 1.5)),
              sum(mul(F2, less(times(mul(z, z), 3. / 16), a2)), times(mul(F1, z), 1. / 16)));
    T c2 = mul(c, c);
    rows[row][0] = less(mul(mul(d, c2), times(root(c3s), 2)), mul(mul(g, s), sum(times(Wt.t[0], 5), times(c2, 2))));
    rows[row][1] = mul(mul(g, c), Wt.t[0]);
    if (end) rows[row][1] = mul(rows[row][1], xi);
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
/* sine of a sector, or of the sum of two (i, j), first, second and fourth within h */
static T sine(const double *cent, double h, int i, int j) {
    T x, s, c; double f[4] = {0}; zero(&x); f[i] += 1; if (j >= 0) f[j] += 1;
    LANES {
        x.c[0][l] = (cent[i] + (j < 0 ? 0 : cent[j])) * (M_PI / 180); x.r[l] = 8e-15;
        x.c[2][l] = (f[0] - f[2]) * h; x.c[3][l] = (f[1] - f[2]) * h; x.c[4][l] = (f[3] - f[2]) * h;
    }
    sincos_of(x, &s, &c); return s;
}
/* of the branch on which the first crease leads (or, branch = 1, the second): q, 1 - q, the q of its neighbours,
   tanh(d)^2, and (1 - q)/(1 - tanh(d)^2) of its neighbours */
static void numbers(const double *cent, double h, int branch, T *v) {
    T s1 = sine(cent, h, 0, -1), s2 = sine(cent, h, 1, -1), s3 = sine(cent, h, 2, -1), s4 = sine(cent, h, 3, -1), t;
    T s12 = sine(cent, h, 2, 3), s13 = sine(cent, h, 0, 2), s23 = sine(cent, h, 1, 2);
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
        double a = r[k][0].c[0][l], b = r[k][1].c[0][l], v = -a / b;
        if (b > 0 && v > lo[l]) lo[l] = v;
        if (b < 0 && v < hi[l]) hi[l] = v;
    }
}
static void close_up(double *lo, double *hi) {
    if (!isfinite(*lo)) *lo = isfinite(*hi) ? *hi - 1 : 0;
    if (!isfinite(*hi)) *hi = *lo + 1;
}
/* Whether there is a gamma for each cell of [0, pi/2 - zone]; cells are halved down to half the width finest. */
static int inner(const T *v, int n, double zone, double finest) {
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
        LANES { close_up(&lo[l], &hi[l]); if (lo[l] >= hi[l]) return 0; }
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
/* Whether there is one gamma_1 for all m <= 8 W cells of [pi/2 - zone, pi/2]. */
static int last(const T *v, int m, double zone) {
    double lo = -INFINITY, hi = INFINITY;
    for (int block = 0; block < m / W; block++) {
        double mid[W], wide[W], a[W], b[W], step = zone / m;
        LANES { mid[l] = M_PI_2 - zone + step * (block * W + l + .5); wide[l] = step / 2 * (1 + 1e-9); a[l] = -INFINITY; b[l] = INFINITY; }
        rows_of(v, mid, wide, 1, rows[block]);
        narrow(rows[block], a, b);
        LANES { lo = fmax(lo, a[l]); hi = fmin(hi, b[l]); }
    }
    close_up(&lo, &hi);
    for (int t = 0; t < 7; t++) {
        double g[W], o[W], worst = INFINITY;
        LANES g[l] = lo + share[t] * (hi - lo);
        for (int block = 0; block < m / W; block++) for (int k = 0; k < ROWS; k++) {
            low(&rows[block][k][0], &rows[block][k][1], g, o); LANES worst = fmin(worst, o[l]);
        }
        if (worst > 0) return 1;
    }
    return 0;
}
/* cent: sectors [deg] from the first leading crease on; half [deg] of the first, second and fourth; branch 0 or 1: on which
   the first or the second crease leads; n, m: cells of places, multiples of W. */
int one_maximum(const double *cent, double half, int branch, int n, int m, double zone, double finest) {
    T v[5];
    prepare();
    numbers(cent, half * (M_PI / 180) * (1 + EPS), branch, v);
    return inner(v, n, zone, finest) && last(v, m, zone);
}
