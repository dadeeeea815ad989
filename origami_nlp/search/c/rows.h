/* Gaps of features as rows: where they are, how far apart, and how that bends (`pattern_problem.contact_pairs`). */

typedef struct {
  double *turn, *shift, *x; /* motions of facets, and corners of pieces [P, q, 3] */
} Placed;

/* What holds: limits by side -1, 0, 1 of each variable, and slots, of which some are equations now. */
typedef struct {
  int64_t many;                     /* slots */
  int64_t *side, *owner, *sides;    /* [n]; facets of the four points [., 4]; whether of two sides */
  int64_t *first, *second;          /* the facet that stays, and the one that is carried */
  int64_t *pieces, *until;          /* pieces and places [., 4]; -1 where it is a point; whether it orders layers */
  double *point, *sign, *sense;     /* in the reference state [., 12]; of the gap; of creases between [., N] */
  unsigned char *equal, *fixed;     /* slots, and variables at a limit, that are equations now */
} Held;

static void carry(const Sheet *s, const double *x, Placed *at) {
  for (int64_t c = 0; c < s->placed; c++) s->angle[c] = s->sense_of[c] * x[s->variable[c]] - s->reference[c];
  memset(at->turn + 9 * s->root, 0, 9 * sizeof(double));
  memset(at->shift + 3 * s->root, 0, 3 * sizeof(double));
  memset(at->shift, 0, 3 * sizeof(double) * s->facets);
  for (int i = 0; i < 3; i++) at->turn[9 * s->root + 4 * i] = 1.0;
  place(s->steps, s->here, s->before, s->crossed, s->axis, s->from, s->angle, at->turn, at->shift);
}

static void carry_pieces(const Sheet *s, Placed *at) {
  for (int64_t p = 0; p < s->pieces; p++)
    for (int64_t c = 0; c < s->q; c++)
      for (int i = 0; i < 3; i++)
        at->x[3 * (s->q * p + c) + i] =
            dot(at->turn + 9 * s->facet[p] + 3 * i, s->corner + 3 * s->ring[s->q * p + c], 3) + at->shift[3 * s->facet[p] + i];
}

/* Add a slot: of corner i of piece a over piece b, or of side i of a and side j of b; its number, or -1. */
static int64_t hold_on(const Sheet *s, Held *h, int64_t a, int64_t i, int64_t b, int64_t j, double sign) {
  int64_t k = h->many, q = s->q, two = j >= 0;
  for (int64_t e = 0; e < k; e++) {
    const int64_t *was = h->pieces + 4 * e;
    if (was[0] == a && was[1] == i && was[2] == b && was[3] == j) return h->sign[e] == sign ? e : -1;
  }
  if (k == SLOTS) return -1;
  int64_t fa = s->facet[a], fb = s->facet[b];
  int64_t of[4], by[4] = {two ? fa : fa, two ? fa : fb, fb, fb};
  of[0] = s->ring[q * a + i];
  if (two)
    of[1] = s->ring[q * a + s->after[q * a + i]], of[2] = s->ring[q * b + j], of[3] = s->ring[q * b + s->after[q * b + j]];
  else
    for (int c = 0; c < 3; c++) of[1 + c] = s->triangle[3 * b + c];
  h->first[k] = two ? fa : fb, h->second[k] = two ? fb : fa;
  for (int c = 0; c < 4; c++) {
    h->owner[4 * k + c] = by[c];
    for (int e = 0; e < 3; e++) h->point[12 * k + 3 * c + e] = s->corner[3 * of[c] + e];
  }
  int64_t *where = h->pieces + 4 * k;
  where[0] = a, where[1] = i, where[2] = b, where[3] = j;
  h->sides[k] = two, h->sign[k] = sign, h->until[k] = 0, h->equal[k] = 0;
  for (int64_t c = 0; c < s->placed; c++)
    h->sense[s->placed * k + c] = s->walk[s->placed * h->second[k] + c] - s->walk[s->placed * h->first[k] + c];
  return h->many++;
}

static void let_go(const Sheet *s, Held *h, int64_t k) {
  int64_t last = --h->many, n = s->placed;
  if (k == last) return;
  memcpy(h->owner + 4 * k, h->owner + 4 * last, 4 * sizeof(int64_t));
  memcpy(h->pieces + 4 * k, h->pieces + 4 * last, 4 * sizeof(int64_t));
  memcpy(h->point + 12 * k, h->point + 12 * last, 12 * sizeof(double));
  memcpy(h->sense + n * k, h->sense + n * last, n * sizeof(double));
  h->sides[k] = h->sides[last], h->first[k] = h->first[last], h->second[k] = h->second[last];
  h->until[k] = h->until[last], h->sign[k] = h->sign[last], h->equal[k] = h->equal[last];
}

