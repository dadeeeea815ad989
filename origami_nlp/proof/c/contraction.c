/* Boxes contracted one by one: what `boxes` does with NumPy, in the same way but for the order of sums.

   Of the matrices Y nothing is trusted, so neither is it how they are solved for here; what is, the bounds, are sums of
   products as in `boxes`, of which its bound of rounding holds in any order. */

/* Where rows certainly differ from zero: |centre| over the sum of |slopes| and error, `room` for the rounding of that. */
void nonzero(int64_t rows, int64_t n, int64_t boxes, const double *centre, const double *slopes, const double *error,
             double room, uint8_t *out)
{
    double sum[LANES];
    for (int64_t r = 0; r < rows; r++)
        for (int64_t first = 0; first < boxes; first += LANES) {
            int some = boxes - first < LANES ? boxes - first : LANES;
            const double *e = error + r * boxes + first, *c = centre + r * boxes + first;
            for (int k = 0; k < some; k++) sum[k] = 0.0;
            for (int64_t v = 0; v < n; v++) {
                const double *s = slopes + (r * n + v) * boxes + first;
                for (int k = 0; k < some; k++) sum[k] += fabs(s[k]);
            }
            for (int k = 0; k < some; k++)
                out[r * boxes + first + k] = fabs(c[k]) > (sum[k] + e[k]) * room;
        }
}

/* Bounds of xi where c + a xi + e eta = 0, by a matrix y [n][rows], intersected with those that are known. */
static void bound(int64_t rows, int64_t n, double a[rows][n], const double *c, const double *e, double y[n][rows],
                  double margin, double *low, double *high)
{
    for (int64_t v = 0; v < n; v++) {
        double at = 0.0, spread = 0.0, total = 0.0;
        for (int64_t r = 0; r < rows; r++) {
            double size = fabs(y[v][r]), sum = fabs(c[r]) + e[r];
            for (int64_t j = 0; j < n; j++) sum += fabs(a[r][j]);
            at -= y[v][r] * c[r];
            spread += size * e[r];
            total += size * sum;
        }
        for (int64_t j = 0; j < n; j++) {
            double rest = 0.0;
            for (int64_t r = 0; r < rows; r++) rest -= y[v][r] * a[r][j];
            spread += fabs(v == j ? rest + 1.0 : rest);
        }
        spread += margin * (1.0 + total);
        low[v] = fmax(low[v], at - spread);
        high[v] = fmin(high[v], at + spread);
    }
}

/* y [n][rows] of the inverse of the most independent columns of rows first .. first + p - 1; 0 where these depend. */
static int inverse_of_pivots(int64_t rows, int64_t n, int64_t first, int64_t p, double a[rows][n], double y[n][rows])
{
    double rest[p][n], square[p][2 * p], volume = 1.0, det = 1.0;
    int64_t chosen[p];
    for (int64_t r = 0; r < p; r++)
        for (int64_t j = 0; j < n; j++) rest[r][j] = a[first + r][j];
    for (int64_t q = 0; q < p; q++) {  /* Gram and Schmidt with pivoting */
        double size[n], most = 0.0, norm = 0.0;
        for (int64_t j = 0; j < n; j++) {
            size[j] = 0.0;
            for (int64_t r = 0; r < p; r++) size[j] += rest[r][j] * rest[r][j];
            if (!(size[j] <= most)) most = size[j];
        }
        int64_t best = 0;
        while (best < n - 1 && !(size[best] >= most - (CHOSEN * most + ROUNDED))) best++;
        chosen[q] = best;
        double u[p];
        for (int64_t r = 0; r < p; r++) norm += rest[r][best] * rest[r][best];
        norm = fmax(sqrt(norm), NONZERO);
        for (int64_t r = 0; r < p; r++) u[r] = rest[r][best] / norm;
        for (int64_t j = 0; j < n; j++) {
            double along = 0.0;
            for (int64_t r = 0; r < p; r++) along += u[r] * rest[r][j];
            for (int64_t r = 0; r < p; r++) rest[r][j] -= u[r] * along;
        }
    }
    for (int64_t q = 0; q < p; q++) {
        double norm = 0.0;
        for (int64_t r = 0; r < p; r++) {
            square[r][q] = a[first + r][chosen[q]];
            square[r][p + q] = r == q;
            norm += square[r][q] * square[r][q];
        }
        volume *= sqrt(norm);
    }
    for (int64_t q = 0; q < p; q++) {  /* Gauss and Jordan, the largest entry of a column as pivot */
        int64_t best = q;
        for (int64_t r = q + 1; r < p; r++)
            if (fabs(square[r][q]) > fabs(square[best][q])) best = r;
        double pivot = square[best][q];
        det *= pivot;
        if (!(fabs(pivot) > 0.0)) return 0;
        for (int64_t j = 0; j < 2 * p; j++) {
            double kept = square[best][j];
            square[best][j] = square[q][j];
            square[q][j] = kept / pivot;
        }
        for (int64_t r = 0; r < p; r++)
            if (r != q) {
                double by = square[r][q];
                for (int64_t j = 0; j < 2 * p; j++) square[r][j] -= by * square[q][j];
            }
    }
    if (!(fabs(det) > DEPENDENT * volume)) return 0;
    memset(y, 0, n * rows * sizeof(double));
    for (int64_t q = 0; q < p; q++)
        for (int64_t r = 0; r < p; r++) y[chosen[q]][first + r] = square[q][p + r];
    return 1;
}

