/* Downhill from a closed state to near the minimum below it: Newton on the energy with barriers at fold limits and
   between facets (incremental potential contact: Li et al., ACM Trans. Graph. 39, 2020), which fall stage by stage.
   Nothing is decided by it.  Lengths are over the sheet's size; sources of facets and of closure stand before. */

typedef struct {
  double d, p[3], q[3];     /* distance, and the nearest points */
  int64_t pair, one, other; /* corners, or sides that begin there; -1 for a piece as a whole */
} Near;

static int64_t shared(const Scout *s, int64_t piece, int64_t corner, int64_t other) {
  int64_t q = s->q, v = s->pieces[q * piece + corner];
  for (int64_t k = 0; k < q; k++)
    if (s->pieces[q * other + k] == v) return 1;
  return 0;
}

static double clipped(double x) { return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x; }

/* Nearest points of segments a b and c d (Ericson, Real-Time Collision Detection, 5.1.9). */
static double segments(const double *a, const double *b, const double *c, const double *d, double *p, double *q) {
  double u[3], v[3], w[3], t, r;
  for (int i = 0; i < 3; i++) u[i] = b[i] - a[i], v[i] = d[i] - c[i], w[i] = a[i] - c[i];
  double uu = dot(u, u, 3), vv = dot(v, v, 3), uw = dot(u, w, 3), vw = dot(v, w, 3), uv = dot(u, v, 3);
  double det = uu * vv - uv * uv;
  t = det > PARALLEL * uu * vv ? clipped((uv * vw - uw * vv) / det) : 0.0;
  r = (uv * t + vw) / vv;
  if (r < 0.0)
    r = 0.0, t = clipped(-uw / uu);
  else if (r > 1.0)
    r = 1.0, t = clipped((uv - uw) / uu);
  for (int i = 0; i < 3; i++) p[i] = a[i] + t * u[i], q[i] = c[i] + r * v[i], w[i] = p[i] - q[i];
  return sqrt(dot(w, w, 3));
}

/* Nearest point of a convex polygon to a point. */
static double to_polygon(const double *x, const double *y, int64_t k, const double *normal, double *q) {
  double w[3], e[3], c[3], best = INFINITY;
  int inside = 1;
  for (int64_t i = 0; i < k && inside; i++) {
    const double *a = y + 3 * i, *b = y + 3 * ((i + 1) % k);
    for (int j = 0; j < 3; j++) e[j] = b[j] - a[j], w[j] = x[j] - a[j];
    cross(normal, e, c);
    if (dot(c, w, 3) < 0.0) inside = 0;
  }
  if (inside) {
    for (int j = 0; j < 3; j++) w[j] = x[j] - y[j];
    double h = dot(normal, w, 3);
    for (int j = 0; j < 3; j++) q[j] = x[j] - h * normal[j];
    return fabs(h);
  }
  for (int64_t i = 0; i < k; i++) {
    const double *a = y + 3 * i, *b = y + 3 * ((i + 1) % k);
    double ee, t, at[3];
    for (int j = 0; j < 3; j++) e[j] = b[j] - a[j], w[j] = x[j] - a[j];
    if (!((ee = dot(e, e, 3)) > 0.0)) continue;
    t = clipped(dot(w, e, 3) / ee);
    for (int j = 0; j < 3; j++) at[j] = a[j] + t * e[j], w[j] = x[j] - at[j];
    double d = dot(w, w, 3);
    if (d < best) best = d, memcpy(q, at, sizeof(at));
  }
  return sqrt(best);
}

