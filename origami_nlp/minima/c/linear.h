/* Small linear algebra: no LAPACK, so that answers depend on no kernel of it.  Matrices are row by row, `w` wide. */

static double largest_of(const double *a, int64_t n) { /* absolute; nan where there is one */
  double most = 0.0;
  for (int64_t i = 0; i < n; i++)
    if (fabs(a[i]) > most || isnan(a[i])) most = fabs(a[i]);
  return most;
}

static double dot(const double *a, const double *b, int64_t n) {
  double total = 0.0;
  for (int64_t i = 0; i < n; i++) total += a[i] * b[i];
  return total;
}

/* Where the largest entry stands; of several that are equal but for rounding the first (`numerics.first_largest`). */
static int64_t first_largest(const double *a, int64_t n) {
  double most = a[0];
  for (int64_t i = 1; i < n; i++)
    if (a[i] > most || isnan(a[i])) most = a[i];
  double near = isfinite(most) ? CHOSEN * fabs(most) + ROUNDED : 0.0;
  for (int64_t i = 0; i < n; i++)
    if (a[i] >= most - near) return i;
  return 0;
}

/* Round a row to a grid relative to its largest entry (`numerics.coarse`). */
static void coarse(double *a, int64_t n) {
  int exponent;
  frexp(largest_of(a, n), &exponent);
  double unit = ldexp(CHOSEN, exponent);
  for (int64_t i = 0; i < n; i++) a[i] = rint(a[i] / unit) * unit;
}

static int all_finite(const double *a, int64_t n, int64_t w) {
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++)
      if (!isfinite(a[i * w + j])) return 0;
  return 1;
}

/* Invert the leading block of a matrix (overwritten) by Gauss and Jordan with row pivots; 0 where it is singular. */
static int invert(double *a, int64_t n, int64_t w, double *out) {
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++) out[i * w + j] = i == j;
  for (int64_t k = 0; k < n; k++) {
    int64_t top = k;
    for (int64_t i = k + 1; i < n; i++)
      if (fabs(a[i * w + k]) > fabs(a[top * w + k])) top = i;
    double pivot = a[top * w + k];
    if (pivot == 0.0 || !isfinite(pivot)) return 0;
    if (top != k)
      for (int64_t j = 0; j < n; j++) {
        double t = a[k * w + j];
        a[k * w + j] = a[top * w + j], a[top * w + j] = t;
        t = out[k * w + j];
        out[k * w + j] = out[top * w + j], out[top * w + j] = t;
      }
    double over = 1.0 / pivot;
    for (int64_t j = 0; j < n; j++) a[k * w + j] *= over, out[k * w + j] *= over;
    for (int64_t i = 0; i < n; i++) {
      double f = a[i * w + k];
      if (i == k || f == 0.0) continue;
      for (int64_t j = 0; j < n; j++) a[i * w + j] -= f * a[k * w + j], out[i * w + j] -= f * out[k * w + j];
    }
  }
  return 1;
}

/* Diagonalise the leading block of a symmetric matrix by Jacobi's rotations (Golub and Van Loan, section 8.5):
   eigenvalues are left on its diagonal, unsorted, eigenvectors in the columns of v. */
static void eigen(double *a, int64_t n, int64_t w, double *v) {
  for (int64_t i = 0; i < n; i++)
    for (int64_t j = 0; j < n; j++) v[i * w + j] = i == j;
  for (int sweep = 0; sweep < 30; sweep++) { /* it converges quadratically, as a rule in six */
    double off = 0.0, total = 0.0;
    for (int64_t i = 0; i < n; i++) {
      total += a[i * w + i] * a[i * w + i];
      for (int64_t j = 0; j < i; j++) off += a[i * w + j] * a[i * w + j];
    }
    if (!(off > EPS * EPS / 16 * total + NONZERO)) return;
    for (int64_t p = 0; p < n; p++)
      for (int64_t q = p + 1; q < n; q++) {
        double apq = a[p * w + q];
        if (apq == 0.0) continue;
        double theta = (a[q * w + q] - a[p * w + p]) / (2.0 * apq);
        double t = 1.0 / (fabs(theta) + sqrt(theta * theta + 1.0));
        if (theta < 0) t = -t;
        double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
        for (int64_t k = 0; k < n; k++) {
          double x = a[k * w + p], y = a[k * w + q];
          a[k * w + p] = c * x - s * y, a[k * w + q] = s * x + c * y;
        }
        for (int64_t k = 0; k < n; k++) {
          double x = a[p * w + k], y = a[q * w + k];
          a[p * w + k] = c * x - s * y, a[q * w + k] = s * x + c * y;
          x = v[k * w + p], y = v[k * w + q];
          v[k * w + p] = c * x - s * y, v[k * w + q] = s * x + c * y;
        }
        a[p * w + q] = a[q * w + p] = 0.0;
      }
  }
}

/* The product of two square matrices. */
static void multiply(const double *a, const double *b, int64_t n, double *out) {
  for (int64_t i = 0; i < n; i++) {
    for (int64_t j = 0; j < n; j++) out[i * n + j] = 0.0;
    for (int64_t e = 0; e < n; e++) {
      double f = a[i * n + e];
      if (f == 0.0) continue;
      for (int64_t j = 0; j < n; j++) out[i * n + j] += f * b[e * n + j];
    }
  }
}
