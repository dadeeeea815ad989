/* Downhill along closed states with an active set of fold limits and gaps: hold what a start holds until it is
   stationary, then release by multipliers (nonnegative least squares on the null space of closure), in the metric of
   the springs.  Where a step would let facets cross, the feature that passes first is held. */

enum { ARRIVED, NO_LOWER, TOO_LONG, UNRESOLVED, OPEN, LEVEL };

typedef struct {
  const Sheet *s;
  Placed here, there, low;
  Held *held;
  Factors *closure, *rows, *step;
  double *value, *jacobian, *gap, *row, *gradient, *z, *inner, *right, *mu, *lam, *h, *reduced, *vector, *d, *trial, *best;
  double *left, *work, *other_gap, *other_row;
  int64_t *free, *which; /* of nonnegative(); rows of the active set: variables, then n + slots */
  unsigned char *hit, *added;
  int64_t counted;
  double longest, *path; /* of a step [rad]; where each of them leads, if that is asked for */
} Descent;

static double energy(const Sheet *s, const double *x) {
  double total = 0.0;
  if (s->outside) return s->outside(x, 0, 0);
  for (int64_t i = 0; i < s->n; i++) {
    double away = x[i] - s->rest[i];
    total += 0.5 * s->stiffness[i] * away * away - s->load[i] * x[i];
  }
  return s->laws ? total + law_energy(s, x) : total;
}

/* Close x with the rows that are equations now; what is left, and whether all loops end with q0 > 0. */
static double close_on(Descent *t, double *x, int most, int *lifts) {
  const Sheet *s = t->s;
  int64_t n = s->n, m = s->m;
  double before = INFINITY, left = INFINITY;
  *lifts = 1;
  for (int step = 0; step <= most; step++) {
    memset(t->jacobian, 0, m * n * sizeof(double));
    *lifts = equations(s->loops, x, s->place, t->value, t->jacobian) > 0;
    t->counted++;
    left = largest(t->value, m);
    int64_t k = 0, equal = 0;
    for (int64_t e = 0; e < t->held->many; e++) equal += t->held->equal[e];
    /* off closure a gap is one along a walk, and which walk hangs on how facets are numbered: closure comes first */
    int closed = left <= CLOSURE_TOL;
    if (equal && closed) {
      carry(s, x, &t->there);
      if (!gaps_of(s, t->held, &t->there, t->other_gap, t->other_row)) return INFINITY;
      for (int64_t e = 0; e < t->held->many; e++)
        if (t->held->equal[e] && fabs(t->other_gap[e]) > left) left = fabs(t->other_gap[e]);
    }
    if (!isfinite(left)) return INFINITY;
    if (step == most || ((closed || !equal) && (left <= ROUNDED || (left <= CLOSURE_TOL && left > 0.1 * before)))) break;
    before = left;
    double *a = t->step->a;
    for (int64_t r = 0; r < m; r++, k++)
      for (int64_t i = 0; i < n; i++) a[n * k + i] = t->held->fixed[i] ? 0.0 : t->jacobian[n * r + i] / s->measure[i];
    memcpy(t->right, t->value, m * sizeof(double));
    for (int64_t e = 0; e < t->held->many; e++) {
      if (!t->held->equal[e] || !closed) continue;
      for (int64_t i = 0; i < n; i++) a[n * k + i] = t->held->fixed[i] ? 0.0 : t->other_row[n * e + i];
      t->right[k++] = t->other_gap[e];
    }
    factor(t->step, n, k);
    shortest(t->step, t->right, t->work);
    double most = 0.0;
    for (int64_t i = 0; i < n; i++) most = fmax(most, fabs(t->work[i] / s->measure[i]));
    double share = most > LONGEST_STEP ? LONGEST_STEP / most : 1.0;
    for (int64_t i = 0; i < n; i++) x[i] -= share * t->work[i] / s->measure[i];
  }
  return left;
}

