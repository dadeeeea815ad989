/* What two_maxima.py asks, in Taylor models. */
#define ROWS 10
#include "taylor_models.h"

static double shift; /* u1 = (c + tau) Q_0, u2 = (c + shift) Q_1 */

static T cross(const T *x, const T *y, int j, int k) { return less(mul(x[j], y[k]), mul(x[k], y[j])); }

/* Derivatives by c of a linear function of c (its value and slope) times one of second degree (value and two derivatives). */
static void product(const T *linear, const T *q, T *o) {
    T x = mul(linear[1], q[1]);
    o[0] = mul(linear[0], q[0]);
    o[1] = sum(mul(linear[1], q[0]), mul(linear[0], q[1]));
    o[2] = sum(times(x, 2), mul(linear[0], q[2]));
    o[3] = times(mul(linear[1], q[2]), 3);
}
/* and divided by it, two of them. */
static void quotient(const T *linear, const T *q, const T *iq, T *o) {
    T x;
    o[0] = mul(linear[0], *iq);
    o[1] = mul(less(linear[1], mul(o[0], q[1])), *iq);
    x = sum(times(mul(o[1], q[1]), 2), mul(o[0], q[2]));
    o[2] = times(mul(x, *iq), -1);
}
/* Nine rows are inequalities row[0] + gamma row[1] > 0 of the eight functions and of u1; the tenth that of the Wronskian. */
static void rows_of(const T *v, const double *mid, const double *half, int end, T rows[ROWS][2]) {
    static T n[4][4], rho[4][3], fold[4], u[2][4], H[4], D[4], Q[2][3], iQ[2], top[4][2];
    T q = v[0], tau = v[5], beta = v[6], one, none, theta, s, c, x, y;
    const T *root_ = v + 7;
    (void)end;
    zero(&none); one = plus1(none, 1);
    zero(&theta); LANES { theta.c[0][l] = mid[l]; theta.c[1][l] = half[l]; }
    sincos_of(theta, &s, &c);
    T s2 = mul(s, s), s4 = mul(s2, s2), c2 = mul(c, c), near = sum(c, tau), far = plus1(mul(c, tau), 1);
    Q[0][0] = sum(v[1], mul(q, s2)); Q[0][1] = times(mul(q, c), -2); Q[0][2] = times(q, -2);
    Q[1][0] = sum(mul(near, near), mul(beta, s2));
    Q[1][1] = times(less(near, mul(beta, c)), 2); Q[1][2] = times(plus1(times(beta, -1), 1), 2);
    for (int i = 0; i < 2; i++) iQ[i] = inv(Q[i][0]);
    top[0][0] = one; top[0][1] = none; top[2][0] = c; top[2][1] = one;
    top[1][0] = far; top[1][1] = tau; top[3][0] = near; top[3][1] = one;
    /* tan(fold/2) = s root/linear: leading, neighbours, opposite */
    x = mul(root_[0], c); fold[0] = angle(&s, &x);
    y = mul(s, root_[1]); fold[1] = angle(&y, &near);
    y = mul(s, v[11]); fold[2] = angle(&y, &root_[0]);
    y = mul(s, root_[3]); fold[3] = angle(&y, &far);
    for (int i = 0; i < 4; i++) {
        product(top[i], Q[1 - i % 2], n[i]);
        quotient(top[i], Q[i % 2], &iQ[i % 2], rho[i]);
        for (int j = 0; j < 3; j++) rho[i][j] = times(mul(rho[i][j], root_[i]), 2);
    }
    for (int j = 0; j < 4; j++) { u[0][j] = n[3][j]; u[1][j] = add(&n[2][j], &n[0][j], shift); }
    T w01 = cross(u[0], u[1], 0, 1), w02 = cross(u[0], u[1], 0, 2), w12 = cross(u[0], u[1], 1, 2);
    T w03 = cross(u[0], u[1], 0, 3), w13 = cross(u[0], u[1], 1, 3);
    for (int i = 0; i < 2; i++) {
        x = less(mul(n[i][0], w12), mul(n[i][1], w02)); H[i] = sum(x, mul(n[i][2], w01));
        x = less(mul(n[i][0], w13), mul(n[i][1], w03)); D[i] = sum(x, mul(n[i][3], w01));
    }
    H[2] = times(H[0], -shift); D[2] = times(D[0], -shift); H[3] = D[3] = none; /* as u1 and u2 give 0 */
    int row = 0;
    for (int i = 0; i < 4; i++) {
        T *m = n[i], *r = rho[i], r0c = mul(r[0], c), first = sum(mul(r[1], s2), r0c), E, G, second, third;
        /* s^3 and s^5 times the second and third derivative of the fold, turned */
        second = first;
        third = sum(mul(r[2], s4), sum(times(mul(mul(r[1], c), s2), 2), mul(r[0], sum(s2, times(c2, 3)))));
        E = less(mul(mul(m[0], mul(r[0], s2)), w02),
                 mul(sum(times(mul(m[1], mul(r[0], s2)), 2), mul(m[0], second)), w01));
        x = sum(times(mul(m[2], mul(r[0], s4)), 3), times(mul(m[1], mul(second, s2)), 3));
        x = sum(x, mul(m[0], third));
        G = less(mul(mul(m[0], mul(r[0], s4)), w03), mul(x, w01));
        T s3H = mul(mul(s2, s), H[i]), s5D = mul(mul(s4, s), D[i]);
        for (int sign = 1; sign >= -1; sign -= 2) {
            T psi = plus1(fold[i], sign * M_PI); LANES psi.r[l] += 1e-15;
            rows[row][0] = times(sum(mul(psi, s5D), G), -1);
            rows[row][1] = sum(mul(psi, s3H), E);
            row++;
        }
    }
    rows[row][0] = u[0][0]; rows[row++][1] = none;
    rows[row][0] = w01; rows[row++][1] = none;
}
/* cent: sectors [deg] from the first leading crease on; half [deg]: of the sums of the first and second, first and fourth,
   and of the first; branch 0 or 1: on which the first or the second crease leads; with: shift; n: cells of places.
   1: shown.  Else as inner, and in where to which of the three that is due most of all. */
int two_maxima(const double *cent, const double *half, int branch, double with, int n, double finest,
               int *where) {
    T v[12];
    double x = half[0] * (M_PI / 180) * (1 + EPS), y = half[1] * (M_PI / 180) * (1 + EPS), z = half[2] * (M_PI / 180) * (1 + EPS);
    Box box = {cent, {{0, 0, z}, {x, 0, -z}, {-x, -y, z}, {0, y, -z}}};
    prepare();
    shift = with;
    numbers(&box, branch, v);
    v[5] = root(v[3]); v[6] = inv(v[4]); v[11] = root(v[0]);
    v[7] = root(v[1]); v[8] = root(v[6]); v[9] = mul(v[7], v[11]); v[10] = mul(v[8], root(v[2]));
    int found = inner(rows_of, v, n, 0, finest);
    if (found == 1) return 1;
    double most = -1;
    for (int d = 0; d < 3; d++) {
        double part = 0;
        for (int i = 0; i < 5; i++)
            for (int k = 0; k < N; k++) part += fabs(v[i].c[k][0] / v[i].c[0][0]) * monomial[k][1 + d];
        if (part > most) { most = part; *where = d; }
    }
    return found;
}
