/* Nonnegative least squares, as `linear.py` has them: the same steps, with the factors of Gram and Schmidt, twice, in
   place of singular values.  0 is returned where columns all but depend on each other. */

/* Q [k, t] and R [k, k] of k columns a [., t] by number. */
static int factorise(int64_t t, int64_t k, const double *a, const int64_t *which, double *q, double *r) {
  if (k > t) return 0;
  memset(r, 0, k * k * sizeof(double));
  for (int64_t j = 0; j < k; j++) {
    double *v = q + j * t;
    memcpy(v, a + which[j] * t, t * sizeof(double));
    double before = sqrt(dot(v, v, t));
    for (int again = 0; again < 2; again++)
      for (int64_t i = 0; i < j; i++) {
        double part = dot(q + i * t, v, t);
        r[i * k + j] += part;
        for (int64_t e = 0; e < t; e++) v[e] -= part * q[i * t + e];
      }
    double size = sqrt(dot(v, v, t));
    if (!(size > RANK * before)) return 0;
    r[j * k + j] = size;
    for (int64_t e = 0; e < t; e++) v[e] /= size;
  }
  return 1;
}

/* Minimise |sum mu_k a_k - c| over mu >= 0, of r columns a [r, t]; free [3 r]; work [2 r t + r r + 2 r + 2 t]. */
int64_t nonnegative(int64_t t, int64_t r, const double *a, const double *c, double *mu, int64_t *free, double *work) {
  double most = largest(a, r * t), size = largest(c, t);
  double *b = work, *q = b + r * t, *tri = q + r * t, *trial = tri + r * r, *pull = trial + r, *right = pull + r, *left = right + t;
  int64_t *barred = free + r, *which = barred + r;
  memset(mu, 0, r * sizeof(double));
  if (!isfinite(most) || !isfinite(size)) return 0;
  if (most == 0.0 || size == 0.0) return 1;
  for (int64_t i = 0; i < r * t; i++) b[i] = a[i] / most;
  for (int64_t i = 0; i < t; i++) right[i] = c[i] / size;
  memset(free, 0, 2 * r * sizeof(int64_t));
  for (int64_t times = 0; times < 10 * r + 10; times++) {
    int64_t new = -1, k;
    memcpy(left, right, t * sizeof(double));
    for (int64_t i = 0; i < r; i++)
      for (int64_t e = 0; mu[i] != 0.0 && e < t; e++) left[e] -= mu[i] * b[i * t + e];
    for (int64_t i = 0; i < r; i++) {
      if (free[i] || barred[i]) continue;
      pull[i] = dot(b + i * t, left, t);
      if (new < 0 || pull[i] > pull[new]) new = i;
    }
    if (new < 0 || pull[new] <= ROUNDED) break;
    free[new] = 1;
    for (;;) {
      double share = INFINITY, top = 0.0;
      int64_t first = -1, left_out = 0;
      k = 0;
      for (int64_t i = 0; i < r; i++)
        if (free[i]) which[k++] = i;
      if (!factorise(t, k, b, which, q, tri)) return 0;
      for (int64_t j = k - 1; j >= 0; j--) {
        double x = dot(q + j * t, right, t);
        for (int64_t i = j + 1; i < k; i++) x -= tri[j * k + i] * trial[which[i]];
        trial[which[j]] = x / tri[j * k + j];
      }
      for (int64_t j = 0; j < k; j++) { /* towards the trial until the first entry vanishes */
        int64_t i = which[j];
        if (trial[i] > 0) continue;
        double part = mu[i] / fmax(mu[i] - trial[i], NONZERO);
        if (part < share) share = part, first = i;
      }
      if (first < 0) {
        for (int64_t j = 0; j < k; j++) mu[which[j]] = trial[which[j]];
        break;
      }
      for (int64_t j = 0; j < k; j++) mu[which[j]] += share * (trial[which[j]] - mu[which[j]]);
      top = largest(mu, r);
      for (int64_t j = 0; j < k; j++) {
        int64_t i = which[j];
        if (trial[i] <= 0 && mu[i] <= ROUNDED * top) mu[i] = 0.0;
        if (!(mu[i] > 0)) free[i] = 0, left_out++;
      }
      if (!left_out) free[first] = 0;
    }
    if (free[new])
      memset(barred, 0, r * sizeof(int64_t));
    else
      barred[new] = 1;
  }
  for (int64_t i = 0; i < r; i++) mu[i] *= size / most;
  return 1;
}