/* Close x, with creases that would pass a limit kept there and gaps that would be negative kept shut. */
static int retract(Descent *t, double *x, int most) {
  const Sheet *s = t->s;
  Held *held = t->held;
  for (int times = 0; times < MOST_RETRACTIONS; times++) {
    int lifts, more = 0;
    for (int64_t i = 0; i < s->n; i++)
      if (x[i] < s->low[i] || x[i] > s->high[i]) {
        int beyond = x[i] < s->low[i] - OUTSIDE || x[i] > s->high[i] + OUTSIDE;
        x[i] = x[i] < s->low[i] ? s->low[i] : s->high[i];
        if (beyond && !held->fixed[i]) held->fixed[i] = 1, t->added[i] = 1, more = 1;
      }
    double left = close_on(t, x, most, &lifts);
    if (!(left <= CLOSURE_TOL) || !lifts) return 0;
    for (int64_t i = 0; i < s->n; i++) more |= x[i] < s->low[i] - OUTSIDE || x[i] > s->high[i] + OUTSIDE;
    if (held->many) {
      carry(s, x, &t->there);
      if (!gaps_of(s, held, &t->there, t->other_gap, t->other_row)) return 0;
      for (int64_t e = 0; e < held->many; e++)
        if (!held->equal[e] && t->other_gap[e] < -SHUT) held->equal[e] = 1, more = 1;
    }
    if (!more) {
      for (int64_t i = 0; i < s->n; i++) x[i] = x[i] < s->low[i] ? s->low[i] : x[i] > s->high[i] ? s->high[i] : x[i];
      return 1;
    }
  }
  return 0;
}

/* Take creases beside their limits to be there; whether there are other ones than before. */
static int come_to_limits(const Sheet *s, double *x, int64_t *side) {
  int new = 0;
  for (int64_t i = 0; i < s->n; i++) {
    int at = x[i] >= s->high[i] - OUTSIDE ? 1 : x[i] <= s->low[i] + OUTSIDE ? -1 : 0;
    if (at) x[i] = at > 0 ? s->high[i] : s->low[i];
    new |= at && !side[i];
    side[i] = at;
  }
  return new;
}

/* Whether facets cross at x; `at` is placed there. */
static int crosses(Descent *t, const double *x, Placed *at) {
  const Sheet *s = t->s;
  int any = 0;
  carry(s, x, at);
  if (!s->pairs) return 0;
  carry_pieces(s, at);
  find_crossings(1, s->pieces, s->q, at->x, s->pairs, s->one, s->other, s->deep, s->seen, t->hit);
  for (int64_t k = 0; k < s->pairs; k++) any |= t->hit[k];
  return any;
}

static void look_at(const Sheet *s, const double *x, Pieces *p) {
  int64_t q = s->q;
  p->q = q, p->after = s->after, p->before = s->ring_before, p->valid = s->valid, p->border = s->border;
  for (int64_t k = 0; k < s->pieces; k++) {
    double *normal = s->normal + 3 * k, u[3], v[3], w[3];
    normal[0] = normal[1] = normal[2] = 0.0;
    for (int64_t c = 0; c < q; c++) {
      const double *a = x + 3 * (q * k + c), *b = x + 3 * (q * k + s->after[q * k + c]);
      for (int i = 0; i < 3; i++) s->along[3 * (q * k + c) + i] = b[i] - a[i], u[i] = a[i] - x[3 * q * k + i], v[i] = b[i] - x[3 * q * k + i];
      cross(u, v, w);
      for (int i = 0; i < 3; i++) normal[i] += s->valid[q * k + c] ? w[i] : 0.0;
    }
    double size = sqrt(dot(normal, normal, 3));
    for (int i = 0; i < 3; i++) normal[i] /= size;
    for (int64_t c = 0; c < q; c++) {
      double *in = s->inward + 3 * (q * k + c);
      cross(normal, s->along + 3 * (q * k + c), in);
      size = sqrt(dot(in, in, 3));
      for (int i = 0; i < 3; i++) in[i] /= size > NONZERO ? size : NONZERO;
    }
  }
  p->x = x, p->side = s->along, p->normal = s->normal, p->inward = s->inward;
}

