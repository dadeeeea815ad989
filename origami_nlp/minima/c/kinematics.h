/* One folded state after the other: what `problem.kinematics` says of arrays of states; the derivation is there. */

typedef struct {
  double *rays; /* [rays + 4, 3] */
  double *axes; /* creases times their factor, [creases, 3] */
  double end[4];
} Folded;

static void cross(const double *a, const double *b, double *out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void fold(const Vertex *v, const double *x, Folded *at) {
  double w = 1.0, a = 0.0, b = 0.0, c = 0.0;
  const double *o = v->onward;
  for (int64_t r = 0; r <= v->rays; r++) {
    if (r == v->period) {
      at->end[0] = w * o[0] - c * o[3], at->end[1] = a * o[0] + b * o[3];
      at->end[2] = b * o[0] - a * o[3], at->end[3] = c * o[0] + w * o[3];
    }
    if (r == v->rays) break;
    double bx = v->flat[2 * r], by = v->flat[2 * r + 1], *ray = at->rays + 3 * r;
    double tx = -2 * by * c, ty = 2 * bx * c, tz = 2 * by * a - 2 * bx * b;
    ray[0] = bx + w * tx + b * tz - c * ty;
    ray[1] = by + w * ty + c * tx - a * tz;
    ray[2] = w * tz + a * ty - b * tx;
    int64_t k = v->crease[r];
    if (k < 0) continue;
    double f = v->factor[k], half = 0.5 * (f * x[v->variable[k]]), co = cos(half), si = sin(half);
    for (int i = 0; i < 3; i++) at->axes[3 * k + i] = f * ray[i];
    double w1 = co * w - si * (bx * a + by * b), a1 = co * a + si * (bx * w - by * c);
    double b1 = co * b + si * (by * w + bx * c), c1 = co * c + si * (by * a - bx * b);
    w = w1, a = a1, b = b1, c = c1;
  }
  double *extra = at->rays + 3 * v->rays; /* e3, e1, and what spans the last mirror, carried along */
  for (int i = 0; i < 12; i++) extra[i] = i == 2 || i == 3;
  if (v->plane) return;
  w = at->end[0], a = at->end[1], b = at->end[2], c = at->end[3];
  for (int k = 0; k < 2; k++) {
    const double *m = v->mirror + 3 * k;
    double tx = 2 * (b * m[2] - c * m[1]), ty = 2 * (c * m[0] - a * m[2]), tz = 2 * (a * m[1] - b * m[0]);
    extra[6 + 3 * k] = m[0] + w * tx + b * tz - c * ty;
    extra[7 + 3 * k] = m[1] + w * ty + c * tx - a * tz;
    extra[8 + 3 * k] = m[2] + w * tz + a * ty - b * tx;
  }
}

/* The normal of the last mirror as it was carried along. */
static void end_normal(const Vertex *v, const Folded *at, double *out) {
  cross(at->rays + 3 * (v->rays + 3), at->rays + 3 * (v->rays + 2), out);
}

/* Scalar and vector of e conj(q) for equation e: the derivative of an entry of q is linear in these. */
static void lever_of(const Vertex *v, const Folded *at, int64_t e, double *out) {
  for (int k = 0; k < 4; k++) {
    out[k] = 0.0;
    for (int j = 0; j < 4; j++) out[k] += at->end[j] * v->lever[4 * v->m * j + 4 * e + k];
  }
}

/* The equations [m] and their Jacobian [m, n]. */
static void closure(const Vertex *v, const Folded *at, double *value, double *rows) {
  double l[4];
  if (!v->entries) {
    double normal[3];
    end_normal(v, at, normal);
    value[0] = normal[1] + v->level;
    for (int64_t i = 0; i < v->first; i++)
      rows[i] = -normal[2] * at->axes[3 * i] + normal[0] * at->axes[3 * i + 2];
    return;
  }
  for (int64_t e = 0; e < v->m; e++) {
    value[e] = at->end[v->entry[e]] - (v->shifted ? v->level : 0.0);
    lever_of(v, at, e, l);
    for (int64_t i = 0; i < v->first; i++) rows[e * v->n + i] = 0.5 * dot3(l + 1, at->axes + 3 * i);
  }
}

/* Add the Hessian of weights . equations to h [n, n]. */
static void add_closure_hessian(const Vertex *v, const Folded *at, const double *weights, double *h) {
  double normal[3], sum[4] = {0.0, 0.0, 0.0, 0.0}, l[4], p[3], value;
  end_normal(v, at, normal);
  for (int64_t e = 0; v->entries && e < v->m; e++) {
    lever_of(v, at, e, l);
    for (int k = 0; k < 4; k++) sum[k] += weights[e] * l[k];
  }
  for (int64_t i = 0; i < v->first; i++) {
    const double *u = at->axes + 3 * i;
    cross(sum + 1, u, p);
    for (int k = 0; k < 3; k++) p[k] -= sum[0] * u[k];
    for (int64_t j = i; j < v->first; j++) {
      const double *q = at->axes + 3 * j;
      if (v->entries)
        value = 0.25 * dot3(p, q);
      else /* (e2 x c_i) . (c_j x N) */
        value = weights[0] * (u[2] * (q[1] * normal[2] - q[2] * normal[1]) - u[0] * (q[0] * normal[1] - q[1] * normal[0]));
      h[i * v->n + j] += value;
      if (j > i) h[j * v->n + i] += value;
    }
  }
}

/* The value of a gap, without sign, and its gradient [n]. */
static double gap_at(const Vertex *v, const Folded *at, int64_t g, double *row) {
  const double *p = at->rays + 3 * v->three[3 * g], *q = at->rays + 3 * v->three[3 * g + 1];
  const double *r = at->rays + 3 * v->three[3 * g + 2];
  double pq = dot3(p, q), qr = dot3(q, r), pr = dot3(p, r), normal[3];
  const int64_t *before = v->before + 3 * g;
  for (int64_t i = 0; i < v->n; i++) row[i] = 0.0;
  for (int64_t e = before[0]; e < before[2]; e++) {
    const double *c = at->axes + 3 * e;
    /* turning q and r on is turning p back: -p x (q x r); turning r on: r x (p x q) */
    double slope = e < before[1] ? pq * dot3(r, c) - pr * dot3(q, c) : qr * dot3(p, c) - pr * dot3(q, c);
    row[e % v->n] += v->over[g] * slope;
  }
  cross(q, r, normal);
  return v->over[g] * dot3(p, normal);
}

/* Add the Hessian of a weight times a gap to h [n, n]. */
static void add_gap_hessian(const Vertex *v, const Folded *at, int64_t g, double weight, double *h) {
  const double *p = at->rays + 3 * v->three[3 * g], *q = at->rays + 3 * v->three[3 * g + 1];
  const double *r = at->rays + 3 * v->three[3 * g + 2];
  const int64_t *before = v->before + 3 * g;
  double pxq[3], qxr[3], lxp[3], value;
  cross(p, q, pxq);
  cross(q, r, qxr);
  double volume = dot3(p, qxr), qr = dot3(q, r), scale = weight * v->over[g];
  for (int64_t k = before[0]; k < before[2]; k++) {
    const double *l = at->axes + 3 * k; /* the earlier crease */
    cross(l, p, lxp);
    for (int64_t e = k; e < before[2]; e++) {
      const double *c = at->axes + 3 * e;
      if (e < before[1])
        value = dot3(l, qxr) * dot3(c, p) - volume * dot3(l, c);
      else if (k >= before[1])
        value = dot3(c, pxq) * dot3(l, r) - volume * dot3(l, c);
      else
        value = dot3(lxp, r) * dot3(c, q) - qr * dot3(lxp, c);
      h[k % v->n * v->n + e % v->n] += scale * value;
      if (e > k) h[e % v->n * v->n + k % v->n] += scale * value;
    }
  }
}
