/* One descent after the other: the steps of `minima.descents`, where stands what a step does and why.

   `minima.compiled_descents` writes the types `Vertex` and `Samples` and all tolerances before these files, from what it
   passes.  Nothing global, no allocation inside a step: threads may share a `Vertex`. */

static void copy_ints(const int64_t *a, int64_t n, int64_t *to) { memcpy(to, a, n * sizeof(int64_t)); }

static void copy(const double *a, int64_t n, double *to) { memcpy(to, a, n * sizeof(double)); }

static double energy(const Vertex *v, const double *x) {
  double springs = 0.0, work = 0.0;
  for (int64_t i = 0; i < v->n; i++) {
    double turn = x[i] - v->rest[i];
    springs += v->stiffness[i] * (turn * turn);
    work += x[i] * v->load[i];
  }
  return 0.5 * springs - work + (v->laws ? law_energy(v, x) : 0.0);
}

/* Let go the contact that pulls most, where it pulls enough, and write the gradient of its opening. */
static int release(const Vertex *v, const Samples *s, int64_t k, double size, double slope, Point *p, Scratch *w) {
  int64_t n = v->n, *at_limit = s->at_limit + k * n, *slots = s->slots + k * SLOTS;
  for (int64_t i = 0; i < n; i++) w->opens[i] = 0.0, w->pull[i] = at_limit[i] * p->left[i] / size;
  for (int64_t e = 0; e < SLOTS; e++) w->pull[n + e] = -p->multipliers[v->m + e] / size;
  int64_t worst = first_largest(w->pull, n + SLOTS);
  double early = slope <= FLAT_SLOPE ? 0.0 : s->hold[k] ? INFINITY : EARLY * slope;
  if (!(w->pull[worst] > fmax(FLAT_SLOPE, early))) return 0;
  if (s->hold[k]) {
    s->settled[k] = 1, s->hold[k] = 0;
    copy(s->x + k * n, n, s->kept_x + k * n);
    copy_ints(at_limit, n, s->kept_at_limit + k * n);
    copy_ints(slots, SLOTS, s->kept_slots + k * SLOTS);
    copy_ints(s->sides + k * SLOTS, SLOTS, s->kept_sides + k * SLOTS);
  }
  if (worst >= n) {
    double *row = p->rows + (v->m + worst - n) * n;
    for (int64_t i = 0; i < n; i++) w->opens[i] = row[i], row[i] = 0.0;
    slots[worst - n] = OPEN;
    return 1;
  }
  double least = fmax(EARLY * w->pull[worst], early);
  for (int64_t i = 0; i < n; i++)
    if (i == worst || (v->many && w->pull[i] > least)) w->opens[i] = -at_limit[i], at_limit[i] = 0;
  return 1;
}

/* The Hessian along the stratum, the identity across it. */
static void project_hessian(const Vertex *v, const Samples *s, int64_t k, int64_t rows, const Point *p, Scratch *w) {
  int64_t n = v->n, *at_limit = s->at_limit + k * n, *slots = s->slots + k * SLOTS;
  const double *root = v->root;
  double *h = w->h, *projector = w->projector, *product = w->product;
  memset(h, 0, n * n * sizeof(double));
  add_closure_hessian(v, &p->at, p->multipliers, h);
  for (int64_t e = 0; e < rows - v->m; e++) {
    double force = s->sides[k * SLOTS + e] * p->multipliers[v->m + e];
    if (slots[e] != OPEN && force != 0.0) add_gap_hessian(v, &p->at, slots[e], force, h);
  }
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++) h[i * n + j] = (i == j ? w->soft[i] : 0.0) - h[i * n + j] / (root[i] * root[j]);
  /* projector on the null space of the rows on free creases, 1 - A'(A A')^-1 A (Nocedal and Wright, section 16.3) */
  for (int64_t e = 0; e < rows; e++)
    for (int64_t i = 0; i < n; i++) {
      product[e * n + i] = 0.0;
      for (int64_t f = 0; f < rows; f++) product[e * n + i] += p->inverse[e * ROWS + f] * p->free[f * n + i];
    }
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++) {
      double total = i == j && !at_limit[i];
      for (int64_t e = 0; e < rows; e++) total -= p->free[e * n + i] * product[e * n + j];
      projector[i * n + j] = total;
    }
  multiply(projector, h, n, product);
  multiply(product, projector, n, h);
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j <= i; j++) {
      double total = h[i * n + j] + h[j * n + i] - projector[i * n + j] - projector[j * n + i];
      h[i * n + j] = h[j * n + i] = 0.5 * total + (i == j);
    }
}