/* Gaps over the size, and rows [., n] by variables over their measure, of all slots; 0 where sides run along. */
static int gaps_of(const Sheet *s, const Held *h, const Placed *at, double *gap, double *rows) {
  int64_t n = s->n, which[SLOTS];
  for (int64_t k = 0; k < h->many; k++) which[k] = k;
  if (!h->many) return 1;
  if (!gaps(h->many, which, s->placed, h->point, h->owner, h->sides, h->sign, h->sense, at->turn, at->shift, s->left,
            s->direction, s->end, INSIDE, s->screw, gap, s->rows))
    return 0;
  memset(rows, 0, h->many * n * sizeof(double));
  for (int64_t k = 0; k < h->many; k++) {
    gap[k] /= s->size;
    for (int64_t c = 0; c < s->placed; c++)
      rows[n * k + s->variable[c]] += s->sense_of[c] * s->rows[s->placed * k + c] / s->size;
    for (int64_t i = 0; i < n; i++) rows[n * k + i] /= s->measure[i];
  }
  return 1;
}

/* Add `by` times the second derivatives of the gap of a slot to h [n, n]; axes are those of the last `gaps_of`. */
static void bend_gap(const Sheet *s, const Held *held, int64_t k, const Placed *at, double by, double *h) {
  const int64_t *own = held->owner + 4 * k, a = held->first[k], b = held->second[k];
  const int64_t *up = s->chain + s->chain_first[a], *down = s->chain + s->chain_first[b];
  int64_t longer = s->chain_first[a + 1] - s->chain_first[a], other = s->chain_first[b + 1] - s->chain_first[b];
  int64_t same = 0, many = 0, crease[longer + other + 1];
  while (same < longer && same < other && up[same] == down[same]) same++;
  for (int64_t i = longer - 1; i >= same; i--) crease[many++] = up[i];
  for (int64_t i = same; i < other; i++) crease[many++] = down[i];
  double p[12], c[3 * many + 3], arm[3 * many + 3], one[3 * many + 3], two[3 * many + 3], u[3], v[3], r[3], w[3];
  double t[many + 1], d[many + 1], size, base[3], beside[3], volume = 0.0, across[3 * many + 3], turned[3 * many + 3];
  for (int e = 0; e < 4; e++)
    for (int i = 0; i < 3; i++)
      p[3 * e + i] = dot(at->turn + 9 * own[e] + 3 * i, held->point + 12 * k + 3 * e, 3) + at->shift[3 * own[e] + i];
  const double *moved = held->sides[k] ? p + 6 : p; /* a point that is carried */
  for (int64_t j = 0; j < many; j++) {
    const double *screw = s->screw + 6 * crease[j];
    double sense = held->sense[s->placed * k + crease[j]], x[3];
    cross(screw, moved, x); /* c x (p - o) = c x p - c x o */
    for (int i = 0; i < 3; i++) c[3 * j + i] = sense * screw[i], arm[3 * j + i] = sense * (x[i] - screw[3 + i]);
  }
  if (!held->sides[k]) {
    for (int i = 0; i < 3; i++) u[i] = p[6 + i] - p[3 + i], v[i] = p[9 + i] - p[3 + i];
    cross(u, v, w);
    size = sqrt(dot(w, w, 3));
    for (int i = 0; i < 3; i++) w[i] /= size;
    for (int64_t j = 0; j < many; j++) cross(w, c + 3 * j, one + 3 * j);
  } else {
    for (int i = 0; i < 3; i++) u[i] = p[3 + i] - p[i], v[i] = p[9 + i] - p[6 + i], r[i] = p[6 + i] - p[i];
    cross(u, v, w), cross(r, u, base), cross(w, u, beside);
    size = sqrt(dot(w, w, 3)), volume = dot(r, w, 3);
    for (int64_t j = 0; j < many; j++) {
      cross(c + 3 * j, v, turned + 3 * j), cross(u, turned + 3 * j, across + 3 * j);
      cross(w, c + 3 * j, one + 3 * j), cross(base, c + 3 * j, two + 3 * j);
      t[j] = dot(arm + 3 * j, w, 3) + dot(turned + 3 * j, base, 3), d[j] = dot(turned + 3 * j, beside, 3) / size;
    }
  }
  for (int64_t i = 0; i < many; i++)
    for (int64_t j = i; j < many; j++) { /* i before j in the walk */
      double value = dot(one + 3 * i, arm + 3 * j, 3);
      if (held->sides[k]) {
        double x[3], second;
        value += dot(two + 3 * i, turned + 3 * j, 3) + dot(arm + 3 * i, across + 3 * j, 3) + dot(across + 3 * i, arm + 3 * j, 3);
        cross(beside, c + 3 * i, x);
        second = (dot(x, turned + 3 * j, 3) + dot(across + 3 * i, across + 3 * j, 3) - d[i] * d[j]) / size;
        value = value / size - (t[i] * d[j] + t[j] * d[i] + volume * second) / (size * size) +
                2 * volume * d[i] * d[j] / (size * size * size);
      }
      int64_t y = s->variable[crease[i]], z = s->variable[crease[j]];
      value *= by * held->sign[k] / s->size * s->sense_of[crease[i]] * s->sense_of[crease[j]];
      h[s->n * y + z] += value;
      if (i != j) h[s->n * z + y] += value;
    }
}
