/* Which creases coincide, which lie on facets, and how segments turn around nodes: `layers._arranged_in_numpy`. */

static void cross3(const double *a, const double *b, double *out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Put a number at a place in order of its angle; equal ones as they came. */
static void insert(int64_t *list, double *angle, int64_t count, int64_t v, double at) {
    int64_t k = count;
    for (; k > 0 && angle[k - 1] > at; k--) {
        list[k] = list[k - 1];
        angle[k] = angle[k - 1];
    }
    list[k] = v;
    angle[k] = at;
}

/* Neighbours of node w, ascending or, three or more, counter-clockwise from the least: how many. */
static int64_t turning(int64_t n, const double *c, int64_t w, const uint8_t *next, double *angle, int64_t *list) {
    const double axis[2][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    double x[3], y[3];
    cross3(c + 3 * w, axis[!(fabs(c[3 * w]) < 0.9)], x);
    cross3(c + 3 * w, x, y);
    int64_t count = 0, least, first;
    for (int64_t v = 0; v < n; v++)
        if (next[w * n + v]) list[count++] = v;
    if (count < 3) return count;
    least = list[0];
    count = 0;
    for (int64_t v = least; v < n; v++)
        if (next[w * n + v]) insert(list, angle, count++, v, atan2(dot3(c + 3 * v, y), dot3(c + 3 * v, x)));
    while ((first = list[0]) != least) { /* where it begins says nothing */
        memmove(list, list + 1, (count - 1) * sizeof *list);
        list[count - 1] = first;
    }
    return count;
}

/* Write for each arc how many nodes it has and which, then for each node its number and its neighbours, as many first.
   Work: angle [n], node [n], next [n, n], all 0.  Returns how much was written; 0 where nothing touches. */
int64_t arrange(
    int64_t n, const double *c, double tolerance, double *angle, int64_t *node, uint8_t *next, int64_t *out) {
    int64_t used = 0, apart = 1;
    for (int64_t i = 0; i < n; i++) node[i] = i;
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = i + 1; j < n; j++) {
            double d[3] = {c[3 * i] - c[3 * j], c[3 * i + 1] - c[3 * j + 1], c[3 * i + 2] - c[3 * j + 2]};
            if (sqrt(dot3(d, d)) > tolerance) continue;
            int64_t old = node[j], new = node[i];
            for (int64_t k = 0; k < n; k++)
                if (node[k] == old) node[k] = new;
            apart = 0;
        }
    for (int64_t i = 0; i < n; i++) {
        const double *a = c + 3 * i, *b = c + 3 * ((i + 1) % n);
        int64_t u = node[i], v = node[(i + 1) % n], *path = out + used + 1, count = 0;
        double normal[3], turned[3];
        cross3(a, b, normal);
        double sine = sqrt(dot3(normal, normal)), length = atan2(sine, dot3(a, b));
        for (int k = 0; k < 3; k++) normal[k] /= sine;
        cross3(normal, a, turned);
        path[0] = u;
        for (int64_t w = 0; w < n; w++) {
            const double *at = c + 3 * w;
            if (node[w] != w || w == u || w == v || !(fabs(dot3(normal, at)) <= tolerance)) continue;
            double along = atan2(dot3(turned, at), dot3(a, at));
            if (along > 0 && along < length) insert(path + 1, angle, count++, w, along);
        }
        path[count + 1] = v;
        if (count) apart = 0;
        for (int64_t k = 0; k <= count; k++) next[path[k] * n + path[k + 1]] = next[path[k + 1] * n + path[k]] = 1;
        out[used] = count + 2;
        used += count + 3;
    }
    if (apart) return 0;
    for (int64_t w = 0; w < n; w++) {
        if (node[w] != w) continue;
        int64_t count = turning(n, c, w, next, angle, out + used + 2);
        out[used] = count;
        out[used + 1] = w;
        used += count + 2;
    }
    return used;
}