/* Where a crease that moves by dx meets its fold limit, as a share of the step. */
static double to_limit(const Vertex *v, const double *x, const double *dx, const int64_t *held, int64_t i) {
  if (held[i] || fabs(dx[i]) <= ROUNDED) return INFINITY;
  return fmax(dx[i] > 0 ? v->high[i] - x[i] : x[i] - v->low[i], 0.0) / fmax(fabs(dx[i]), NONZERO);
}

/* Step by a share of dx into the trial state, to the first fold limit at most, which is held then; return how far. */
static double move(const Vertex *v, const Samples *s, int64_t k, const double *dx, double share, Trial *t) {
  int64_t n = v->n, *held = s->at_limit + k * n, bounded = v->limits && !v->many;
  const double *x = s->x + k * n;
  double nearest = INFINITY;
  for (int64_t i = 0; bounded && i < n; i++) nearest = fmin(nearest, to_limit(v, x, dx, held, i));
  int hit = nearest <= share * NEXT;
  share = fmin(share, nearest);
  copy_ints(held, n, t->at_limit);
  copy_ints(s->slots + k * SLOTS, SLOTS, t->slots);
  copy_ints(s->sides + k * SLOTS, SLOTS, t->sides);
  for (int64_t i = 0; i < n; i++) {
    t->x[i] = x[i] + share * dx[i];
    if (hit && to_limit(v, x, dx, held, i) <= nearest * NEXT) {
      t->at_limit[i] = dx[i] > 0 ? 1 : -1;
      t->x[i] = limit_of(v, i, t->at_limit[i]);
      hit = 0;
    }
  }
  return share;
}

/* Whether the trial state is taken; and which gap it crosses, with its open side. */
static int try_state(const Vertex *v, const Samples *s, int64_t k, double slope, int escaped, Point *q, Scratch *w,
                     int64_t *gap, int64_t *side) {
  const Trial *t = &w->trial;
  const double *x = s->x + k * v->n;
  int64_t rows = rows_at(v, t->x, t->slots, t->sides, q);
  int good = largest_of(q->value, rows) <= EXPLORED;
  good = good && (!v->plane || q->at.end[0] > 0);
  for (int64_t i = 0; i < v->n; i++) good = good && !beyond(v, t->x, i) && fabs(t->x[i] - x[i]) < 2 * REACH;
  double now = energy(v, t->x), e = energy(v, x);
  /* sufficient decrease (Nocedal and Wright, eq. 3.4), with slack for the rounding of energies */
  int lower = now <= e + DECREASE * fmin(slope, 0.0) + EXPLORED * (1 + fabs(e));
  good = good && (lower || (escaped && now <= e + SAME_ENERGY));
  *gap = crossing(v, &q->at, t->x, t->at_limit, w->depth, side);
  return good && *gap == OPEN;
}

/* Where a step crosses something, stop where its gap would close to first order, and hold it there; -1: breaks down. */
static int meet(const Vertex *v, const Samples *s, int64_t k, int64_t gap, int64_t side, int escaped, Point *q,
                Scratch *w) {
  Trial *t = &w->trial;
  int64_t n = v->n, room = -1, other, way;
  const double *metric = v->metric;
  double is_now = side * gap_at(v, &q->at, gap, w->opens); /* still folded at the trial state */
  fold(v, s->x + k * n, &q->at);
  double was = side * gap_at(v, &q->at, gap, w->opens), share = 0.5;
  /* a gap that was closed already is left: its crossing is another one, met half way */
  if (was > CONTACT_TOL && is_now < 0) share = fmin(fmax(was / fmax(was - is_now, NONZERO), 0.1), 0.95);
  move(v, s, k, w->dx, share, t);
  for (int64_t e = SLOTS - 1; e >= 0; e--)
    if (t->slots[e] == OPEN) room = e;
  for (int64_t e = 0; e < SLOTS; e++)
    if (t->slots[e] == gap) room = -1;
  if (room >= 0) {
    double far = 0.0;
    t->slots[room] = gap, t->sides[room] = side;
    copy(t->x, n, w->opens);
    if (!close_state(v, t, CLOSED, metric, q)) return -1;
    int good = try_state(v, s, k, 0.0, escaped, q, w, &other, &way);
    for (int64_t i = 0; i < n; i++) far = fmax(far, fabs(t->x[i] - w->opens[i]));
    if (good && far < NEAR) return 1;
    move(v, s, k, w->dx, share, t);
  }
  if (!close_state(v, t, CLOSED, metric, q)) return -1;
  return try_state(v, s, k, 0.0, escaped, q, w, &other, &way);
}

