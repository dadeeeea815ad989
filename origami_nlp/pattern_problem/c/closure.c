/* Closure of a pattern and steps of least length onto it, as `closure.py` and `equations.py` have them.

   JJ' + eps is banded where loops that share creases are numbered near each other (Cuthill and McKee): Cholesky's
   factors stay inside the band.  Rows of loop l go to `place[l]`, ...; those of creases that stay are left out. */

static void cross(const double *a, const double *b, double *out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static void rotate(const double *q, const double *v, double *out) {
  double t[3], u[3];
  cross(q + 1, v, t);
  for (int i = 0; i < 3; i++) t[i] *= 2;
  cross(q + 1, t, u);
  for (int i = 0; i < 3; i++) out[i] = v[i] + q[0] * t[i] + u[i];
}

/* Turn along every loop: axes c [E, 3], of holes points o [E, 3], q [L, 4] and t [L, 3]; values [m] by places. */
static void turn(const Loops *p, const double *phi, Place *at) {
  for (int64_t l = 0; l < p->loops; l++) {
    double q[4] = {p->start[l], 0.0, 0.0, 0.0}, *t = at->t + 3 * l;
    int hole = p->rows[l] == 6;
    t[0] = t[1] = t[2] = 0.0;
    for (int64_t e = p->first[l]; e < p->first[l + 1]; e++) {
      const double *b = p->axis + 3 * e, half = 0.5 * (phi[p->crease[e]] - p->reference[e]);
      double co = cos(half), si = sin(half), turned[4], near[3], far[3], x[3], *c = at->c + 3 * e;
      turned[0] = -dot(q + 1, b, 3); /* q (0, b) */
      cross(q + 1, b, turned + 1);
      for (int i = 0; i < 3; i++) turned[1 + i] += q[0] * b[i];
      cross(turned + 1, q + 1, x);
      for (int i = 0; i < 3; i++) c[i] = q[0] * turned[1 + i] - turned[0] * q[1 + i] - x[i];
      if (hole) rotate(q, p->point + 3 * e, near);
      for (int i = 0; i < 4; i++) q[i] = co * q[i] + si * turned[i];
      if (hole) {
        rotate(q, p->point + 3 * e, far);
        for (int i = 0; i < 3; i++) at->o[3 * e + i] = t[i] + near[i], t[i] += near[i] - far[i];
      }
    }
    double *value = at->value + p->place[l];
    for (int i = 0; i < 4; i++) at->q[4 * l + i] = q[i];
    for (int i = 0; i < 3; i++) value[i] = q[1 + i];
    for (int i = 0; i < 3 && hole; i++) value[3 + i] = (t[i] + p->moved[3 * l + i]) / p->size;
  }
}

/* Derivatives of the equations of each loop by its turns, [E, 6]. */
static void slopes(const Loops *p, const Place *at, double *j) {
  for (int64_t l = 0; l < p->loops; l++)
    for (int64_t e = p->first[l]; e < p->first[l + 1]; e++) {
      const double *c = at->c + 3 * e, *q = at->q + 4 * l;
      double x[3], *out = j + 6 * e;
      cross(c, q + 1, x);
      for (int i = 0; i < 3; i++) out[i] = 0.5 * (q[0] * c[i] + x[i]);
      if (p->rows[l] == 3) continue;
      for (int i = 0; i < 3; i++) x[i] = at->t[3 * l + i] - at->o[3 * e + i];
      cross(c, x, out + 3);
      for (int i = 0; i < 3; i++) out[3 + i] /= p->size;
    }
}

/* Closure [m] and its Jacobian [m, n], which comes as zeros, by rows as `Closure` numbers them; the least real part of q. */
double equations(const Loops *p, const double *phi, Place *at, double *values, double *jacobian) {
  double least = INFINITY;
  turn(p, phi, at);
  slopes(p, at, at->j);
  for (int64_t l = 0; l < p->loops; l++) {
    if (at->q[4 * l] < least) least = at->q[4 * l];
    for (int64_t a = 0; a < p->rows[l]; a++) {
      values[p->row[l] + a] = at->value[p->place[l] + a];
      for (int64_t e = p->first[l]; e < p->first[l + 1]; e++)
        jacobian[(p->row[l] + a) * p->n + p->crease[e]] += at->j[6 * e + a];
    }
  }
  return least;
}

/* Hessian of lam . closure [n, n], which comes as zeros (`Closure.hessian`). */
void bend(const Loops *p, const double *phi, Place *at, const double *lam, double *h) {
  turn(p, phi, at);
  for (int64_t l = 0; l < p->loops; l++)
    for (int64_t j = p->first[l]; j < p->first[l + 1]; j++) {
      const double *cj = at->c + 3 * j, *q = at->q + 4 * l, *by = lam + p->row[l];
      double arm[3] = {0.0, 0.0, 0.0}, x[3], y[3];
      for (int i = 0; i < 3 && p->rows[l] == 6; i++) x[i] = (at->t[3 * l + i] - at->o[3 * j + i]) / p->size;
      if (p->rows[l] == 6) cross(cj, x, arm);
      for (int64_t i = p->first[l]; i <= j; i++) { /* i before j in the walk */
        const double *ci = at->c + 3 * i;
        cross(ci, cj, x);
        cross(x, q + 1, y);
        double value = 0.25 * (q[0] * dot(x, by, 3) + dot(y, by, 3) - dot(ci, cj, 3) * dot(q + 1, by, 3));
        cross(ci, arm, x);
        if (p->rows[l] == 6) value += dot(x, by + 3, 3);
        h[p->crease[i] * p->n + p->crease[j]] += value;
        if (i != j) h[p->crease[j] * p->n + p->crease[i]] += value;
      }
    }
}

/* Cholesky's factors of JJ' + eps, column by column [m, band + 1], by rows that end; 0 where it is not definite. */
static int factorise(const Loops *p, const double *j, const int64_t *stays, double *l) {
  int64_t m = p->m, w = p->band + 1;
  memset(l, 0, m * w * sizeof(double));
  for (int64_t i = 0; i < m; i++) l[i * w] = WEIGHT;
  for (int64_t k = 0; k < p->pairs; k++) {
    int64_t e = p->one[k], f = p->other[k];
    if (stays[p->crease[e]]) continue;
    int64_t le = p->of[e], lf = p->of[f];
    for (int64_t a = 0; a < p->rows[le]; a++)
      for (int64_t b = 0; b < p->rows[lf]; b++) {
        int64_t row = p->place[le] + a, column = p->place[lf] + b;
        if (row >= column) l[column * w + row - column] += j[6 * e + a] * j[6 * f + b];
      }
  }
  for (int64_t k = 0; k < m; k++) {
    double *column = l + k * w;
    if (!(column[0] > 0.0)) return 0;
    column[0] = sqrt(column[0]);
    int64_t last = k + p->band < m ? p->band : m - 1 - k;
    while (last && column[last] == 0.0) last--;
    for (int64_t i = 1; i <= last; i++) column[i] /= column[0];
    for (int64_t i = 1; i <= last; i++) {
      double *restrict to = column + i * w, by = column[i];
      const double *restrict from = column + i;
      if (by == 0.0) continue;
      for (int64_t r = 0; r <= last - i; r++) to[r] -= by * from[r];
    }
  }
  return 1;
}

/* Solve (JJ' + eps) x = b in place. */
static void solve(const Loops *p, const double *l, double *b) {
  int64_t m = p->m, w = p->band + 1;
  for (int64_t k = 0; k < m; k++) {
    const double *column = l + k * w;
    int64_t last = k + p->band < m ? p->band : m - 1 - k;
    b[k] /= column[0];
    for (int64_t i = 1; i <= last; i++) b[k + i] -= column[i] * b[k];
  }
  for (int64_t k = m - 1; k >= 0; k--) {
    const double *column = l + k * w;
    int64_t last = k + p->band < m ? p->band : m - 1 - k;
    b[k] = (b[k] - dot(column + 1, b + k + 1, last)) / column[0];
  }
}

/* J' lam of the creases that do not stay. */
static void carried(const Loops *p, const double *j, const int64_t *stays, const double *lam, double *out) {
  memset(out, 0, p->n * sizeof(double));
  for (int64_t e = 0; e < p->first[p->loops]; e++)
    if (!stays[p->crease[e]]) out[p->crease[e]] += dot(j + 6 * e, lam + p->place[p->of[e]], p->rows[p->of[e]]);
}

/* J d. */
static void moved(const Loops *p, const double *j, const double *d, double *out) {
  memset(out, 0, p->m * sizeof(double));
  for (int64_t e = 0; e < p->first[p->loops]; e++) {
    int64_t l = p->of[e];
    for (int64_t a = 0; a < p->rows[l]; a++) out[p->place[l] + a] += j[6 * e + a] * d[p->crease[e]];
  }
}

/* Move fold angles onto closure by steps of least length (`PatternEquations.project`), by factors at `near` to begin with, and say where loops end:
   the largest entry of closure, and the least real part of q. */
void project(const Loops *p, double *phi, const int64_t *stays, int64_t steps, const double *near, Place *at,
             double *ends) {
  double before = INFINITY, *j = at->j, *l = at->l;
  int known = 0;
  if (near) {
    turn(p, near, at);
    slopes(p, at, j);
    known = factorise(p, j, stays, l);
  }
  for (int64_t step = 0;; step++) {
    turn(p, phi, at);
    ends[0] = largest(at->value, p->m);
    if (step == steps || ends[0] <= ROUNDED) break;
    double size = sqrt(dot(at->value, at->value, p->m));
    if (!known || !(size <= FALLS * before)) {
      slopes(p, at, j);
      if (!factorise(p, j, stays, l)) break;
      known = 1;
    }
    before = size;
    solve(p, l, at->value);
    carried(p, j, stays, at->value, at->d);
    double most = largest(at->d, p->n), share = most > LONGEST ? LONGEST / most : 1.0;
    for (int64_t i = 0; i < p->n; i++) phi[i] -= share * at->d[i];
  }
  ends[1] = INFINITY;
  for (int64_t k = 0; k < p->loops; k++)
    if (at->q[4 * k] < ends[1]) ends[1] = at->q[4 * k];
}

/* Second derivatives of the equations along v twice, by places. */
static void second(const Loops *p, const Place *at, const double *v, double *out) {
  for (int64_t l = 0; l < p->loops; l++) {
    double x[3], y[3], sum[3] = {0.0, 0.0, 0.0}, crosses[3] = {0.0, 0.0, 0.0}, arms[3] = {0.0, 0.0, 0.0};
    const double *q = at->q + 4 * l;
    for (int64_t e = p->first[l]; e < p->first[l + 1]; e++) {
      double s = v[p->crease[e]], arm[3];
      const double *c = at->c + 3 * e;
      cross(sum, c, x); /* pairs i before j twice: c_i x c_j */
      for (int i = 0; i < 3; i++) crosses[i] += 2 * s * x[i];
      if (p->rows[l] == 6) {
        for (int i = 0; i < 3; i++) x[i] = at->t[3 * l + i] - at->o[3 * e + i], y[i] = 2 * sum[i] + s * c[i];
        cross(c, x, arm);
        cross(y, arm, x);
        for (int i = 0; i < 3; i++) arms[i] += s * x[i] / p->size;
      }
      for (int i = 0; i < 3; i++) sum[i] += s * c[i];
    }
    double dots = dot(sum, sum, 3), *to = out + p->place[l];
    cross(crosses, q + 1, x);
    for (int i = 0; i < 3; i++) to[i] = 0.25 * (q[0] * crosses[i] + x[i] - dots * q[1 + i]);
    for (int i = 0; i < 3 && p->rows[l] == 6; i++) to[3 + i] = arms[i];
  }
}

/* Where a curve of closed states goes at phi (`ClosedStates.at`): what closure leaves of v, to rounding, its length
   in size, then of that over its length the curvature; 0 where corrections stall. */
int64_t follow(const Loops *p, const double *phi, double *v, double *bend, double *size, Place *at) {
  double most = largest(v, p->n), before = INFINITY, *j = at->j, *l = at->l;
  int64_t *stays = at->none, settled = 0;
  turn(p, phi, at);
  slopes(p, at, j);
  if (!factorise(p, j, stays, l)) return 0;
  for (int64_t k = 0; k < MOST_TIMES; k++) {
    moved(p, j, v, at->value);
    solve(p, l, at->value);
    carried(p, j, stays, at->value, at->d);
    for (int64_t i = 0; i < p->n; i++) v[i] -= at->d[i];
    double step = largest(at->d, p->n);
    if ((settled = step <= EPS * most)) break;
    if (step > STALLS * before) {
      settled = step <= ROUNDED * most;
      break;
    }
    before = step;
  }
  if (!settled) return 0;
  *size = sqrt(dot(v, v, p->n));
  for (int64_t i = 0; i < p->n; i++) v[i] /= *size > NONZERO ? *size : NONZERO;
  second(p, at, v, at->value);
  solve(p, l, at->value);
  carried(p, j, stays, at->value, bend);
  for (int64_t i = 0; i < p->n; i++) bend[i] = -bend[i];
  return 1;
}
