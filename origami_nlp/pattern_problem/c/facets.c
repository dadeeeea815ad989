/* Where facets are (`poses.Poses`), and which convex polygons pass through each other (`crossings.cross_each_other`), for states one after the other. */

static void cross(const double *a, const double *b, double *out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Unit normal, and the box, of a polygon [q, 3]: [9]. */
static void look(const double *x, int64_t q, double *out) {
  double *normal = out, *low = out + 3, *high = out + 6, u[3], v[3], w[3];
  for (int i = 0; i < 3; i++) normal[i] = 0.0, low[i] = high[i] = x[i];
  for (int64_t k = 0; k < q; k++) {
    const double *here = x + 3 * k, *next = x + 3 * ((k + 1) % q);
    for (int i = 0; i < 3; i++) {
      u[i] = here[i] - x[i], v[i] = next[i] - x[i];
      if (here[i] < low[i]) low[i] = here[i];
      if (here[i] > high[i]) high[i] = here[i];
    }
    cross(u, v, w);
    for (int i = 0; i < 3; i++) normal[i] += w[i];
  }
  double size = sqrt(dot(normal, normal));
  for (int i = 0; i < 3; i++) normal[i] /= size;
}

/* How far a polygon reaches through a plane, and from where to where along a line: [3]. */
static void chord(const double *x, int64_t q, const double *normal, const double *origin, const double *line,
                  double *out) {
  double most = -INFINITY, least = INFINITY, d[3], first_h = 0.0, first_t = 0.0, h = 0.0, t = 0.0;
  out[1] = INFINITY, out[2] = -INFINITY;
  for (int64_t k = 0; k <= q; k++) {
    double h2 = first_h, t2 = first_t;
    if (k < q) {
      for (int i = 0; i < 3; i++) d[i] = x[3 * k + i] - origin[i];
      h2 = dot(d, normal), t2 = dot(d, line);
      if (h2 > most) most = h2;
      if (h2 < least) least = h2;
    }
    if (!k)
      first_h = h2, first_t = t2;
    else if ((h > 0 && h2 <= 0) || (h <= 0 && h2 > 0)) { /* half open, see `_chord` */
      double at = t + h / (h - h2) * (t2 - t);
      if (at < out[1]) out[1] = at;
      if (at > out[2]) out[2] = at;
    }
    h = h2, t = t2;
  }
  out[0] = most < -least ? most : -least;
}

/* Which pairs of polygons x [S, P, q, 3] pass through each other by more than `deep`: hit [S, K]. */
void find_crossings(int64_t states, int64_t polygons, int64_t q, const double *x, int64_t pairs, const int64_t *first,
                    const int64_t *second, double deep, double *seen, unsigned char *hit) {
  for (int64_t s = 0; s < states; s++, x += 3 * q * polygons, hit += pairs) {
    for (int64_t p = 0; p < polygons; p++) look(x + 3 * q * p, q, seen + 9 * p);
    for (int64_t k = 0; k < pairs; k++) {
      const double *one = seen + 9 * first[k], *other = seen + 9 * second[k];
      const double *a = x + 3 * q * first[k], *b = x + 3 * q * second[k];
      double line[3], of_a[3], of_b[3], d[3];
      hit[k] = 0;
      for (int i = 3; i < 6; i++)
        if (!(one[i] <= other[i + 3] && other[i] <= one[i + 3])) goto apart;
      cross(one, other, line);
      double size = sqrt(dot(line, line));
      for (int i = 0; i < 3; i++) line[i] /= size > NONZERO ? size : NONZERO, d[i] = a[i] - b[i];
      chord(a, q, other, b, line, of_a);
      if (!(of_a[0] > deep)) continue;
      chord(b, q, one, a, line, of_b);
      if (!(of_b[0] > deep)) continue;
      double shift = dot(d, line), low = of_b[1] + shift, high = of_b[2] + shift;
      if (of_a[1] > low) low = of_a[1];
      if (of_a[2] < high) high = of_a[2];
      hit[k] = high - low > deep;
    apart:;
    }
  }
}

/* Motions of facets, each from the one before it across a crease: turn [F, 9] and shift [F, 3], of the root given. */
void place(int64_t steps, const int64_t *here, const int64_t *before, const int64_t *crease, const double *axis,
           const double *point, const double *angle, double *turn, double *shift) {
  for (int64_t k = 0; k < steps; k++, axis += 3, point += 3) {
    const double *q = turn + 9 * before[k];
    double *to = turn + 9 * here[k], r[9], inner[3], a = angle[crease[k]], half = sin(a / 2), s = sin(a);
    double c = 2 * half * half, x = axis[0], y = axis[1], z = axis[2];
    /* 1 + sin a K + (1 - cos a) K^2 (Rodrigues) */
    double k1[9] = {0, -z, y, z, 0, -x, -y, x, 0};
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double square = k1[3 * i] * k1[j] + k1[3 * i + 1] * k1[3 + j] + k1[3 * i + 2] * k1[6 + j];
        r[3 * i + j] = (i == j) + s * k1[3 * i + j] + c * square;
      }
    for (int i = 0; i < 3; i++) inner[i] = point[i] - dot(r + 3 * i, point);
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++)
        to[3 * i + j] = q[3 * i] * r[j] + q[3 * i + 1] * r[3 + j] + q[3 * i + 2] * r[6 + j];
      shift[3 * here[k] + i] = dot(q + 3 * i, inner) + shift[3 * before[k] + i];
    }
  }
}