/* The gap of one slot where facets are placed; nan where it has none. */
static double gap_at(Descent *t, int64_t e, const Placed *at) {
  Held only = *t->held;
  double gap;
  only.many = 1, only.owner += 4 * e, only.sides += e, only.sign += e, only.point += 12 * e, only.sense += t->s->placed * e;
  return gaps_of(t->s, &only, at, &gap, t->other_row) ? gap : NAN;
}

/* Features of a pair of pieces: corners of one over the other, of the other over it, sides; how many. */
static int64_t features(const Sheet *s, const Pieces *p, int64_t k, int way, double reach, double least, int64_t *place, double *found) {
  int64_t a = way == 1 ? s->other[k] : s->one[k], b = way == 1 ? s->one[k] : s->other[k], shared = s->common[2 * k + (way == 1)];
  if (shared < -1 || (way == 2 && shared >= 0)) return 0;
  return way == 2 ? sides_of(p, a, b, reach, least, s->size, place, found)
                  : over(p, a, b, shared, reach, least, s->size, place, found);
}

/* Hold the feature that passes first between a state and one a little further, where facets cross; 0 where none does. */
static int hold_what_passes(Descent *t, const double *low, const double *high) {
  const Sheet *s = t->s;
  Held *held = t->held;
  int64_t q = s->q, best[5] = {-1, 0, 0, 0, 0}, was = held->many, place[2 * q * q];
  double first = INFINITY, found[3 * q * q];
  Pieces p;
  crosses(t, low, &t->low);
  crosses(t, high, &t->there); /* leaves which pairs do */
  carry_pieces(s, &t->low);
  for (int end = 0; end < 2; end++) {
    look_at(s, end ? t->there.x : t->low.x, &p);
    for (int64_t k = 0; k < s->pairs; k++)
      for (int way = 0; way < 3 && t->hit[k]; way++) {
        int64_t a = way == 1 ? s->other[k] : s->one[k], b = way == 1 ? s->one[k] : s->other[k];
        int64_t many = features(s, &p, k, way, FACES, 0.0, place, found);
        for (int64_t f = 0; f < many; f++) {
          if (held->many == SLOTS) return 0;
          int64_t e = hold_on(s, held, a, place[2 * f], b, place[2 * f + 1], end ? -found[3 * f] : found[3 * f]);
          if (e < 0 || (e < was && held->equal[e])) continue;
          double here = gap_at(t, e, &t->low), gone = gap_at(t, e, &t->there);
          if (e >= was) held->many = was;
          if (!(gone < 0) || !(here > -TOUCHES)) continue;
          here = fmax(here, 0.0);
          double share = here / (here - gone);
          if (share < first)
            first = share, best[0] = a, best[1] = place[2 * f], best[2] = b, best[3] = place[2 * f + 1], best[4] = (found[3 * f] > 0) != end;
        }
      }
  }
  if (best[0] < 0) return 0;
  int64_t e = hold_on(s, held, best[0], best[1], best[2], best[3], best[4] ? 1.0 : -1.0);
  if (e < 0) return 0;
  held->equal[e] = 1;
  return 1;
}

/* Take what touches at a state, inside each other, among what is held. */
static void hold_what_touches(Descent *t, const double *x) {
  const Sheet *s = t->s;
  int64_t q = s->q, place[2 * q * q];
  double found[3 * q * q];
  Pieces p;
  if (!s->pairs) return;
  carry(s, x, &t->there);
  carry_pieces(s, &t->there);
  look_at(s, t->there.x, &p);
  for (int64_t k = 0; k < s->pairs; k++)
    for (int way = 0; way < 3; way++) {
      /* with what is on a border, which rounding would have inside or outside */
      int64_t many = features(s, &p, k, way, TOUCHES, -TOUCHES, place, found);
      for (int64_t f = 0; f < many; f++)
        hold_on(s, t->held, way == 1 ? s->other[k] : s->one[k], place[2 * f], way == 1 ? s->one[k] : s->other[k], place[2 * f + 1], found[3 * f]);
    }
}

