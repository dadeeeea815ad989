/* Runs straight-line programs over many boxes: one operation after the other, each for LANES boxes at once.

   Every operation is one sum, product, ... of doubles, rounded once (FLAGS: nothing is fused), as NumPy makes them. */

static void one(int64_t code, double *restrict to, const double *a, const double *b, int lanes)
{
#define ALL(value) for (int k = 0; k < lanes; k++) to[k] = value; return
    switch (code) {
    case ADD: ALL(a[k] + b[k]);
    case SUB: ALL(a[k] - b[k]);
    case MUL: ALL(a[k] * b[k]);
    case NEG: ALL(-a[k]);
    case ABS: ALL(fabs(a[k]));
    case DIV: ALL(a[k] / b[k]);
    case ROOT: ALL(sqrt(a[k]));
    case MOST: ALL(a[k] > b[k] ? a[k] : b[k]);
    case AT_MOST: ALL(a[k] <= b[k] ? 1.0 : 0.0);
    }
#undef ALL
}

/* ops [count][4]: code, where to, and of what; in [rows][boxes], out likewise; slots [slots][LANES], constants set */
void run(int64_t count, const int32_t *ops, double *slots, const double *in, double *out, int64_t boxes)
{
    for (int64_t first = 0; first < boxes; first += LANES) {
        int some = boxes - first < LANES ? boxes - first : LANES;
        for (int64_t i = 0; i < count; i++) {
            const int32_t *op = ops + 4 * i;
            double *to = slots + (int64_t)op[1] * LANES;
            if (op[0] == LOAD) {
                const double *from = in + op[2] * boxes + first;
                memcpy(to, from, some * sizeof(double));
            } else if (op[0] == STORE)
                memcpy(out + op[1] * boxes + first, slots + (int64_t)op[2] * LANES, some * sizeof(double));
            else
                one(op[0], to, slots + (int64_t)op[2] * LANES, slots + (int64_t)op[3] * LANES, some);
        }
    }
}