/* Motions of facets, corners of pieces [P, q, 3] and unit normals [P, 3]. */
static void carry_all(const Scout *s, const double *phi, Placed *at) {
  int64_t q = s->q;
  for (int64_t i = 0; i < s->loops->n; i++) s->angle[i] = phi[i] - s->reference[i];
  memset(at->turn, 0, 9 * sizeof(double) * s->facets);
  memset(at->shift, 0, 3 * sizeof(double) * s->facets);
  for (int i = 0; i < 3; i++) at->turn[9 * s->root + 4 * i] = 1.0;
  place(s->steps, s->here, s->before, s->crossed, s->axis, s->point, s->angle, at->turn, at->shift);
  for (int64_t k = 0; k < s->many; k++) {
    const double *r = at->turn + 9 * s->facet[k], *t = at->shift + 3 * s->facet[k];
    double *x = at->x + 3 * q * k;
    for (int64_t c = 0; c < q; c++)
      for (int i = 0; i < 3; i++)
        x[3 * c + i] = dot(r + 3 * i, s->shape + 3 * (q * k + c), 3) + t[i] / s->size;
    for (int i = 0; i < 3; i++) {
      at->normal[3 * k + i] = dot(r + 3 * i, s->normals + 3 * k, 3);
      at->middle[3 * k + i] = dot(r + 3 * i, s->middles + 3 * k, 3) + t[i] / s->size;
    }
  }
}

/* Whether features touch where a descent begins: no barrier is between these, and only that facets do not cross. */
static int left_out(const Scout *s, int64_t pair, int64_t features, double d) {
  unsigned char *out = s->touch + s->room_of_pair * pair + features;
  if (s->begins[0] && d <= TOUCHES) *out = 1;
  return *out;
}

/* Features of a pair of pieces nearer than `reach`. */
static int64_t near_of(const Scout *s, const Placed *at, int64_t pair, double reach, Near *out) {
  int64_t q = s->q, one[2] = {s->one[pair], s->other[pair]}, many = 0;
  double w[3], far = reach + s->radii[one[0]] + s->radii[one[1]];
  for (int i = 0; i < 3; i++) w[i] = at->middle[3 * one[0] + i] - at->middle[3 * one[1] + i];
  if (dot(w, w, 3) > far * far) return 0;
  for (int side = 0; side < 2; side++) { /* corners of one to the other */
    int64_t a = one[side], b = one[1 - side];
    const double *n = at->normal + 3 * b, *y = at->x + 3 * q * b;
    for (int64_t c = 0; c < s->corners[a]; c++) {
      const double *x = at->x + 3 * (q * a + c);
      for (int i = 0; i < 3; i++) w[i] = x[i] - y[i];
      if (fabs(dot(w, n, 3)) >= reach || shared(s, a, c, b)) continue;
      Near *to = out + many;
      to->d = to_polygon(x, y, s->corners[b], n, side ? to->p : to->q);
      if (to->d >= reach || left_out(s, pair, side * q + c, to->d)) continue;
      memcpy(side ? to->q : to->p, x, 3 * sizeof(double));
      to->pair = pair, to->one = side ? -1 : c, to->other = side ? c : -1, many++;
    }
  }
  int64_t a = one[0], b = one[1];
  for (int64_t c = 0; c < s->corners[a]; c++) {
    int64_t next = (c + 1) % s->corners[a];
    if (shared(s, a, c, b) || shared(s, a, next, b)) continue;
    const double *x0 = at->x + 3 * (q * a + c), *x1 = at->x + 3 * (q * a + next), *n = at->normal + 3 * b, *y = at->x + 3 * q * b;
    double h0, h1;
    for (int i = 0; i < 3; i++) w[i] = x0[i] - y[i];
    h0 = dot(w, n, 3);
    for (int i = 0; i < 3; i++) w[i] = x1[i] - y[i];
    h1 = dot(w, n, 3);
    if ((h0 > reach && h1 > reach) || (h0 < -reach && h1 < -reach)) continue;
    for (int64_t d = 0; d < s->corners[b]; d++) {
      int64_t after = (d + 1) % s->corners[b];
      if (shared(s, b, d, a) || shared(s, b, after, a)) continue;
      Near *to = out + many;
      to->d = segments(x0, x1, y + 3 * d, y + 3 * after, to->p, to->q);
      if (to->d >= reach || left_out(s, pair, 2 * q + q * c + d, to->d)) continue;
      to->pair = pair, to->one = c, to->other = d, many++;
    }
  }
  return many;
}

