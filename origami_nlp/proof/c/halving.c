/* What becomes of boxes once they were asked: as `boxes._contracted`, `_shrunk` and `_halves` without a tree, to the bit. */

typedef struct {
    int64_t n, columns;
    double *lower, *upper;
    int8_t *pins;
} Out;

/* Put a box into a column: whole (axis < 0), or cut at the middle of a side, the half below or above. */
static void put(const Out *out, int64_t to, const double *l, const double *u, const int8_t *pins, int64_t axis, int above)
{
    for (int64_t v = 0; v < out->n; v++) {
        const double middle = 0.5 * (l[v] + u[v]);
        out->lower[v * out->columns + to] = v == axis && above ? middle : l[v];
        out->upper[v * out->columns + to] = v == axis && !above ? middle : u[v];
        out->pins[v * out->columns + to] = pins[v];
    }
}

static int64_t widest(int64_t n, const double *l, const double *u, const int8_t *pins, double *width)
{
    int64_t axis = 0;
    *width = 0.0;
    for (int64_t v = 0; v < n; v++)
        if (!pins[v] && u[v] - l[v] > *width) *width = u[v] - l[v], axis = v;
    return axis;
}

static void take(int64_t n, int64_t columns, int64_t k, const double *lower, const double *upper, const int8_t *pins,
                 double *l, double *u, int8_t *p)
{
    for (int64_t v = 0; v < n; v++)
        l[v] = lower[v * columns + k], u[v] = upper[v * columns + k], p[v] = pins[v * columns + k];
}

/* Cut all boxes that are not small: those that are come first, then the halves below, then those above.  How many. */
int64_t halve(int64_t n, int64_t columns, double small, const double *lower, const double *upper, const int8_t *pins,
              int64_t room, double *new_lower, double *new_upper, int8_t *new_pins)
{
    const Out out = {n, room, new_lower, new_upper, new_pins};
    double l[n], u[n], width;
    int8_t p[n];
    int64_t narrow = 0, wide = 0, at[2] = {0, 0};
    for (int64_t k = 0; k < columns; k++) {
        take(n, columns, k, lower, upper, pins, l, u, p);
        widest(n, l, u, p, &width);
        if (width >= small) wide++;
        else narrow++;
    }
    for (int64_t k = 0; k < columns; k++) {
        take(n, columns, k, lower, upper, pins, l, u, p);
        const int64_t axis = widest(n, l, u, p, &width);
        if (width >= small) {
            put(&out, narrow + at[1], l, u, p, axis, 0);
            put(&out, narrow + wide + at[1]++, l, u, p, axis, 1);
        } else put(&out, at[0]++, l, u, p, -1, 0);
    }
    return wide ? narrow + 2 * wide : 0;
}

enum { EMPTY, SMALL, WHOLE, CUT };

/* Shrink a box to bounds of xi, where that gains something, and say what becomes of it. */
static int shrunk(int64_t n, double small, const double *low, const double *high, int64_t step, const int8_t *pins,
                  double *l, double *u)
{
    double new_l[n], new_u[n], least = 1.0, volume = 1.0, width;
    for (int64_t v = 0; v < n; v++) {
        const double middle = 0.5 * (l[v] + u[v]), reach = fmax(u[v] - middle, middle - l[v]);
        const double half = u[v] > l[v] ? nextafter(reach, HUGE_VAL) : 0.0, old = pins[v] ? 0.0 : u[v] - l[v];
        /* outward: down for lower bounds, up for upper ones */
        const double from = fmax(floor(low[v * step] / GRID - OFF) * GRID, -1.0);
        const double to = fmin(ceil(high[v * step] / GRID + OFF) * GRID, 1.0);
        if (from > to) return EMPTY;
        new_l[v] = l[v], new_u[v] = u[v];
        if (!pins[v] && from > -1.0) new_l[v] = fmax(l[v], nextafter(middle + half * (from - WIDER), -HUGE_VAL));
        if (!pins[v] && to < 1.0) new_u[v] = fmin(u[v], nextafter(middle + half * (to + WIDER), HUGE_VAL));
        const double share = old > 0 ? (new_u[v] - new_l[v]) / old : 1.0;
        volume *= share;
        if (share < least) least = share;
    }
    widest(n, l, u, pins, &width);
    const int done = width < small;
    if (least < KEPT) {
        memcpy(l, new_l, sizeof new_l);
        memcpy(u, new_u, sizeof new_u);
    } else volume = 1.0;
    if (done) return SMALL;
    widest(n, l, u, pins, &width);
    return volume >= 0.5 && width >= small ? CUT : WHOLE;
}

/* Those of the boxes that were not excluded, by bounds low, high [n][count] of xi: small ones first, then those that go on
   whole, then halves below, then halves above.  Kind: work [count].  Returns how many are small, and in all. */
void settle(int64_t n, int64_t columns, int64_t count, double small, const int64_t *which, double *lower, double *upper,
            const int8_t *pins, const double *low, const double *high, int8_t *kind, double *new_lower,
            double *new_upper, int8_t *new_pins, int64_t *out_counts)
{
    const Out out = {n, 2 * count, new_lower, new_upper, new_pins};
    double l[n], u[n], width;
    int8_t p[n];
    int64_t number[4] = {0, 0, 0, 0};
    for (int64_t i = 0; i < count; i++) {
        const int64_t k = which[i];
        take(n, columns, k, lower, upper, pins, l, u, p);
        kind[i] = (int8_t)shrunk(n, small, low + i, high + i, count, p, l, u);
        number[kind[i]]++;
        for (int64_t v = 0; v < n; v++) lower[v * columns + k] = l[v], upper[v * columns + k] = u[v];
    }
    int64_t at[4] = {0, 0, number[SMALL], number[SMALL] + number[WHOLE]};
    for (int64_t i = 0; i < count; i++) {
        const int64_t to = at[kind[i]]++;
        take(n, columns, which[i], lower, upper, pins, l, u, p);
        if (kind[i] == CUT) {
            const int64_t axis = widest(n, l, u, p, &width);
            put(&out, to, l, u, p, axis, 0);
            put(&out, to + number[CUT], l, u, p, axis, 1);
        } else if (kind[i] != EMPTY) put(&out, to, l, u, p, -1, 0);
    }
    out_counts[0] = number[SMALL];
    out_counts[1] = number[SMALL] + number[WHOLE] + 2 * number[CUT];
}