/* Let go of slots whose features no longer face each other, or that are open and not asked for. */
static void drop(Descent *t, const double *x) {
  const Sheet *s = t->s;
  Held *held = t->held;
  Pieces p;
  int64_t q = s->q, place[2 * q * q];
  double found[3 * q * q];
  if (!held->many) return;
  carry(s, x, &t->there);
  carry_pieces(s, &t->there);
  look_at(s, t->there.x, &p);
  if (!gaps_of(s, held, &t->there, t->other_gap, t->other_row)) return;
  for (int64_t e = held->many - 1; e >= 0; e--) {
    const int64_t *w = held->pieces + 4 * e;
    int keep = t->other_gap[e] <= (held->until[e] ? FAR_APART : APART);
    if (keep && w[0] >= 0) {
      int64_t shared = -1;
      for (int64_t k = 0; k < s->pairs; k++) {
        if (s->one[k] == w[0] && s->other[k] == w[2]) shared = s->common[2 * k];
        if (s->one[k] == w[2] && s->other[k] == w[0]) shared = s->common[2 * k + 1];
      }
      int64_t many = w[3] >= 0 ? sides_of(&p, w[0], w[2], INFINITY, -TOUCHES, s->size, place, found)
                               : over(&p, w[0], w[2], shared, INFINITY, -TOUCHES, s->size, place, found);
      keep = 0;
      for (int64_t f = 0; f < many; f++) keep |= place[2 * f] == w[1] && place[2 * f + 1] == w[3];
      keep |= held->until[e] && fabs(t->other_gap[e]) <= SHUT;
    }
    if (!keep) {
      double last = t->other_gap[held->many - 1];
      let_go(s, held, e);
      t->other_gap[e] = last;
    }
  }
}

/* Null space of closure z [d, n], its torque, and all rows of the active set there, inner [r, d]; d. */
static int64_t survey(Descent *t, const double *x, int64_t *rows) {
  const Sheet *s = t->s;
  int64_t n = s->n, m = s->m, r = 0;
  memset(t->jacobian, 0, m * n * sizeof(double));
  equations(s->loops, x, s->place, t->value, t->jacobian);
  t->counted++;
  for (int64_t k = 0; k < m; k++)
    for (int64_t i = 0; i < n; i++) t->closure->a[n * k + i] = t->jacobian[n * k + i] / s->measure[i];
  factor(t->closure, n, m);
  complement(t->closure, t->z);
  int64_t d = n - t->closure->rank;
  for (int64_t i = 0; i < n; i++) t->gradient[i] = s->stiffness[i] * (x[i] - s->rest[i]) - s->load[i];
  if (s->outside)
    s->outside(x, 1, t->gradient);
  else if (s->laws)
    add_laws(s, x, s->measure, t->gradient, s->soft);
  for (int64_t i = 0; i < n; i++) t->gradient[i] /= s->measure[i];
  carry(s, x, &t->here);
  if (!gaps_of(s, t->held, &t->here, t->gap, t->row)) return -1;
  for (int64_t i = 0; i < n; i++)
    if (t->held->side[i]) {
      for (int64_t c = 0; c < d; c++) t->inner[d * r + c] = -t->held->side[i] * t->z[n * c + i];
      t->which[r] = i;
      r += largest(t->inner + d * r, d) > RANK; /* else closure keeps it there */
    }
  for (int64_t e = 0; e < t->held->many; e++) {
    if (fabs(t->gap[e]) > TOUCHES && !t->held->equal[e]) continue;
    for (int64_t c = 0; c < d; c++) t->inner[d * r + c] = dot(t->row + n * e, t->z + n * c, n);
    t->which[r] = n + e;
    r += largest(t->inner + d * r, d) > RANK * largest(t->row + n * e, n);
  }
  *rows = r;
  return d;
}