/* mu times the barrier -(1 - u / reach)^2 log(u / reach), and its derivative. */
static double barrier(double u, double reach, double mu, double *slope, double *curvature) {
  *slope = *curvature = 0.0;
  if (u >= reach) return 0.0;
  if (!(u > 0.0)) return INFINITY;
  double s = u / reach, l = log(s);
  *slope = mu / reach * (2 * (1 - s) * l - (1 - s) * (1 - s) / s);
  *curvature = mu / (reach * reach) * (4 * (1 - s) / s + (1 - s) * (1 - s) / (s * s) - 2 * l);
  return -mu * (1 - s) * (1 - s) * l;
}

/* Energy with barriers at a state that is placed; INFINITY beyond a limit.  With `near` what is near is listed. */
static double value_of(const Scout *s, const double *phi, const Placed *at, int pairs, double share, Near *near, int64_t *many) {
  double total = 0.0, slope, curvature, mu = s->strength * share, reach = share * s->length;
  for (int64_t i = 0; i < s->loops->n; i++) {
    double off = phi[i] - s->rest[i];
    total += 0.5 * s->stiffness[i] * off * off - s->load[i] * phi[i];
    if (s->stays[i]) continue;
    total += barrier(phi[i] - s->low[i], share, mu, &slope, &curvature) + barrier(s->high[i] - phi[i], share, mu, &slope, &curvature);
  }
  *many = 0;
  for (int64_t k = 0; pairs && k < s->pairs && total < INFINITY; k++) {
    int64_t more = near_of(s, at, k, reach, near + *many);
    for (int64_t j = *many; j < *many + more; j++) total += barrier(near[j].d, reach, mu, &slope, &curvature);
    if (*many + more + s->room_of_pair > s->room) return INFINITY;
    *many += more;
  }
  return total;
}

/* Add the gradient of barriers between features as listed, [n]: forces on facets, summed up from the leaves of walks on. */
static void add_slopes(const Scout *s, const Placed *at, double share, const Near *near, int64_t many, double *g) {
  double slope, curvature, mu = s->strength * share, reach = share * s->length, *wrench = s->wrench;
  if (!many) return;
  memset(wrench, 0, 6 * s->facets * sizeof(double));
  for (int64_t k = 0; k < many; k++) {
    double f[3], moment[3];
    barrier(near[k].d, reach, mu, &slope, &curvature);
    for (int i = 0; i < 3; i++) f[i] = slope * (near[k].p[i] - near[k].q[i]) / near[k].d;
    double *one = wrench + 6 * s->facet[s->one[near[k].pair]];
    double *other = wrench + 6 * s->facet[s->other[near[k].pair]];
    cross(near[k].p, f, moment);
    for (int i = 0; i < 3; i++) one[i] += f[i], one[3 + i] += moment[i];
    cross(near[k].q, f, moment);
    for (int i = 0; i < 3; i++) other[i] -= f[i], other[3 + i] -= moment[i];
  }
  for (int64_t k = s->steps - 1; k >= 0; k--) {
    const double *r = at->turn + 9 * s->before[k], *t = at->shift + 3 * s->before[k];
    double *from = wrench + 6 * s->here[k], *to = wrench + 6 * s->before[k], a[3], o[3], c[3];
    for (int i = 0; i < 3; i++) {
      a[i] = dot(r + 3 * i, s->axis + 3 * k, 3);
      o[i] = (dot(r + 3 * i, s->point + 3 * k, 3) + t[i]) / s->size;
    }
    cross(o, from, c);
    for (int i = 0; i < 3; i++) c[i] = from[3 + i] - c[i];
    g[s->crossed[k]] += dot(a, c, 3);
    for (int i = 0; i < 6; i++) to[i] += from[i];
  }
}

