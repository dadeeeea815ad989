/* One sample after the other: what `starts.batch_closure` and `starts.crossings` say of arrays of samples. */

typedef struct {
  Folded at;
  double value[ROWS], multipliers[ROWS], *rows, *free, *torque, *left; /* [ROWS, n], [ROWS, n], [n], [n] */
  double gram[ROWS * ROWS], work[ROWS * ROWS], inverse[ROWS * ROWS], vectors[ROWS * ROWS];
} Point;

typedef struct {
  double *x;
  int64_t *at_limit, slots[SLOTS], sides[SLOTS];
} Trial;

static double limit_of(const Vertex *v, int64_t i, int64_t side) { return side > 0 ? v->high[i] : v->low[i]; }

static int beyond(const Vertex *v, const double *x, int64_t i) {
  return !(x[i] <= v->high[i] + ROUNDED && x[i] >= v->low[i] - ROUNDED);
}

/* Fold a state; write closure, held gaps and their Jacobian; return how many rows there are. */
static int64_t rows_at(const Vertex *v, const double *x, const int64_t *slots, const int64_t *sides, Point *p) {
  int64_t used = 0;
  fold(v, x, &p->at);
  closure(v, &p->at, p->value, p->rows);
  for (int64_t s = 0; s < SLOTS; s++)
    if (slots[s] != OPEN) used = s + 1;
  for (int64_t s = 0; s < used; s++) {
    double *row = p->rows + (v->m + s) * v->n;
    p->value[v->m + s] = 0.0;
    for (int64_t i = 0; i < v->n; i++) row[i] = 0.0;
    if (slots[s] == OPEN) continue;
    p->value[v->m + s] = sides[s] * gap_at(v, &p->at, slots[s], row);
    for (int64_t i = 0; i < v->n; i++) row[i] *= sides[s];
  }
  return v->m + used;
}

/* Invert a symmetric matrix of three rows by its cofactors; 0 where that is not finite. */
static int invert_three(const double *a, double *out) {
  double p = a[0], q = a[1], r = a[2], s = a[ROWS + 1], t = a[ROWS + 2], u = a[2 * ROWS + 2];
  double pp = s * u - t * t, pq = r * t - q * u, pr = q * t - r * s, over = 1 / (p * pp + q * pq + r * pr);
  out[0] = pp * over, out[ROWS + 1] = (p * u - r * r) * over, out[2 * ROWS + 2] = (p * s - q * q) * over;
  out[1] = out[ROWS] = pq * over;
  out[2] = out[2 * ROWS] = pr * over;
  out[ROWS + 2] = out[2 * ROWS + 1] = (q * r - p * t) * over;
  return all_finite(out, 3, ROWS);
}

/* The rows on the free creases, and the inverse of their Gram matrix (`gram_inverse`); 2: its pseudo-inverse; 0: it breaks
   down. */
static int invert_gram(const Vertex *v, const int64_t *at_limit, int64_t rows, Point *p) {
  int64_t n = v->n;
  double trace = 0.0, largest = 0.0, most = -INFINITY, *gram = p->gram;
  for (int64_t e = 0; e < rows; e++)
    for (int64_t i = 0; i < n; i++) p->free[e * n + i] = at_limit[i] ? 0.0 : p->rows[e * n + i];
  for (int64_t e = 0; e < rows; e++) {
    for (int64_t f = 0; f <= e; f++)
      gram[e * ROWS + f] = gram[f * ROWS + e] = dot(p->free + e * n, p->free + f * n, n);
    trace += gram[e * ROWS + e];
  }
  for (int64_t e = 0; e < rows; e++) gram[e * (ROWS + 1)] += gram[e * (ROWS + 1)] ? ROUNDED * ROUNDED * trace : 1.0;
  for (int64_t e = 0; e < rows; e++) {
    for (int64_t f = 0; f < rows; f++) p->work[e * ROWS + f] = gram[e * ROWS + f];
    p->work[e * (ROWS + 1)] += EPS * trace;
  }
  int good = rows == 3 ? invert_three(p->work, p->inverse) : invert(p->work, rows, ROWS, p->inverse);
  for (int64_t e = 0; good && e < rows; e++) largest = fmax(largest, fabs(p->inverse[e * (ROWS + 1)]));
  if (good && largest * fmax(trace, 1.0) <= POOR) return 1;
  if (!all_finite(gram, rows, ROWS)) return 0;
  eigen(gram, rows, ROWS, p->vectors);
  for (int64_t e = 0; e < rows; e++) most = fmax(most, gram[e * (ROWS + 1)]);
  for (int64_t e = 0; e < rows; e++)
    for (int64_t f = 0; f < rows; f++) {
      double total = 0.0;
      for (int64_t k = 0; k < rows; k++) /* eigenvalues of rows rows' are squares of singular values */
        if (gram[k * (ROWS + 1)] > RANK * RANK * most)
          total += p->vectors[e * ROWS + k] * p->vectors[f * ROWS + k] / gram[k * (ROWS + 1)];
      p->inverse[e * ROWS + f] = total;
    }
  return 2;
}

/* The multipliers of rows that balance the torque best on the free creases, and what is left of it. */
static int balance(const Vertex *v, const int64_t *at_limit, int64_t rows, Point *p) {
  int64_t n = v->n;
  if (!invert_gram(v, at_limit, rows, p)) return 0;
  for (int64_t e = 0; e < ROWS; e++) p->multipliers[e] = 0.0;
  for (int64_t i = 0; i < n; i++) p->left[i] = p->torque[i];
  for (int refined = 0; refined < 2; refined++) {
    for (int64_t e = 0; e < rows; e++) p->value[e] = dot(p->free + e * n, p->left, n);
    for (int64_t e = 0; e < rows; e++) p->multipliers[e] += dot(p->inverse + e * ROWS, p->value, rows);
    for (int64_t i = 0; i < n; i++) {
      double total = 0.0;
      for (int64_t e = 0; e < rows; e++) total += p->multipliers[e] * p->rows[e * n + i];
      p->left[i] = p->torque[i] - total;
    }
  }
  return 1;
}

