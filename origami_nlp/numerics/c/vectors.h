/* Of vectors of n numbers. */

/* Of long vectors four sums side by side, as none of them waits for another; always in this order. */
static double dot(const double *a, const double *b, int64_t n) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0}, total = 0.0;
  int64_t i = 0;
  if (n >= 8) {
    for (; i + 4 <= n; i += 4)
      for (int k = 0; k < 4; k++) sum[k] += a[i + k] * b[i + k];
    total = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }
  for (; i < n; i++) total += a[i] * b[i];
  return total;
}

static double largest(const double *a, int64_t n) { /* absolute; nan where there is one */
  double most = 0.0;
  for (int64_t i = 0; i < n; i++)
    if (fabs(a[i]) > most || isnan(a[i])) most = fabs(a[i]);
  return most;
}