/* The features of a list at another state. */
static void again(const Scout *s, const Placed *at, const Near *list, int64_t many, Near *out) {
  int64_t q = s->q;
  for (int64_t k = 0; k < many; k++) {
    const Near *old = list + k;
    Near *to = out + k;
    int64_t a = s->one[old->pair], b = s->other[old->pair], i = old->one, j = old->other;
    const double *x = at->x + 3 * q * a, *y = at->x + 3 * q * b;
    *to = *old;
    if (j < 0) { /* corner of the first */
      memcpy(to->p, x + 3 * i, 3 * sizeof(double));
      to->d = to_polygon(x + 3 * i, y, s->corners[b], at->normal + 3 * b, to->q);
    } else if (i < 0) {
      memcpy(to->q, y + 3 * j, 3 * sizeof(double));
      to->d = to_polygon(y + 3 * j, x, s->corners[a], at->normal + 3 * a, to->p);
    } else
      to->d = segments(x + 3 * i, x + 3 * ((i + 1) % s->corners[a]), y + 3 * j, y + 3 * ((j + 1) % s->corners[b]), to->p, to->q);
  }
}

/* Orthonormal Q [n, n] by columns of J' [m, n] with pivots, R in place of J' rows; the rank. */
static int64_t orthogonal(int64_t n, int64_t m, double *a, double *q, int64_t *order) {
  /* a [m, n]: row k is column k of J'; Householder */
  int64_t rank = 0;
  double first = 0.0;
  for (int64_t k = 0; k < m; k++) order[k] = k;
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++) q[i * n + j] = i == j; /* row i: i-th column of Q */
  for (int64_t k = 0; k < m && k < n; k++) {
    double most = -1.0;
    int64_t best = k;
    for (int64_t c = k; c < m; c++) {
      double size = dot(a + n * c + k, a + n * c + k, n - k);
      if (size > most * (1 + ROUNDED)) most = size, best = c;
    }
    most = sqrt(most);
    if (!k) first = most;
    if (!(most > RANK * first)) break;
    if (best != k) {
      int64_t o = order[k];
      order[k] = order[best], order[best] = o;
      for (int64_t i = 0; i < n; i++) {
        double t = a[n * k + i];
        a[n * k + i] = a[n * best + i], a[n * best + i] = t;
      }
    }
    double *x = a + n * k, v[MOST_CREASES], alpha = x[k] > 0 ? -most : most, vv;
    for (int64_t i = k; i < n; i++) v[i] = x[i];
    v[k] -= alpha;
    vv = dot(v + k, v + k, n - k);
    for (int64_t c = k; c < m; c++) {
      double t = 2 * dot(v + k, a + n * c + k, n - k) / vv;
      for (int64_t i = k; i < n; i++) a[n * c + i] -= t * v[i];
    }
    for (int64_t i = 0; i < n; i++) { /* Q H, by entries: q[j][i] is entry i of column j */
      double t = 0.0;
      for (int64_t j = k; j < n; j++) t += q[j * n + i] * v[j];
      t *= 2 / vv;
      for (int64_t j = k; j < n; j++) q[j * n + i] -= t * v[j];
    }
    rank++;
  }
  return rank;
}

/* Eigenvalues on the diagonal of a [r, r], eigenvectors by rows of v, by Jacobi's rotations. */
static void spectrum(int64_t r, double *a, double *v) {
  for (int64_t i = 0; i < r * r; i++) v[i] = i % (r + 1) == 0;
  for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    double off = 0.0, on = 0.0;
    for (int64_t i = 0; i < r; i++)
      for (int64_t j = 0; j < r; j++) *(i == j ? &on : &off) += a[i * r + j] * a[i * r + j];
    if (off <= EPS * on) break;
    for (int64_t i = 0; i < r; i++)
      for (int64_t j = i + 1; j < r; j++) {
        double x = a[i * r + j];
        if (x == 0.0) continue;
        double th = 0.5 * (a[j * r + j] - a[i * r + i]) / x, t = 1 / (fabs(th) + sqrt(th * th + 1));
        if (th < 0) t = -t;
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int64_t k = 0; k < r; k++) {
          double y = a[i * r + k], z = a[j * r + k];
          a[i * r + k] = c * y - s * z, a[j * r + k] = s * y + c * z;
        }
        for (int64_t k = 0; k < r; k++) {
          double y = a[k * r + i], z = a[k * r + j];
          a[k * r + i] = c * y - s * z, a[k * r + j] = s * y + c * z;
        }
        for (int64_t k = 0; k < r; k++) {
          double y = v[i * r + k], z = v[j * r + k];
          v[i * r + k] = c * y - s * z, v[j * r + k] = s * y + c * z;
        }
      }
  }
}