static unsigned char *equality(Descent *t, int64_t row) {
  int64_t n = t->s->n;
  return row < n ? t->held->fixed + row : t->held->equal + row - n;
}

/* Newton's step on the rows that are equations, [n], and the largest torque that they leave; how many ways it leaves a saddle by. */
static int newton(Descent *t, const double *x, int64_t d, int64_t rows, const double *aside, double *torque, double *slope) {
  const Sheet *s = t->s;
  int64_t n = s->n, saddles = 0;
  for (;;) { /* until the step opens all that holds and is no equation */
    int64_t k = 0, kept[rows + 1], t2;
    for (int64_t r = 0; r < rows; r++)
      if (*equality(t, t->which[r])) {
        memcpy(t->rows->a + d * k, t->inner + d * r, d * sizeof(double));
        kept[k++] = r;
      }
    factor(t->rows, d, k);
    for (int64_t c = 0; c < d; c++) t->right[c] = dot(t->z + n * c, t->gradient, n);
    nearest(t->rows, t->right, t->vector, t->work);
    memset(t->mu, 0, rows * sizeof(double));
    for (int64_t e = 0; e < k; e++) t->mu[kept[e]] = t->vector[e];
    complement(t->rows, t->reduced); /* [t2, d] */
    t2 = d - t->rows->rank;
    double *basis = t->vector; /* [t2, n] */
    for (int64_t a = 0; a < t2; a++)
      for (int64_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (int64_t c = 0; c < d; c++) sum += t->reduced[d * a + c] * t->z[n * c + i];
        basis[n * a + i] = sum;
      }
    double *leftover = t->left; /* gradient less what rows carry */
    memcpy(leftover, t->gradient, n * sizeof(double));
    for (int64_t r = 0; r < rows; r++) {
      int64_t which = t->which[r];
      if (t->mu[r] == 0.0) continue;
      if (which < n)
        leftover[which] += t->mu[r] * t->held->side[which];
      else
        for (int64_t i = 0; i < n; i++) leftover[i] -= t->mu[r] * t->row[n * (which - n) + i];
    }
    nearest(t->closure, leftover, t->lam, t->work);
    memset(t->h, 0, n * n * sizeof(double));
    bend(s->loops, x, s->place, t->lam, t->h);
    for (int64_t i = 0; i < n * n; i++) t->h[i] = -t->h[i];
    for (int64_t i = 0; i < n && !s->outside; i++)
      t->h[n * i + i] += s->laws && s->law[i] >= 0 ? s->soft[i] * s->measure[i] * s->measure[i] : s->stiffness[i];
    if (s->outside) {
      s->outside(x, 2, t->reduced);
      for (int64_t i = 0; i < n * n; i++) t->h[i] += t->reduced[i];
    }
    for (int64_t r = 0; r < rows; r++)
      if (t->which[r] >= n && t->mu[r] != 0.0) bend_gap(s, t->held, t->which[r] - n, &t->here, -t->mu[r], t->h);
    for (int64_t i = 0; i < n; i++)
      for (int64_t j = 0; j < n; j++) t->h[n * i + j] /= s->measure[i] * s->measure[j];
    /* beside states where closure loses rank multipliers grow, and what rounding makes of curvatures with them */
    double noise = BALANCED * (1.0 + largest(t->lam, s->m)), *small = t->reduced, *ways = t->reduced + n * n;
    for (int64_t a = 0; a < t2; a++) {
      for (int64_t i = 0; i < n; i++) t->work[i] = dot(t->h + n * i, basis + n * a, n);
      for (int64_t b = 0; b < t2; b++) small[t2 * a + b] = dot(t->work, basis + n * b, n);
    }
    memset(t->d, 0, n * sizeof(double));
    *torque = 0.0, *slope = 0.0, saddles = 0;
    double *by = t->right;
    for (int64_t a = 0; a < t2; a++) {
      by[a] = -dot(basis + n * a, t->gradient, n);
      *torque = fmax(*torque, fabs(by[a]));
    }
    memcpy(ways, small, t2 * t2 * sizeof(double));
    int convex = solve_positive(t2, ways, by, fmax(noise, SOFTEST));
    if (convex)
      for (int64_t a = 0; a < t2; a++)
        for (int64_t i = 0; i < n; i++) t->d[i] += by[a] * basis[n * a + i];
    else
      spectrum(t2, small, ways), *torque = 0.0;
    for (int64_t a = 0; a < t2 && !convex; a++) {
      double *way = t->work, curve = small[t2 * a + a];
      memset(way, 0, n * sizeof(double));
      for (int64_t b = 0; b < t2; b++)
        for (int64_t i = 0; i < n; i++) way[i] += ways[t2 * a + b] * basis[n * b + i];
      double pull = dot(way, t->gradient, n), by = -pull / fmax(fabs(curve), SOFTEST);
      *torque = fmax(*torque, fabs(pull));
      if (curve < -noise && fabs(pull) < BALANCED)
        by = (dot(way, aside, n) > 0 ? 1.0 : -1.0) * OFF_SADDLE, saddles++;
      for (int64_t i = 0; i < n; i++) t->d[i] += by * way[i];
    }
    *slope = dot(t->d, t->gradient, n);
    double size = sqrt(dot(t->d, t->d, n));
    int more = 0;
    for (int64_t r = 0; r < rows; r++) {
      if (*equality(t, t->which[r])) continue;
      double opens = 0.0, *along = t->work;
      for (int64_t c = 0; c < d; c++) along[c] = dot(t->z + n * c, t->d, n);
      opens = dot(t->inner + d * r, along, d);
      if (opens < -ROUNDED * size) *equality(t, t->which[r]) = 1, more = 1;
    }
    if (!more) break;
  }
  for (int64_t i = 0; i < n; i++) t->d[i] /= s->measure[i];
  return saddles;
}

