/* Of vectors of n numbers. */

static double dot(const double *a, const double *b, int64_t n) {
  double total = 0.0;
  for (int64_t i = 0; i < n; i++) total += a[i] * b[i];
  return total;
}

static double largest(const double *a, int64_t n) { /* absolute; nan where there is one */
  double most = 0.0;
  for (int64_t i = 0; i < n; i++)
    if (fabs(a[i]) > most || isnan(a[i])) most = fabs(a[i]);
  return most;
}
