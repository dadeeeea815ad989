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
