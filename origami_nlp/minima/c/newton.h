/* Newton's direction of one sample, as in `descents` and `recursive_newton`; the derivation is there. */

typedef struct {
  Trial trial;
  double *d, *dx, *down, *opens, *bent, *soft;         /* [n] each */
  double *pull, *depth;                                /* [n + SLOTS], [all that may cross] */
  double *h, *projector, *product, *vectors;           /* [n, n]; product [max(n, ROWS), n] */
  double *axes, *row, *pivot, value[6][7], theta[7];   /* of the sweep: [n, 3], [n, 7], [n] */
  int64_t bent_at;
} Scratch;

/* Newton's direction; along negative curvature, or where it would climb, that of the mirrored Hessian. */
static int direction(int64_t n, Scratch *s) {
  double *d = s->d, most = 0.0, curvature = 0.0;
  for (int64_t i = 0; i < n; i++) d[i] = 0.0;
  if (largest_of(s->down, n) == 0.0) return 1;
  memcpy(s->product, s->h, n * n * sizeof(double));
  int good = invert(s->product, n, n, s->vectors);
  if (good) {
    for (int64_t i = 0; i < n; i++) d[i] = -dot(s->vectors + i * n, s->down, n);
    for (int64_t i = 0; i < n; i++) curvature += d[i] * dot(s->h + i * n, d, n);
    most = largest_of(s->vectors, n * n);
    double square = dot(d, d, n);
    good = dot(d, s->down, n) < 0 && curvature > SINGULAR * square && sqrt(square) <= 10;
  }
  if (good && most <= 1 / SINGULAR) return 1;
  if (!all_finite(s->h, n, n)) return 0;
  memcpy(s->product, s->h, n * n * sizeof(double));
  eigen(s->product, n, n, s->vectors);
  for (int64_t i = 0; i < n; i++) d[i] = 0.0;
  for (int64_t j = 0; j < n; j++) {
    double part = 0.0;
    for (int64_t i = 0; i < n; i++) part += s->vectors[i * n + j] * s->down[i];
    /* |eigenvalues| in place of eigenvalues: always downhill (Nocedal and Wright, section 3.4) */
    part /= fmax(fabs(s->product[j * n + j]), LEAST_PIVOT);
    for (int64_t i = 0; i < n; i++) d[i] -= s->vectors[i * n + j] * part;
  }
  return 1;
}

/* The lowest eigenvalue of h; its eigenvector nearest to a fixed direction is written to `bent`. */
static double lowest(int64_t n, Scratch *s) {
  double least = INFINITY, most = 0.0, *v = s->bent;
  int64_t first = 0;
  memcpy(s->product, s->h, n * n * sizeof(double));
  eigen(s->product, n, n, s->vectors);
  for (int64_t j = 0; j < n; j++) {
    double value = s->product[j * n + j];
    if (value < least) least = value, first = j;
    most = fmax(most, fabs(value));
    v[j] = 0.0;
  }
  for (int64_t j = 0; j < n; j++) {
    if (s->product[j * n + j] > least + CHOSEN * most) continue;
    double part = 0.0;
    for (int64_t i = 0; i < n; i++) part += s->vectors[i * n + j] * cos(i + 1.0);
    for (int64_t i = 0; i < n; i++) v[i] += s->vectors[i * n + j] * part;
  }
  double length = sqrt(dot(v, v, n));
  for (int64_t i = 0; i < n; i++) v[i] = length > CHOSEN ? v[i] / length : s->vectors[i * n + first];
  return least;
}

/* -(a_j x lam) / 4 */
static void bend(const Scratch *s, const double *lam, int64_t j, double *out) {
  cross(s->axes + 3 * j, lam, out);
  for (int i = 0; i < 3; i++) out[i] *= -0.25;
}