/* Gaps of some pairs of features and their derivatives by every fold angle (`contact_pairs.gaps_and_rows`): gap [K],
   rows [K, n].

   Of each pair that is known its four points in the reference state and the facets that carry them, whether it is two sides, its sign, and
   how the walk from one facet to the other crosses creases; of creases, the facet that holds them, direction and a
   point.  0 where two sides run along each other. */
int64_t gaps(int64_t many, const int64_t *which, int64_t n, const double *point, const int64_t *owner, const int64_t *sides,
             const double *sign, const double *senses, const double *turn, const double *shift, const int64_t *left,
             const double *direction, const double *end, double inside, double *axis, double *gap, double *rows) {
  for (int64_t c = 0; c < n; c++) { /* axis and moment, [n, 6] */
    const double *r = turn + 9 * left[c], *t = shift + 3 * left[c];
    double o[3], *a = axis + 6 * c;
    for (int i = 0; i < 3; i++) a[i] = dot(r + 3 * i, direction + 3 * c), o[i] = dot(r + 3 * i, end + 3 * c) + t[i];
    cross(a, o, a + 3);
  }
  for (int64_t m = 0; m < many; m++, rows += n) {
    const int64_t k = which[m], *own = owner + 4 * k;
    const double *sense = senses + n * k;
    double p[12], u[3], v[3], w[3], r[3], x[3], y[3], turned[3];
    for (int q = 0; q < 4; q++)
      for (int i = 0; i < 3; i++)
        p[3 * q + i] = dot(turn + 9 * own[q] + 3 * i, point + 12 * k + 3 * q) + shift[3 * own[q] + i];
    for (int i = 0; i < 3; i++) u[i] = p[3 + i] - p[i], v[i] = p[9 + i] - p[6 + i];
    if (sides[k])
      cross(u, v, w);
    else {
      for (int i = 0; i < 3; i++) x[i] = p[6 + i] - p[3 + i], y[i] = p[9 + i] - p[3 + i];
      cross(x, y, w);
    }
    double size = sqrt(dot(w, w));
    if (sides[k] && !(size > inside * sqrt(dot(u, u)) * sqrt(dot(v, v)))) return 0;
    for (int i = 0; i < 3; i++) w[i] /= size, r[i] = sides[k] ? p[6 + i] - p[i] : -u[i];
    double g = dot(r, w);
    cross(sides[k] ? p + 6 : p, w, turned);
    if (sides[k]) {
      double a[3], b[3];
      cross(r, u, a), cross(w, u, b);
      for (int i = 0; i < 3; i++) x[i] = a[i] - g * b[i];
      cross(v, x, y);
      for (int i = 0; i < 3; i++) turned[i] += y[i] / size;
    }
    gap[m] = sign[k] * g;
    for (int64_t c = 0; c < n; c++)
      rows[c] = sense[c] == 0.0 ? 0.0 : sign[k] * sense[c] * (dot(turned, axis + 6 * c) - dot(w, axis + 6 * c + 3));
  }
  return 1;
}

/* Convex pieces x [P, q, 3] at a state: what is next to what, and sides, normals of planes, and of sides inward. */
typedef struct {
  int64_t q;
  const int64_t *after, *before, *valid, *border;
  const double *x, *side, *normal, *inward;
} Pieces;

static double along(const double *a, const double *b, const double *way) { /* (a - b) . way */
  return (a[0] - b[0]) * way[0] + (a[1] - b[1]) * way[1] + (a[2] - b[2]) * way[2];
}

/* The sign that makes a gap positive where facets are apart; 0 where it is not known (`features._side`). */
static double side_of(double gap, double lean) {
  int body = fabs(gap) < INSIDE && fabs(lean) > 10 * INSIDE;
  double by = body ? lean : gap;
  if (!body && !(fabs(gap) > OUTSIDE)) return 0.0;
  return (by > 0) - (by < 0);
}

/* Corners of piece a over piece b, inside by more than `least`, which have `common` places of a corner in common, or -1
   (`Features._corners`). */
