/* Hinge laws: energies that are quartic piece by piece, in place of linear springs (`problem.hinge_laws`). */

/* The piece of a law on which a fold angle is: where it begins, and the energy from (phi - begin)^4 to 1. */
static const double *piece_at(const Lawed *v, int64_t law, double phi) {
  const int64_t *at = v->law_at + 4 * law, last = at[1] - 1;
  const double *piece = v->law_piece + 6 * at[0], *grid = v->law_grid + 3 * law;
  int64_t k = 0;
  if (phi >= grid[1]) k = last;
  else if (phi >= grid[0]) { /* cells of equal width say where to begin; a cell may hold several pieces */
    int64_t cell = (int64_t)((phi - grid[0]) * grid[2]);
    k = v->law_cell[at[2] + (cell < at[3] ? cell : at[3] - 1)];
    while (k < last && phi >= piece[6 * (k + 1)]) k++;
    while (k > 0 && phi < piece[6 * k]) k--;
  }
  return piece + 6 * k;
}

static double law_energy(const Lawed *v, const double *x) {
  double total = 0.0;
  for (int64_t i = 0; i < v->n; i++) {
    if (v->law[i] < 0) continue;
    const double turn = x[i] - v->law_shift[i], *c = piece_at(v, v->law[i], turn), h = turn - c[0];
    total += v->law_weight[i] * ((((c[1] * h + c[2]) * h + c[3]) * h + c[4]) * h + c[5]);
  }
  return total;
}

/* Add the torques of laws, and write the stiffness of each hinge over the measure of it, 1 for springs. */
static void add_laws(const Lawed *v, const double *x, const double *root, double *torque, double *soft) {
  for (int64_t i = 0; i < v->n; i++) {
    soft[i] = 1.0;
    if (!v->laws || v->law[i] < 0) continue;
    const double turn = x[i] - v->law_shift[i], *c = piece_at(v, v->law[i], turn), h = turn - c[0];
    const double weight = v->law_weight[i];
    torque[i] += weight * (((4 * c[1] * h + 3 * c[2]) * h + 2 * c[3]) * h + c[4]);
    soft[i] = weight * ((12 * c[1] * h + 6 * c[2]) * h + 2 * c[3]) / (root[i] * root[i]);
  }
}