/* What follows from the turn and the multipliers in theta, crease `start` moved by 1. */
static void forward(int64_t n, Scratch *s, int64_t start, double *d) {
  for (int64_t j = 0; j < n; j++) {
    d[j] = j == start ? 1.0 : -dot(s->row + 7 * j, s->theta, 7) / s->pivot[j];
    for (int i = 0; i < 3; i++) s->theta[i] += s->axes[3 * j + i] * d[j];
  }
}

/* Newton's direction by the backward recursion, which stays for `bent`. */
static void sweep(int64_t n, Scratch *s, const double *lam) {
  double largest = 0.0, stiff = fmax(1.0, largest_of(s->soft, n)), size = 0.0, b[3], w[9], inverse[9];
  for (int64_t j = 0; j < n; j++) largest = fmax(largest, dot3(s->axes + 3 * j, s->axes + 3 * j));
  memset(s->value, 0, sizeof s->value);
  for (int i = 0; i < 3; i++) {
    s->value[i][i] = (1 / fmax(largest, NONZERO) + largest_of(lam, 3)) * (STIFF * stiff);
    s->value[i][i + 3] = s->value[i + 3][i] = 1.0;
  }
  s->bent_at = -1;
  for (int64_t j = n - 1; j >= 0; j--) {
    const double *a = s->axes + 3 * j;
    double *row = s->row + 7 * j;
    for (int e = 0; e < 7; e++) row[e] = s->value[0][e] * a[0] + s->value[1][e] * a[1] + s->value[2][e] * a[2];
    double pivot = s->soft[j] + dot3(row, a);
    bend(s, lam, j, b);
    for (int i = 0; i < 3; i++) row[i] += b[i];
    row[6] += s->down[j];
    if (s->bent_at < 0 && pivot <= 0) s->bent_at = j;
    s->pivot[j] = fmax(fabs(pivot), LEAST_PIVOT);
    for (int i = 0; i < 6; i++) /* minimised over d_j: a Schur complement */
      for (int e = 0; e < 7; e++) s->value[i][e] -= row[i] * (row[e] / s->pivot[j]);
  }
  for (int i = 3; i < 6; i++) size = fmax(size, largest_of(s->value[i] + 3, 4));
  for (int i = 0; i < 3; i++)
    for (int e = 0; e < 3; e++) w[3 * i + e] = s->value[3 + i][3 + e] - (i == e ? 4 * EPS * size + NONZERO : 0.0);
  invert(w, 3, 3, inverse);
  for (int i = 0; i < 7; i++) s->theta[i] = i == 6;
  for (int i = 0; i < 3; i++)
    for (int e = 0; e < 3; e++) s->theta[3 + i] -= inverse[3 * i + e] * s->value[3 + e][6];
  forward(n, s, -1, s->d);
}

/* A unit direction of the stratum along which a pivot was not positive, to `bent`; the curvature along it. */
static double bent(int64_t n, Scratch *s, const Point *p, int64_t rows) {
  double *v = s->bent, along[ROWS], b[3], curvature = 1.0;
  if (s->bent_at < 0) return 1.0;
  memset(s->theta, 0, sizeof s->theta);
  forward(n, s, s->bent_at, v);
  /* what does not close is taken off, by the shortest way */
  for (int64_t e = 0; e < rows; e++) along[e] = dot(p->free + e * n, v, n);
  for (int64_t e = 0; e < rows; e++) {
    double part = dot(p->inverse + e * ROWS, along, rows);
    for (int64_t i = 0; i < n; i++) v[i] -= p->free[e * n + i] * part;
  }
  double size = sqrt(dot(v, v, n));
  if (size <= EPS) return 1.0;
  memset(s->theta, 0, sizeof s->theta);
  for (int64_t j = 0; j < n; j++) {
    v[j] /= fmax(size, NONZERO);
    bend(s, p->multipliers, j, b);
    curvature += 2 * v[j] * dot3(s->theta, b) + (s->soft[j] - 1) * v[j] * v[j];
    for (int i = 0; i < 3; i++) s->theta[i] += s->axes[3 * j + i] * v[j];
  }
  return curvature;
}