static int64_t over(const Pieces *p, int64_t a, int64_t b, int64_t common, double reach, double least, double size,
                    int64_t *place, double *found) {
  int64_t q = p->q, many = 0, at_a = common / q, at_b = common % q;
  const double *of = p->x + 3 * q * a, *on = p->x + 3 * q * b;
  double height[q], far[q];
  for (int64_t i = 0; i < q; i++) {
    double d[3] = {of[3 * i] - of[3 * at_a], of[3 * i + 1] - of[3 * at_a + 1], of[3 * i + 2] - of[3 * at_a + 2]};
    height[i] = along(of + 3 * i, on, p->normal + 3 * b);
    far[i] = common < 0 ? size : sqrt(dot(d, d));
    if (!(far[i] > 0)) far[i] = 1.0;
  }
  for (int64_t i = 0; i < q; i++) {
    double lean, inside = INFINITY;
    if (!p->valid[q * a + i] || !(fabs(height[i]) < reach * size)) continue;
    if (common < 0)
      lean = (height[p->before[q * a + i]] + height[p->after[q * a + i]] - 2 * height[i]) / size;
    else {
      int64_t first = p->after[q * a + at_a], last = p->before[q * a + at_a], other = i == first ? last : first;
      if (!(i == first && p->border[q * a + at_a]) && !(i == last && p->border[q * a + i])) continue;
      lean = 2 * (height[other] / far[other] - height[i] / far[i]);
    }
    for (int64_t e = 0; e < q; e++) {
      if (!p->valid[q * b + e] || (common >= 0 && e != at_b && e != p->before[q * b + at_b])) continue;
      double depth = along(of + 3 * i, on + 3 * e, p->inward + 3 * (q * b + e)) / far[i];
      if (!p->border[q * b + e]) depth += 2 * INSIDE; /* a cut inside a facet is no border */
      if (!(depth >= inside)) inside = depth;
    }
    double sign = side_of(height[i] / size, lean);
    if (sign == 0.0 || !(inside > least)) continue;
    place[2 * many] = i, place[2 * many + 1] = -1;
    found[3 * many] = sign, found[3 * many + 1] = sign * height[i] / size, found[3 * many++ + 2] = inside;
  }
  return many;
}

/* Sides of pieces a and b that share no corner, inside each other by more than `least` (`Features._sides`). */
static int64_t sides_of(const Pieces *p, int64_t a, int64_t b, double reach, double least, double size, int64_t *place,
                        double *found) {
  int64_t q = p->q, many = 0;
  const double *of = p->x + 3 * q * a, *on = p->x + 3 * q * b;
  double heart[3] = {0.0, 0.0, 0.0}; /* from the middle of one to that of the other */
  for (int64_t i = 0; i < q; i++)
    for (int k = 0; k < 3; k++) heart[k] += (on[3 * i + k] - of[3 * i + k]) / q;
  for (int64_t i = 0; i < q; i++)
    for (int64_t j = 0; j < q && p->border[q * a + i]; j++) {
      const double *u = p->side + 3 * (q * a + i), *v = p->side + 3 * (q * b + j);
      double w[3], r[3], y[3];
      if (!p->border[q * b + j]) continue;
      cross(u, v, w);
      double square = dot(w, w);
      if (!(square > INSIDE * dot(u, u) * dot(v, v))) continue;
      for (int k = 0; k < 3; k++) r[k] = on[3 * j + k] - of[3 * i + k];
      cross(r, v, y);
      double s = dot(y, w) / square;
      cross(r, u, y);
      double t = dot(y, w) / square, inside = fmin(fmin(s, 1 - s), fmin(t, 1 - t));
      double gap = dot(r, w) / sqrt(square) / size;
      if (!(inside > least) || !(fabs(gap) < reach)) continue;
      for (int k = 0; k < 3; k++) y[k] = heart[k] - r[k];
      double sign = side_of(gap, dot(y, w) / sqrt(square) / size);
      if (sign == 0.0) continue;
      place[2 * many] = i, place[2 * many + 1] = j;
      found[3 * many] = sign, found[3 * many + 1] = sign * gap, found[3 * many++ + 2] = inside;
    }
  return many;
}

/* Features of pairs of pieces that face each other: of corners over pieces (what = 0) or sides (1) their places [., 2],
   and sign, gap and how far they are inside, [., 3]; how many each pair has, [K]. */
void face(const Pieces *p, int64_t what, int64_t pairs, const int64_t *pair, const int64_t *common, double reach,
          double size, int64_t *many, int64_t *place, double *found) {
  for (int64_t k = 0; k < pairs; k++) {
    int64_t a = pair[2 * k], b = pair[2 * k + 1];
    many[k] = what ? sides_of(p, a, b, reach, 0.0, size, place, found)
                   : over(p, a, b, common[k], reach, 0.0, size, place, found);
    place += 2 * many[k], found += 3 * many[k];
  }
}