/* y [n][rows] of the least squares of all rows in the metric of their errors; a row |xi| <= 1 keeps it regular. */
static void least_squares(int64_t rows, int64_t n, double a[rows][n], const double *e, double y[n][rows])
{
    double normal[n][n], scale[rows];
    for (int64_t r = 0; r < rows; r++) {
        double most = 0.0;
        for (int64_t j = 0; j < n; j++) most = fmax(most, fabs(a[r][j]));
        scale[r] = fmax(e[r], EXACT * most) + TINY;
    }
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j <= i; j++) {
            double sum = i == j;
            for (int64_t r = 0; r < rows; r++) sum += (a[r][i] / scale[r]) * (a[r][j] / scale[r]);
            for (int64_t k = 0; k < j; k++) sum -= normal[i][k] * normal[j][k];
            normal[i][j] = i == j ? sqrt(sum) : sum / normal[j][j];  /* Cholesky */
        }
    for (int64_t r = 0; r < rows; r++) {
        double x[n];
        for (int64_t i = 0; i < n; i++) {
            double sum = a[r][i] / scale[r];
            for (int64_t k = 0; k < i; k++) sum -= normal[i][k] * x[k];
            x[i] = sum / normal[i][i];
        }
        for (int64_t i = n - 1; i >= 0; i--) {
            double sum = x[i];
            for (int64_t k = i + 1; k < n; k++) sum -= normal[k][i] * x[k];
            x[i] = sum / normal[i][i];
        }
        for (int64_t v = 0; v < n; v++) y[v][r] = x[v] / scale[r];
    }
}

/* Some boxes: bounds low, high [n][count] of xi, and where the pivots depend (the matrix of these is not tried). */
void contract(const int64_t *size, const int64_t *which, const double *centre, const double *slopes, const double *error,
              const double *more_centre, const double *more_slopes, const double *more_error, const uint8_t *asked,
              double *low, double *high, uint8_t *poor)
{
    const int64_t n = size[0], boxes = size[1], count = size[2], own = size[3], more = size[4], first = size[5],
                  p = size[6];
    for (int64_t i = 0; i < count; i++) {
        const int64_t k = which[i];
        double a[own + more][n], c[own + more], e[own + more], l[n], h[n];
        int64_t rows = 0;
        for (int64_t r = 0; r < own + more; r++) {
            const int64_t s = r < own ? r : r - own;
            if (r >= own && !asked[s * boxes + k]) continue;
            c[rows] = (r < own ? centre : more_centre)[s * boxes + k];
            e[rows] = (r < own ? error : more_error)[s * boxes + k];
            for (int64_t j = 0; j < n; j++) a[rows][j] = (r < own ? slopes : more_slopes)[(s * n + j) * boxes + k];
            rows++;
        }
        for (int64_t v = 0; v < n; v++) l[v] = -HUGE_VAL, h[v] = HUGE_VAL;
        {
            double y[n][own];
            poor[i] = !inverse_of_pivots(own, n, first, p, a, y);
            if (!poor[i]) bound(own, n, a, c, e, y, 4 * (own + n + 8) * UNIT, l, h);
        }
        {
            double y[n][rows];
            least_squares(rows, n, a, e, y);
            bound(rows, n, a, c, e, y, 4 * (own + more + n + 8) * UNIT, l, h);
        }
        for (int64_t v = 0; v < n; v++) low[v * count + i] = l[v], high[v * count + i] = h[v];
    }
}
