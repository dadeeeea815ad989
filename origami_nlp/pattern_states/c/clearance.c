/* Which pairs of facets might touch inside steps of a curve (`Clearance.touching`). */

static void cross(const double *a, const double *b, double *out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void less(const double *a, const double *b, double *out) {
  for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static void add(const double *a, double t, const double *b, double *out) { /* a + t b */
  for (int i = 0; i < 3; i++) out[i] = a[i] + t * b[i];
}

static void unit(double *a) {
  double size = sqrt(dot(a, a));
  for (int i = 0; i < 3; i++) a[i] /= size > NONZERO ? size : NONZERO;
}

static void area_vector(const double *x, int64_t q, double *out) {
  double u[3], v[3], w[3];
  out[0] = out[1] = out[2] = 0.0;
  for (int64_t k = 0; k < q; k++) {
    less(x + 3 * k, x, u), less(x + 3 * ((k + 1) % q), x, v);
    cross(u, v, w);
    add(out, 1.0, w, out);
  }
}

static void shadow(const double *n, const double *x, int64_t q, double *low, double *high) {
  *low = INFINITY, *high = -INFINITY;
  for (int64_t k = 0; k < q; k++) {
    double h = dot(n, x + 3 * k);
    if (h < *low) *low = h;
    if (h > *high) *high = h;
  }
}

/* Largest gap of shadows along axes [A, 3] (overwritten) that is there all along the chords, as `_apart`. */
static double apart(const double *a, const double *b, int64_t q, double *axes, int64_t many, double *at_ends) {
  double largest = 0.0, gap = -INFINITY, ends[2] = {-INFINITY, -INFINITY};
  for (int64_t k = 0; k < many; k++) {
    double size = sqrt(dot(axes + 3 * k, axes + 3 * k));
    if (size > largest) largest = size;
  }
  for (int64_t k = 0; k < many; k++) {
    double *n = axes + 3 * k, size = sqrt(dot(n, n)), ahead[2] = {-1.0, -1.0}, behind[2] = {-1.0, -1.0};
    if (!(size < CURVED * largest)) {
      double low, high, l, h;
      unit(n);
      shadow(n, a, q, &low, &high);
      for (int e = 0; e < 2; e++) shadow(n, b + 3 * q * e, q, &l, &h), ahead[e] = l - high, behind[e] = low - h;
    }
    double one = ahead[0] < ahead[1] ? ahead[0] : ahead[1], other = behind[0] < behind[1] ? behind[0] : behind[1];
    if (one > gap) gap = one;
    if (other > gap) gap = other;
    for (int e = 0; e < 2; e++) {
      if (ahead[e] > ends[e]) ends[e] = ahead[e];
      if (behind[e] > ends[e]) ends[e] = behind[e];
    }
  }
  *at_ends = (ends[0] > 0.0 ? ends[0] : 0.0) + (ends[1] > 0.0 ? ends[1] : 0.0);
  return gap;
}

/* Directions across which convex polygons [q, 3] may be apart, as `_axes`. */
static int64_t all_axes(const double *a, const double *b, int64_t q, double *out) {
  double u[3], v[3], *normals = out;
  int64_t many = 2;
  area_vector(a, q, out), area_vector(b, q, out + 3);
  for (int64_t i = 0; i < q; i++) {
    less(a + 3 * ((i + 1) % q), a + 3 * i, u);
    for (int64_t j = 0; j < q; j++) {
      less(b + 3 * ((j + 1) % q), b + 3 * j, v);
      cross(u, v, out + 3 * many++);
      less(b + 3 * j, a + 3 * i, out + 3 * many++);
    }
    cross(u, normals, out + 3 * many++);
    less(b + 3 * ((i + 1) % q), b + 3 * i, v);
    cross(v, normals + 3, out + 3 * many++);
  }
  return many;
}

/* The same for sectors with a common apex, from unit rays a [2, 3] and b [2, 2, 3], as `_sectors_apart`. */
static double sectors_apart(const double *a, const double *b, double *at_ends) {
  double n[21 * 3], m[6], away[3], inward[3], u[3], gap = -INFINITY, ends[2] = {-INFINITY, -INFINITY};
  int many = 0;
  for (int i = 0; i < 6; i++) m[i] = 0.5 * (b[i] + b[6 + i]);
  add(a, 1.0, a + 3, away), add(m, 1.0, m + 3, inward);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      less(m + 3 * j, a + 3 * i, n + 3 * many++);
      add(m + 3 * j, -dot(a + 3 * i, m + 3 * j), a + 3 * i, n + 3 * many++);
    }
  double fall = dot(away, m + 3) - dot(away, m);
  cross(a, a + 3, u), unit(u);
  for (int sign = 0; sign < 2; sign++) {
    if (sign) u[0] = -u[0], u[1] = -u[1], u[2] = -u[2];
    double even = fabs(fall) > NONZERO ? (dot(u, m + 3) - dot(u, m)) / fall : 0.0;
    add(u, -(even < 0.0 ? 0.0 : even > 1.0 ? 1.0 : even), away, n + 3 * many++);
    for (int k = 0; k < 4; k++) add(u, -TILTS[k], away, n + 3 * many++);
  }
  double ahead = fmax(dot(inward, a), dot(inward, a + 3));
  cross(m, m + 3, u), unit(u);
  for (int sign = 0; sign < 2; sign++) {
    if (sign) u[0] = -u[0], u[1] = -u[1], u[2] = -u[2];
    double low = -fmax(dot(u, a), dot(u, a + 3));
    add(u, fmax(low, 0.0) / fmax(ahead, fabs(low) + NONZERO), inward, n + 3 * many++);
  }
  less(inward, away, n + 3 * many++);
  for (int k = 0; k < many; k++) {
    double *axis = n + 3 * k, high[2] = {-1.0, -1.0};
    unit(axis);
    if (fmax(dot(axis, a), dot(axis, a + 3)) <= CLOSURE_TOL)
      for (int e = 0; e < 2; e++) high[e] = fmin(dot(axis, b + 6 * e), dot(axis, b + 6 * e + 3));
    gap = fmax(gap, fmin(high[0], high[1]));
    for (int e = 0; e < 2; e++) ends[e] = fmax(ends[e], high[e]);
  }
  *at_ends = fmax(ends[0], 0.0) + fmax(ends[1], 0.0);
  return gap;
}

/* Rotation and translation of facet j as facet i sees it. */
static void seen(const double *turn, const double *shift, int64_t i, int64_t j, double size, double *r, double *t) {
  const double *one = turn + 9 * i, *other = turn + 9 * j;
  double away[3];
  for (int k = 0; k < 3; k++) away[k] = (shift[3 * j + k] - shift[3 * i + k]) / size;
  for (int k = 0; k < 3; k++) {
    t[k] = one[k] * away[0] + one[3 + k] * away[1] + one[6 + k] * away[2];
    for (int l = 0; l < 3; l++) r[3 * k + l] = one[k] * other[l] + one[3 + k] * other[3 + l] + one[6 + k] * other[6 + l];
  }
}

static void carry(const double *r, const double *t, const double *x, double *out) {
  for (int k = 0; k < 3; k++) out[k] = dot(r + 3 * k, x) + (t ? t[k] : 0.0);
}

/* What pairs do inside each step, [T, K]: 0 they are apart, 1 they might touch, 2 they touch at both ends.
   Motions at both ends are [2, T, F, 9] and [2, T, F, 3]; `work` has room for 2 + 2 q + 2 q^2 axes and 3 q corners. */
void find_touching(const Sheet *p, int64_t steps, const double *turn, const double *shift, const double *speed,
                   const double *bend, int64_t asked, const int64_t *pairs, double *work, unsigned char *out) {
  int64_t q = p->q, f = p->facets;
  double *b = work, *middle = b + 6 * q, *axes = middle + 3 * q;
  for (int64_t s = 0; s < steps; s++)
    for (int64_t i = 0; i < asked; i++) {
      int64_t k = pairs[i], still = p->still[k], moving = p->moving[k], here = p->facet[still], there = p->facet[moving];
      double r[18], t[6], at_ends = 0.0, gap = 0.0, fast = 0.0, carried = 0.0, bent = 0.0;
      unsigned char *say = out + s * asked + i;
      *say = 2;
      if (p->apex[k] == -2) continue; /* several corners in common: never shown to be apart */
      for (int64_t c = p->first[k]; c < p->first[k + 1]; c++) {
        double v = speed[s * p->n + p->crease[c]];
        fast += v, carried += v * p->arm[c], bent += bend[s * p->n + p->crease[c]] * p->arm[c];
      }
      double off = (bent + 2 * fast * carried) / 8;
      for (int e = 0; e < 2; e++)
        seen(turn + (e * steps + s) * f * 9, shift + (e * steps + s) * f * 3, here, there, p->size, r + 9 * e, t + 3 * e);
      if (p->apex[k] >= 0) {
        double rays[12];
        for (int e = 0; e < 2; e++)
          for (int m = 0; m < 2; m++) carry(r + 9 * e, 0, p->rays_moving + 6 * k + 3 * m, rays + 6 * e + 3 * m);
        gap = sectors_apart(p->rays_still + 6 * k, rays, &at_ends);
        *say = gap <= off ? 1 + (at_ends < DEEP) : 0;
        continue;
      }
      const double *a = p->corners + 3 * q * still, *x = p->corners + 3 * q * moving;
      double y[6], d[3];
      for (int e = 0; e < 2; e++) carry(r + 9 * e, t + 3 * e, p->middles + 3 * moving, d), less(d, p->middles + 3 * still, y + 3 * e);
      less(y + 3, y, d);
      double near = sqrt(dot(y, y)) + sqrt(dot(y + 3, y + 3)) - sqrt(dot(d, d));
      *say = 0;
      if (!(near / 2 - p->radii[moving] - p->radii[still] <= off)) continue;
      for (int e = 0; e < 2; e++)
        for (int64_t m = 0; m < q; m++) carry(r + 9 * e, t + 3 * e, x + 3 * m, b + 3 * (q * e + m));
      for (int64_t m = 0; m < 3 * q; m++) middle[m] = 0.5 * (b[m] + b[3 * q + m]);
      axes[0] = axes[1] = axes[2] = 0.0;
      for (int64_t m = 0; m < q; m++) less(middle + 3 * m, a + 3 * m, d), add(axes, 1.0 / q, d, axes);
      gap = apart(a, b, q, axes, 1, &at_ends);
      if (!(gap <= off)) continue;
      area_vector(a, q, axes), area_vector(middle, q, axes + 3);
      gap = apart(a, b, q, axes, 2, &at_ends);
      if (!(gap <= off)) continue;
      gap = apart(a, b, q, axes, all_axes(a, middle, q, axes), &at_ends);
      if (gap <= off) *say = 1 + (at_ends < DEEP);
    }
}
