/* Orthogonal factors of a few vectors, and the spectrum of a small symmetric matrix. */

typedef struct {
  int64_t n, k, rank;
  double *a, *beta, *diagonal; /* columns [k, n], of which reflectors are below the diagonal */
  double *size, *known;        /* squares of what is left of each column, and as they were last computed */
  int64_t *order;              /* which column stands where */
} Factors;

/* A = Q R P' by Householder with pivots, in place; columns that are left below RANK of the longest are dependent. */
static void factor(Factors *f, int64_t n, int64_t k) {
  double first = 0.0;
  f->n = n, f->k = k, f->rank = 0;
  for (int64_t j = 0; j < k; j++) f->order[j] = j, f->size[j] = f->known[j] = dot(f->a + j * n, f->a + j * n, n);
  for (int64_t j = 0; j < k && j < n; j++) {
    int64_t best = j;
    double most = -1.0;
    for (int64_t c = j; c < k; c++)
      if (f->size[c] > most * (1 + TIE)) most = f->size[c], best = c;
    most = sqrt(dot(f->a + best * n + j, f->a + best * n + j, n - j));
    if (!j) first = most;
    if (!(most > RANK * first)) return;
    if (best != j) {
      int64_t was = f->order[j];
      f->order[j] = f->order[best], f->order[best] = was;
      f->size[best] = f->size[j], f->known[best] = f->known[j];
      for (int64_t i = 0; i < n; i++) {
        double value = f->a[j * n + i];
        f->a[j * n + i] = f->a[best * n + i], f->a[best * n + i] = value;
      }
    }
    double *v = f->a + j * n + j, top = v[0] > 0 ? -most : most;
    v[0] -= top;
    f->diagonal[j] = top, f->beta[j] = 2.0 / dot(v, v, n - j), f->rank++;
    for (int64_t c = j + 1; c < k; c++) {
      double *restrict to = f->a + c * n + j, by = f->beta[j] * dot(v, to, n - j);
      if (by == 0.0) continue; /* of loops apart */
      for (int64_t i = 0; i < n - j; i++) to[i] -= by * v[i];
      f->size[c] -= to[0] * to[0];
      if (f->size[c] < LEFT * f->known[c]) f->size[c] = f->known[c] = dot(to + 1, to + 1, n - j - 1);
    }
  }
}

static void reflect(const Factors *f, int64_t j, double *x) {
  const double *v = f->a + j * f->n + j;
  double by = f->beta[j] * dot(v, x + j, f->n - j);
  for (int64_t i = 0; i < f->n - j; i++) x[j + i] -= by * v[i];
}

/* Q x and Q' x, in place. */
static void turn_by(const Factors *f, double *x) {
  for (int64_t j = f->rank - 1; j >= 0; j--) reflect(f, j, x);
}

static void turn_back(const Factors *f, double *x) {
  for (int64_t j = 0; j < f->rank; j++) reflect(f, j, x);
}

/* The shortest x with A' x = b, of columns that are independent; x [n]. */
static void shortest(const Factors *f, const double *b, double *x) {
  memset(x, 0, f->n * sizeof(double));
  for (int64_t j = 0; j < f->rank; j++) {
    double sum = b[f->order[j]];
    for (int64_t i = 0; i < j; i++) sum -= f->a[j * f->n + i] * x[i];
    x[j] = sum / f->diagonal[j];
  }
  turn_by(f, x);
}

/* Multipliers y [k] with A y nearest to b [n]; those of dependent columns are 0. */
static void nearest(const Factors *f, const double *b, double *y, double *work) {
  memcpy(work, b, f->n * sizeof(double));
  turn_back(f, work);
  memset(y, 0, f->k * sizeof(double));
  for (int64_t j = f->rank - 1; j >= 0; j--) {
    double sum = work[j];
    for (int64_t i = j + 1; i < f->rank; i++) sum -= f->a[i * f->n + j] * y[f->order[i]];
    y[f->order[j]] = sum / f->diagonal[j];
  }
}

/* Basis of what all columns are orthogonal to, [n - rank, n]. */
static void complement(const Factors *f, double *z) {
  for (int64_t j = f->rank; j < f->n; j++, z += f->n) {
    memset(z, 0, f->n * sizeof(double));
    z[j] = 1.0;
    turn_by(f, z);
  }
}

/* Eigenvalues, on the diagonal of a [t, t] at the end, and vectors, rows of v, by Jacobi's rotations. */
static void spectrum(int64_t t, double *a, double *v) {
  memset(v, 0, t * t * sizeof(double));
  for (int64_t i = 0; i < t; i++) v[i * t + i] = 1.0;
  for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    double off = 0.0, on = 0.0;
    for (int64_t i = 0; i < t; i++)
      for (int64_t j = 0; j < t; j++) *(i == j ? &on : &off) += a[i * t + j] * a[i * t + j];
    if (off <= EPS * EPS * on) break;
    for (int64_t p = 0; p < t; p++)
      for (int64_t q = p + 1; q < t; q++) {
        double b = a[p * t + q], d = a[q * t + q] - a[p * t + p];
        if (b == 0.0) continue;
        double h = d / (2 * b), tan = (h < 0 ? -1.0 : 1.0) / (fabs(h) + sqrt(1 + h * h));
        double co = 1 / sqrt(1 + tan * tan), si = tan * co;
        for (int64_t i = 0; i < t; i++) {
          double x = a[i * t + p], y = a[i * t + q];
          a[i * t + p] = co * x - si * y, a[i * t + q] = si * x + co * y;
        }
        for (int64_t i = 0; i < t; i++) {
          double x = a[p * t + i], y = a[q * t + i], z = v[p * t + i], w = v[q * t + i];
          a[p * t + i] = co * x - si * y, a[q * t + i] = si * x + co * y;
          v[p * t + i] = co * z - si * w, v[q * t + i] = si * z + co * w;
        }
      }
  }
}

/* Solve a x = b of a positive definite matrix [n, n] by its Cholesky factor, which takes its place; 0 where a pivot is no more than `least`. */
static int solve_positive(int64_t n, double *a, double *b, double least) {
  for (int64_t k = 0; k < n; k++) {
    double pivot = a[n * k + k] - dot(a + n * k, a + n * k, k);
    if (!(pivot > least)) return 0;
    pivot = a[n * k + k] = sqrt(pivot);
    for (int64_t i = k + 1; i < n; i++) a[n * i + k] = (a[n * i + k] - dot(a + n * i, a + n * k, k)) / pivot;
  }
  for (int64_t k = 0; k < n; k++) b[k] = (b[k] - dot(a + n * k, b, k)) / a[n * k + k];
  for (int64_t k = n - 1; k >= 0; k--) {
    for (int64_t i = k + 1; i < n; i++) b[k] -= a[n * i + k] * b[i];
    b[k] /= a[n * k + k];
  }
  return 1;
}