/* Close a state on its stratum, in place (`Closing.close`), by the shortest way in a metric (NULL: of angles); 0 where
   linear algebra breaks down. */
static int close_state(const Vertex *v, Trial *t, double to, const double *root, Point *p) {
  int64_t n = v->n;
  double *x = t->x, *move = p->left;
  for (int step = 0; step < STEPS; step++) {
    int64_t rows = rows_at(v, x, t->slots, t->sides, p);
    if (!(largest_of(p->value, rows) > to)) return 1;
    for (int64_t e = 0; root && e < rows; e++)
      for (int64_t i = 0; i < n; i++) p->rows[e * n + i] /= root[i];
    if (!invert_gram(v, t->at_limit, rows, p)) return 0;
    for (int64_t i = 0; i < n; i++) move[i] = 0.0;
    for (int64_t e = 0; e < rows; e++) {
      double along = dot(p->inverse + e * ROWS, p->value, rows);
      for (int64_t i = 0; i < n; i++) move[i] += p->free[e * n + i] * along;
    }
    for (int64_t i = 0; root && i < n; i++) move[i] /= root[i];
    double length = largest_of(move, n);
    int more = length > QUADRATIC; /* the next residual is the square of this */
    for (int64_t i = 0; i < n; i++) x[i] -= move[i] / fmax(1.0, length);
    if (v->limits && length <= SETTLING) /* far from closure a step may leave the limits and come back */
      for (int64_t i = 0; i < n; i++)
        if (beyond(v, x, i) && !t->at_limit[i]) {
          t->at_limit[i] = v->high[i] - x[i] < x[i] - v->low[i] ? 1 : -1;
          x[i] = limit_of(v, i, t->at_limit[i]);
          more = 1;
        }
    if (!more) return 1;
  }
  return 1;
}

/* The crease folded flat, where facets lie on each other: its side, 0 at a stop. */
static int64_t folded_flat(const Vertex *v, const int64_t *at_limit, int64_t i) {
  return at_limit[i] && fabs(limit_of(v, i, at_limit[i])) == PI ? at_limit[i] : 0;
}

/* How far the four ends of a pair of facets are off the plane of the other one. */
static void heights(const Vertex *v, const Folded *at, int64_t pair, double *h) {
  for (int e = 0; e < 4; e++) {
    const int64_t *row = v->pair + 8 * pair + 2 * e;
    double normal[3];
    cross(at->rays + 3 * row[1], at->rays + 3 * ((row[1] + 1) % v->rays), normal);
    h[e] = dot3(normal, at->rays + 3 * row[0]) / fmax(sqrt(dot3(normal, normal)), NONZERO);
  }
}

/* The gap that undoes the deepest crossing of a state (`Crossings.of`), and its open side; depth: scratch. */
static int64_t crossing(const Vertex *v, const Folded *at, const double *x, const int64_t *at_limit, double *depth,
                        int64_t *side) {
  int64_t gap = OPEN, k;
  double deepest = OUTSIDE, h[4], near[4], normal[3];
  *side = 1;
  if (v->pairs) {
    double deep = 0.0;
    for (k = 0; k < v->pairs; k++) {
      heights(v, at, k, h);
      /* all of one sign, two of them turned round: the ends alternate around a common point */
      double low = fmin(fmin(h[0], -h[1]), fmin(-h[2], h[3])), high = fmax(fmax(h[0], -h[1]), fmax(-h[2], h[3]));
      depth[k] = fmax(fmax(low, -high), 0.0);
      deep = fmax(deep, depth[k]);
    }
    if (deep > deepest) {
      k = first_largest(depth, v->pairs);
      heights(v, at, k, h);
      for (int e = 0; e < 4; e++) near[e] = v->real[4 * k + e] ? -fabs(h[e]) : -INFINITY;
      int64_t e = first_largest(near, 4);
      gap = v->real[4 * k + e] ? v->gap[v->pair[8 * k + 2 * e] * v->rays + v->pair[8 * k + 2 * e + 1]] : NAMELESS;
      *side = h[e] > 0 ? -1 : h[e] < 0; /* the row must change its sign */
      deepest = deep;
    }
  }
  if (v->walls) {
    end_normal(v, at, normal);
    for (k = 0; k < v->walls; k++) {
      const double *ray = at->rays + 3 * v->wall[3 * k + 1];
      depth[k] = v->wall[3 * k + 2] ? -dot3(ray, normal) : -ray[1];
    }
    k = first_largest(depth, v->walls);
    if (depth[k] > deepest) gap = v->wall[3 * k], *side = 1;
  }
  if (v->stacks && gap == OPEN) {
    for (k = 0; k < v->n; k++) {
      int64_t e = v->stack[3 * k];
      int64_t flat = folded_flat(v, at_limit, k);
      depth[k] = e < 0 ? 0.0 : fmax(flat * sin(x[e]), 0.0);
      if (e >= 0 && flat * folded_flat(v, at_limit, e) > 0 && v->stack[3 * e] == k) depth[k] = 1.0;
    }
    k = first_largest(depth, v->n);
    if (depth[k] > CONTACT_TOL) {
      gap = depth[k] >= 1.0 ? NAMELESS : v->gap[v->stack[3 * k + 1] * v->rays + v->stack[3 * k + 2]];
      *side = folded_flat(v, at_limit, k);
    }
  }
  return gap;
}