/* Try a step; return whether it was taken; -1 where linear algebra breaks down. */
static int advance(const Vertex *v, const Samples *s, int64_t k, int escaped, Point *q, Scratch *w) {
  int64_t n = v->n, gap, side;
  double reach = s->reach[k];
  for (int64_t i = 0; i < n; i++) w->dx[i] = w->d[i] / v->root[i];
  double longest = largest_of(w->dx, n);
  double share = move(v, s, k, w->dx, fmin(1.0, reach / fmax(longest, NONZERO)), &w->trial);
  if (!close_state(v, &w->trial, CLOSED, v->metric, q)) return -1;
  int good = try_state(v, s, k, dot(w->down, w->d, n) * share, escaped, q, w, &gap, &side);
  if (gap >= 0) {
    for (int64_t i = 0; i < n; i++) w->dx[i] *= share;
    good = meet(v, s, k, gap, side, escaped, q, w);
    if (good < 0) return -1;
  }
  double step = fmin(longest, reach);
  s->reach[k] = good ? fmin(REACH, GROWTH * fmax(reach, step)) : CUT * step;
  return good;
}

/* The sample goes on from the trial state. */
static void accept(const Vertex *v, const Samples *s, int64_t k, const Trial *t) {
  copy(t->x, v->n, s->x + k * v->n);
  copy_ints(t->at_limit, v->n, s->at_limit + k * v->n);
  copy_ints(t->slots, SLOTS, s->slots + k * SLOTS);
  copy_ints(t->sides, SLOTS, s->sides + k * SLOTS);
}

/* Leave a stationary state downhill where it is a saddle; return whether it is; -1: linear algebra breaks down. */
static int leave_saddle(const Vertex *v, const Samples *s, int64_t k, int64_t rows, const Point *p, Scratch *w) {
  int64_t n = v->n;
  const double *root = v->root;
  double longest = 0.0;
  if (!v->chain && !all_finite(w->h, n, n)) return -1;
  if (!((v->chain ? bent(n, w, p, rows) : lowest(n, w)) < SADDLE) || s->escapes[k] >= ESCAPES) return 0;
  s->escapes[k]++;
  for (int64_t i = 0; i < n; i++) {
    w->dx[i] = fabs(w->bent[i]);
    longest = fmax(longest, w->dx[i] / root[i]);
  }
  /* either side is as good, and what torque is left is rounding: the largest entry goes up */
  double up = w->bent[first_largest(w->dx, n)], scale = ((up > 0) - (up < 0)) * ESCAPE / longest;
  for (int64_t i = 0; i < n; i++) w->d[i] = w->bent[i] * scale;
  return 1;
}

/* One step of a descent; 0 where linear algebra breaks down. */
static int make_step(const Vertex *v, const Samples *s, int64_t k, Point *p, Point *q, Scratch *w) {
  int64_t n = v->n, *at_limit = s->at_limit + k * n;
  const double *x = s->x + k * n, *root = v->root;
  double *d = w->d, moved = 0.0, tiny = 0.0;
  int64_t rows = rows_at(v, x, s->slots + k * SLOTS, s->sides + k * SLOTS, p);
  for (int64_t i = 0; i < n; i++) {
    p->torque[i] = v->stiffness[i] * (x[i] - v->rest[i]) - v->load[i];
    for (int64_t e = 0; e < rows; e++) p->rows[e * n + i] /= root[i];
  }
  add_laws(v, x, root, p->torque, w->soft);
  for (int64_t i = 0; i < n; i++) p->torque[i] /= root[i];
  if (!balance(v, at_limit, rows, p)) return 0;
  for (int64_t i = 0; i < n; i++) w->down[i] = at_limit[i] ? 0.0 : p->left[i];
  double left = largest_of(w->down, n), top = largest_of(p->torque, n);
  s->converged[k] = 0;
  /* what is left of the torque is its projection, no longer than itself; where it is, closure is singular there */
  if (!(left <= 2 * sqrt(n) * top)) return s->reach[k] = 0.0, 1;
  double size = 1 + top + largest_of(p->multipliers, ROWS), slope = left / size;
  int released = release(v, s, k, size, slope, p, w);
  if (released && !balance(v, at_limit, rows, p)) return 0;
  for (int64_t i = 0; i < n; i++) /* what rounding leaves of a balance has no direction */
    w->down[i] = !at_limit[i] && fabs(p->left[i]) > NO_SLOPE * size ? p->left[i] : 0.0;
  if (v->chain) {
    for (int64_t i = 0; i < n; i++) w->soft[i] = at_limit[i] ? 1.0 : w->soft[i];
    for (int64_t i = 0; i < 3 * n; i++) w->axes[i] = at_limit[i / 3] ? 0.0 : p->at.axes[i] / root[i / 3];
    sweep(n, w, p->multipliers);
  } else {
    project_hessian(v, s, k, rows, p, w);
    if (!direction(n, w)) return 0;
  }
  /* a contact that is let go must open: the steepest way down does that */
  double length = sqrt(dot(w->opens, w->opens, n)) * sqrt(dot(d, d, n));
  if (released && dot(w->opens, d, n) <= CHOSEN * length)
    for (int64_t i = 0; i < n; i++) d[i] = -w->down[i];
  int escaped = 0;
  if (slope <= FLAT_SLOPE && !released) {
    escaped = leave_saddle(v, s, k, rows, p, w);
    if (escaped < 0) return 0;
    if (!escaped) return s->converged[k] = 1;
  }
  coarse(d, n);
  int good = advance(v, s, k, escaped, q, w);
  if (good < 0) return 0;
  for (int64_t i = 0; i < n; i++) {
    tiny = fmax(tiny, fabs(d[i] / root[i]));
    if (good) moved = fmax(moved, fabs(w->trial.x[i] - x[i]));
  }
  if (good) accept(v, s, k, &w->trial);
  s->idle[k] = moved > TINY ? 0 : s->idle[k] + 1;
  s->converged[k] = !good && tiny < TINY && !released;
  return 1;
}

