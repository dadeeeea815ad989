/* What one_maximum.py asks, in Taylor models. */
#define ROWS 6
#include "taylor_models.h"

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
        T phi = angle(&s, &lin.t[0]);
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
    prepare(); if (!coefficient[0][1]) prepare_arc();
    double h = half * (M_PI / 180) * (1 + EPS);
    Box box = {cent, {{h, 0, 0}, {0, h, 0}, {-h, -h, -h}, {0, 0, h}}};
    numbers(&box, branch, v);
    return inner(rows_of, v, n, zone, finest) == 1 && last(v, m, zone);
}