static int crosses(const Scout *s, const Placed *at) {
  find_crossings(1, s->many, s->q, at->x, s->pairs, s->one, s->other, DEEP, s->seen, s->hit);
  for (int64_t k = 0; k < s->pairs; k++)
    if (s->hit[k]) return 1;
  return 0;
}

/* Go down from phi [n]; `ends`: how it ended (0 at rest, 1 no lower state, 2 too many steps, 3 no start), steps, slope at rest.
   Without pairs `last` is the last state before facets cross, `ends[3]` whether they do. */
void scout(const Scout *s, double *phi, int64_t pairs, int64_t stages, const double *shares, int64_t most, double *last, double *pulls, double *ends) {
  const Loops *p = s->loops;
  int64_t n = p->n, m = p->m, many = 0, steps = 0, more = 0;
  double *g = s->vector, *d = g + n, *trial = d + n, *gz = trial + n, *y = gz + n, *g2 = y + n, *lam = g2 + n, *b = lam + m + n, *bent = b + n;
  double *j = s->matrix, *q = j + (m + n) * n, *h = q + n * n, *hz = h + n * n, *v = hz + n * n, residual[2];
  Placed here = {s->turns, s->shifts, s->x, s->normal, s->middle};
  Placed there = {s->turns + 9 * s->facets, s->shifts + 3 * s->facets, s->x + 3 * s->q * s->many, s->normal + 3 * s->many, s->middle + 3 * s->many};
  Near *near = s->near, *other = near + s->room;
  int crossed = 0;
  ends[0] = 3, ends[1] = ends[2] = ends[3] = 0.0;
  project(p, phi, s->stays, MOST_CORRECTIONS, 0, s->place, residual);
  if (!(residual[0] <= CLOSURE_TOL)) return;
  carry_all(s, phi, &here);
  memcpy(last, phi, n * sizeof(double));
  if (!pairs) crossed = crosses(s, &here);
  for (int64_t stage = 0; stage < stages; stage++) {
    double share = shares[stage], mu = s->strength * share;
    if (!stage) memset(s->touch, 0, s->room_of_pair * s->pairs);
    s->begins[0] = !stage;
    double value = value_of(s, phi, &here, pairs, share, near, &many);
    s->begins[0] = 0;
    if (!(value < INFINITY)) return;
    ends[0] = 0;
    for (;;) {
      if (steps++ == most) {
        ends[0] = 2;
        goto out;
      }
      memset(b, 0, n * sizeof(double));
      add_slopes(s, &here, share, near, many, b);
      for (int64_t i = 0; i < n; i++) {
        double low = 0.0, high = 0.0;
        bent[i] = trial[i] = 0.0;
        if (!s->stays[i]) {
          barrier(phi[i] - s->low[i], share, mu, &low, bent + i);
          barrier(s->high[i] - phi[i], share, mu, &high, trial + i);
        }
        g[i] = s->stiffness[i] * (phi[i] - s->rest[i]) - s->load[i] + b[i] + low - high;
        bent[i] += trial[i] + s->stiffness[i];
      }
      memset(j, 0, (m + n) * n * sizeof(double));
      equations(p, phi, s->place, lam, j);
      int64_t rows = m;
      for (int64_t i = 0; i < n; i++)
        if (s->stays[i]) j[rows++ * n + i] = 1.0;
      int64_t rank = orthogonal(n, rows, j, q, s->order), r = n - rank;
      double *z = q + rank * n;
      memset(lam, 0, rows * sizeof(double));
      for (int64_t k = rank - 1; k >= 0; k--) {
        double x = dot(q + k * n, g, n);
        for (int64_t c = k + 1; c < rank; c++) x -= j[n * c + k] * lam[s->order[c]];
        lam[s->order[k]] = x / j[n * k + k];
      }
      memset(h, 0, n * n * sizeof(double));
      bend(p, phi, s->place, lam, h);
      for (int64_t i = 0; i < n * n; i++) h[i] = -h[i];
      for (int64_t i = 0; i < n; i++) h[i * n + i] += bent[i];
      for (int64_t k = 0; k < r; k++) {
        gz[k] = dot(z + k * n, g, n);
        for (int64_t i = 0; i < n; i++) y[i] = dot(h + i * n, z + k * n, n);
        if (many) { /* curvature of barriers by differences of their slopes */
          double step = DIFFERENCE * share;
          for (int64_t i = 0; i < n; i++) trial[i] = phi[i] + step * z[k * n + i], g2[i] = 0.0;
          carry_all(s, trial, &there);
          again(s, &there, near, many, other);
          add_slopes(s, &there, share, other, many, g2);
          for (int64_t i = 0; i < n; i++) y[i] += (g2[i] - b[i]) / step;
        }
        for (int64_t l = 0; l < r; l++) hz[k * r + l] = dot(z + l * n, y, n);
      }
      for (int64_t k = 0; k < r; k++)
        for (int64_t l = 0; l < k; l++) hz[k * r + l] = hz[l * r + k] = 0.5 * (hz[k * r + l] + hz[l * r + k]);
      spectrum(r, hz, v);
      double slope = 0.0, size = 0.0;
      memset(d, 0, n * sizeof(double));
      for (int64_t k = 0; k < r; k++) {
        double x = dot(v + k * r, gz, r), c = fabs(hz[k * r + k]);
        x = -x / (c > SOFTEST ? c : SOFTEST);
        for (int64_t l = 0; l < r; l++)
          for (int64_t i = 0; i < n; i++) d[i] += x * v[k * r + l] * z[l * n + i];
      }
      slope = dot(g, d, n), size = largest(d, n);
      ends[2] = slope;
      if (-slope <= (stage + 1 < stages ? ROUGH * share : STILL)) break;
      double length = size > TRUST ? TRUST / size : 1.0;
      for (int64_t i = 0; i < n; i++) {
        if (s->stays[i]) continue;
        double room = d[i] < 0 ? phi[i] - s->low[i] : s->high[i] - phi[i];
        if (length * fabs(d[i]) > NEARLY * room) length = NEARLY * room / fabs(d[i]);
      }
      if (many) { /* what closes at this rate does not, within a step */
        double step = DIFFERENCE * share / size;
        for (int64_t i = 0; i < n; i++) trial[i] = phi[i] + step * d[i];
        carry_all(s, trial, &there);
        again(s, &there, near, many, other);
        for (int64_t k = 0; k < many; k++) {
          double closing = (near[k].d - other[k].d) / step;
          if (length * closing > NEARLY * near[k].d) length = NEARLY * near[k].d / closing;
        }
      }
      int moved = 0;
      for (int half = 0; half < MOST_HALVINGS && !moved; half++, length *= 0.5) {
        for (int64_t i = 0; i < n; i++) trial[i] = phi[i] + length * d[i];
        project(p, trial, s->stays, MOST_CORRECTIONS, phi, s->place, residual);
        if (!(residual[0] <= CLOSURE_TOL && residual[1] > 0)) continue;
        double off = 0.0;
        for (int64_t i = 0; i < n; i++) off = fmax(off, fabs(trial[i] - phi[i] - length * d[i]));
        if (off > 0.5 * length * size + ROUNDED) continue;
        carry_all(s, trial, &there);
        double new = value_of(s, trial, &there, pairs, share, other, &more);
        if (!(new < value + DECREASE * length * slope)) continue;
        if (pairs && crosses(s, &there)) continue;
        moved = 1, value = new;
      }
      if (!moved) {
        ends[0] = 1;
        break;
      }
      memcpy(phi, trial, n * sizeof(double));
      if (!pairs && !crossed) {
        if (crosses(s, &there))
          crossed = 1;
        else
          memcpy(last, phi, n * sizeof(double));
      }
      Placed left = here;
      Near *old = near;
      here = there, there = left, near = other, other = old;
      many = more;
    }
  }
out:
  ends[1] = steps, ends[3] = crossed;
  for (int64_t i = 0, k = m; i < n; i++) pulls[i] = s->stays[i] ? lam[k++] : 0.0;
}