/* Close the state of a sample, or the one that it kept, as trial state. */
static int close_on(const Vertex *v, const Samples *s, int64_t k, int kept, Trial *t, Point *q) {
  int64_t n = v->n;
  copy((kept ? s->kept_x : s->x) + k * n, n, t->x);
  copy_ints((kept ? s->kept_at_limit : s->at_limit) + k * n, n, t->at_limit);
  copy_ints((kept ? s->kept_slots : s->slots) + k * SLOTS, SLOTS, t->slots);
  copy_ints((kept ? s->kept_sides : s->sides) + k * SLOTS, SLOTS, t->sides);
  return close_state(v, t, ROUNDED, NULL, q);
}

static void descend_one(const Vertex *v, const Samples *s, int64_t k, Point *p, Point *q, Scratch *w) {
  int64_t n = v->n;
  Trial *t = &w->trial;
  for (int64_t step = 0; step < v->steps; step++) {
    s->broken[k] = !make_step(v, s, k, p, q, w);
    if (s->broken[k]) return;
    if (s->converged[k] || s->reach[k] < SHORTEST || s->idle[k] >= STALLED) break;
  }
  /* what its contacts did not let go of is an end of its own: of a set that exists only while they are closed */
  int back = s->settled[k] && !s->converged[k];
  s->hold[k] |= back;
  s->broken[k] = !close_on(v, s, k, back, t, q);
  accept(v, s, k, t);
}

/* Descend from samples `first` to `last` (not that one), in place.  Returns 0 where there is no memory. */
int64_t descend(const Vertex *v, const Samples *s, int64_t first, int64_t last) {
  int64_t n = v->n, most = v->pairs > v->walls ? v->pairs : v->walls, wide = n > ROWS ? n : ROWS;
  if (most < n) most = n;
  int64_t point = 3 * (v->rays + 4) + 3 * v->creases + 2 * ROWS * n + 2 * n;
  int64_t whole = 2 * point + 7 * n + SLOTS + most + 3 * n * n + wide * n + 12 * n;
  double *memory = malloc(whole * sizeof(double)), *m = memory;
  int64_t *ints = malloc(n * sizeof(int64_t));
  Point at[2];
  Scratch w;
  if (memory && ints) {
    for (int i = 0; i < 2; i++) {
      at[i].at.rays = m, m += 3 * (v->rays + 4);
      at[i].at.axes = m, m += 3 * v->creases;
      at[i].rows = m, m += ROWS * n;
      at[i].free = m, m += ROWS * n;
      at[i].torque = m, m += n;
      at[i].left = m, m += n;
    }
    w.trial.x = m, m += n;
    w.d = m, m += n;
    w.dx = m, m += n;
    w.down = m, m += n;
    w.opens = m, m += n;
    w.bent = m, m += n;
    w.soft = m, m += n;
    w.pull = m, m += n + SLOTS;
    w.depth = m, m += most;
    w.h = m, m += n * n;
    w.projector = m, m += n * n;
    w.vectors = m, m += n * n;
    w.product = m, m += wide * n;
    w.axes = m, m += 3 * n;
    w.row = m, m += 7 * n;
    w.pivot = m;
    w.trial.at_limit = ints;
    for (int64_t k = first; k < last; k++) descend_one(v, s, k, &at[0], &at[1], &w);
  }
  free(memory);
  free(ints);
  return memory && ints;
}