static int64_t go_down(Descent *t, double *x, int64_t hold, int64_t pauses, int64_t most, const double *aside, double *begun, int64_t *steps, int64_t *saddles) {
  const Sheet *s = t->s;
  Held *held = t->held;
  int64_t n = s->n, rows = 0, last = 0, idle = 0;
  double radius = t->longest;
  for (int64_t i = 0; i < n; i++) held->fixed[i] = held->side[i] != 0;
  memset(held->equal, 1, held->many);
  memset(t->added, 0, n);
  if (!retract(t, x, MOST_CLOSING)) return OPEN;
  if (crosses(t, x, &t->here)) return OPEN;
  for (int64_t i = 0; i < n; i++)
    if (t->added[i]) held->side[i] = x[i] > 0.5 * (s->low[i] + s->high[i]) ? 1 : -1;
  memcpy(begun, x, n * sizeof(double));
  hold_what_touches(t, x);
  for (*steps = 0; *steps < most; ++*steps) {
    double torque, slope, size = 1.0;
    int64_t d = survey(t, x, &rows);
    if (d < 0) return UNRESOLVED;
    for (int64_t i = 0; i < n; i++) held->fixed[i] = 0;
    if (hold)
      for (int64_t r = 0; r < rows; r++) *equality(t, t->which[r]) = 1;
    else {
      memset(held->equal, 0, held->many);
      for (int64_t c = 0; c < d; c++) t->right[c] = dot(t->z + n * c, t->gradient, n);
      if (rows && d && !nonnegative(d, rows, t->inner, t->right, t->mu, t->free, t->work)) {
        /* rows all but depend on each other: those that do not, whatever their sign, until a step opens them */
        memcpy(t->rows->a, t->inner, d * rows * sizeof(double));
        factor(t->rows, d, rows);
        nearest(t->rows, t->right, t->mu, t->work);
      }
      for (int64_t r = 0; r < rows && d; r++) *equality(t, t->which[r]) = t->mu[r] > 0;
    }
    int off = newton(t, x, d, rows, aside, &torque, &slope);
    size += fmax(largest(t->gradient, n), largest(t->lam, s->m));
    if (torque <= STILL * size && !off) {
      if (hold) {
        if (pauses) return LEVEL;
        hold = 0, radius = t->longest;
        continue;
      }
      /* a minimum without stiffness is come to by thirds */
      if (largest(t->d, n) <= EXACT || ++last > MOST_LAST) return ARRIVED;
    } else
      last = 0;
    *saddles += off;
    double far = largest(t->d, n), share = far > radius ? radius / far : 1.0, now = energy(s, x);
    memcpy(t->added + n, held->fixed, n);
    memcpy(t->added + 2 * n, held->equal, held->many);
    int moved = 0;
    for (int half = 0; half < MOST_HALVINGS && !moved; half++, share *= 0.4) {
      memcpy(held->fixed, t->added + n, n), memcpy(held->equal, t->added + 2 * n, held->many);
      memset(t->added, 0, n);
      for (int64_t i = 0; i < n; i++) t->trial[i] = x[i] + (held->fixed[i] ? 0.0 : share * t->d[i]);
      if (!retract(t, t->trial, MOST_CORRECTIONS)) continue;
      double off_way = 0.0, new = energy(s, t->trial);
      for (int64_t i = 0; i < n; i++) off_way = fmax(off_way, fabs(t->trial[i] - x[i]));
      if (off_way > 3 * radius + OUTSIDE) continue;
      /* at rest Newton's steps are taken although energies no longer tell them apart */
      int tiny = !off && (last || share * far <= SETTLED) && new <= now + ROUNDED * (1 + fabs(now));
      if (!(new < now - DECREASE * share * fabs(slope) * (off ? 0.0 : 1.0)) && !tiny) continue;
      if (crosses(t, t->trial, &t->there)) {
        double low = 0.0, high = 1.0;
        memcpy(t->best, x, n * sizeof(double));
        double *above = t->work + 4 * n;
        memcpy(above, t->trial, n * sizeof(double));
        for (int b = 0; b < BISECTIONS; b++) {
          double *between = t->work + 5 * n, middle = 0.5 * (low + high);
          for (int64_t i = 0; i < n; i++) between[i] = 0.5 * (t->best[i] + above[i]);
          memcpy(held->fixed, t->added + n, n), memcpy(held->equal, t->added + 2 * n, held->many);
          if (!retract(t, between, MOST_CORRECTIONS)) break;
          if (crosses(t, between, &t->there))
            high = middle, memcpy(above, between, n * sizeof(double));
          else
            low = middle, memcpy(t->best, between, n * sizeof(double));
        }
        memcpy(held->fixed, t->added + n, n), memcpy(held->equal, t->added + 2 * n, held->many);
        int64_t was = held->many;
        if (!hold_what_passes(t, t->best, above)) return UNRESOLVED;
        memcpy(t->trial, t->best, n * sizeof(double));
        if (retract(t, t->trial, MOST_CORRECTIONS) && !crosses(t, t->trial, &t->there))
          memcpy(t->best, t->trial, n * sizeof(double));
        else if (held->many > was && low == 0.0)
          return UNRESOLVED;
        memcpy(t->trial, t->best, n * sizeof(double));
        last = 0;
      }
      moved = 1;
    }
    if (!moved) return torque <= BALANCED * size && !hold ? ARRIVED : NO_LOWER;
    idle = energy(s, t->trial) < now - ROUNDED * (1 + fabs(now)) ? 0 : idle + 1;
    if (idle > MOST_IDLE) return torque <= BALANCED * size && !hold ? ARRIVED : NO_LOWER;
    radius = fmin(t->longest, fmax(2 * share * far * 2.5, 1e-6));
    memcpy(x, t->trial, n * sizeof(double));
    if (t->path) memcpy(t->path + n * *steps, x, n * sizeof(double));
    int new = come_to_limits(s, x, held->side);
    drop(t, x);
    if (new && pauses && !hold) return LEVEL; /* facets lie on each other: whoever asks says in which order */
  }
  return TOO_LONG;
}

