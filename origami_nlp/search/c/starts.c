/* Where descents begin: creases brought to their limits, features that face each other brought together; and all ways
   down of some starts, one after the other. */

/* Turn the crease that is bent most by a whole turn to its other side, if its limits allow: the other lift of a shape. */
static int turn_over(const Sheet *s, double *x) {
  int64_t most = -1;
  for (int64_t i = 0; i < s->n; i++)
    if (s->high[i] - s->low[i] >= 2 * TURN && (most < 0 || fabs(x[i]) > fabs(x[most]))) most = i;
  if (most >= 0) x[most] -= x[most] > 0 ? TURN : -TURN;
  return most >= 0;
}

/* Close x with creases held at their limits; where that fails they go there in steps, each of which closes: so loops
   stay on the lift of paper. */
static int fold(Descent *t, double *x, const int64_t *side) {
  const Sheet *s = t->s;
  int64_t n = s->n, any = 0;
  unsigned char *fixed = t->held->fixed;
  double from[n];
  memcpy(from, x, n * sizeof(double));
  for (int64_t i = 0; i < n; i++) {
    any |= fixed[i] = side[i] != 0;
    if (side[i]) x[i] = side[i] > 0 ? s->high[i] : s->low[i];
  }
  if (retract(t, x, MOST_CLOSING) || (!any && turn_over(s, x) && retract(t, x, MOST_CLOSING))) return 1;
  memcpy(x, from, n * sizeof(double));
  memset(fixed, 0, n);
  if (!any || !retract(t, x, MOST_CLOSING)) return 0;
  for (int left = FOLDING; left > 0; left--) {
    for (int64_t i = 0; i < n; i++)
      if (side[i]) fixed[i] = 1, x[i] += ((side[i] > 0 ? s->high[i] : s->low[i]) - x[i]) / left;
    if (!retract(t, x, MOST_CLOSING)) return 0;
  }
  return 1;
}

/* Bring features together: of those that face each other at x the one of a rank by gap, or the last; 0 where none
   closes without facets that cross. */
static int touch(Descent *t, double *x, int64_t rank) {
  const Sheet *s = t->s;
  Held *held = t->held;
  int64_t q = s->q, many = 0, place[2 * q * q], one[5 * (rank + 1)];
  double found[3 * q * q], gap[rank + 1];
  Pieces p;
  carry(s, x, &t->low);
  carry_pieces(s, &t->low);
  look_at(s, t->low.x, &p);
  for (int64_t k = 0; k < s->pairs; k++)
    for (int way = 0; way < 3; way++) {
      int64_t a = way == 1 ? s->other[k] : s->one[k], b = way == 1 ? s->one[k] : s->other[k];
      int64_t count = features(s, &p, k, way, s->reach, 0.0, place, found);
      for (int64_t f = 0; f < count; f++) {
        if (!(found[3 * f + 1] > TOUCHES)) continue;
        int64_t at = many;
        while (at && gap[at - 1] > found[3 * f + 1] + TIE) at--;
        if (at > rank) continue;
        for (int64_t c = many < rank ? many : rank; c > at; c--) gap[c] = gap[c - 1], memcpy(one + 5 * c, one + 5 * c - 5, 5 * sizeof(int64_t));
        int64_t what[5] = {a, place[2 * f], b, place[2 * f + 1], found[3 * f] > 0 ? 1 : -1};
        gap[at] = found[3 * f + 1], memcpy(one + 5 * at, what, sizeof(what));
        many += many <= rank;
      }
    }
  if (!many) return 0;
  const int64_t *w = one + 5 * ((rank < many ? rank : many - 1));
  int64_t e = hold_on(s, held, w[0], w[1], w[2], w[3], w[4]);
  if (e < 0) return 0;
  for (int64_t c = 0; c < held->many; c++) held->equal[c] = 1;
  for (int64_t i = 0; i < s->n; i++) held->fixed[i] = held->side[i] != 0;
  memcpy(t->trial, x, s->n * sizeof(double));
  if (!retract(t, t->trial, MOST_CLOSING) || crosses(t, t->trial, &t->there)) {
    let_go(s, held, e);
    return 0;
  }
  memcpy(x, t->trial, s->n * sizeof(double));
  come_to_limits(s, x, held->side);
  return 1;
}

/* Hold the gaps that a start gives, each by piece, place, piece, place or -1, or by points: facet that stays, and is
   carried, two sides; whether it orders layers. */
static void hold_given(const Sheet *s, Held *held, int64_t slots, const int64_t *given, const double *at, const double *signs) {
  for (int64_t e = 0; e < slots; e++) {
    const int64_t *g = given + 8 * e;
    int64_t was = held->many;
    if (g[0] >= 0) {
      was = hold_on(s, held, g[0], g[1], g[2], g[3], signs[e]);
    } else if (held->many < SLOTS) {
      int64_t stays = g[4], goes = g[5], two = g[6];
      int64_t by[4] = {two ? stays : goes, stays, two ? goes : stays, two ? goes : stays};
      held->first[was] = stays, held->second[was] = goes, held->sides[was] = two, held->sign[was] = signs[e];
      memcpy(held->owner + 4 * was, by, sizeof(by));
      memcpy(held->point + 12 * was, at + 12 * e, 12 * sizeof(double));
      for (int c = 0; c < 4; c++) held->pieces[4 * was + c] = -1;
      for (int64_t c = 0; c < s->placed; c++)
        held->sense[s->placed * was + c] = s->walk[s->placed * goes + c] - s->walk[s->placed * stays + c];
      held->many++;
    }
    if (was >= 0 && was < held->many) held->until[was] = g[7];
  }
}

/* Go down from starts x [K, n] with sides [K, n]: `kind` [K] 0 as given, 1 held as given, 2 drawn, to be folded, with
   `picks` [K, PICKS] ranks of features to be brought together, less 1; `most` [K] steps, each as `longest`; of one start where they lead, path [most, n].  ends [K, 6]: status, steps,
   saddles, counted work, slots, whether what it began with was to be held; multipliers of limits and slots [K, n + SLOTS]; slots with pieces, places and signs. */
void descend(const Sheet *s, int64_t count, double *xs, int64_t *sides, const int64_t *kind, const int64_t *picks, const int64_t *most,
             int64_t pauses, double longest, double *path, const int64_t *slots, const int64_t *given, const double *at, const double *signs,
             const double *aside, double *room, int64_t *ints, double *begun, double *pulls, int64_t *pieces, double *sign, double *ends) {
  int64_t n = s->n, m = s->m, all = n + SLOTS, wide = m + SLOTS, f = s->facets;
  double *r = room;
#define TAKE(count) (r += (count), r - (count))
  int64_t *k = ints;
#define COUNT(count) (k += (count), k - (count))
  Held held = {0, sides, COUNT(4 * SLOTS), COUNT(SLOTS), COUNT(SLOTS), COUNT(SLOTS), pieces, COUNT(SLOTS),
               TAKE(12 * SLOTS), sign, TAKE(s->placed * SLOTS), (unsigned char *)COUNT(SLOTS), (unsigned char *)COUNT(n)};
  Factors closure = {0, 0, 0, TAKE(n * wide), TAKE(wide + n), TAKE(wide + n), TAKE(wide), TAKE(wide), COUNT(wide)};
  Factors rows = {0, 0, 0, TAKE(n * all), TAKE(all), TAKE(all), TAKE(all), TAKE(all), COUNT(all)};
  Factors step = {0, 0, 0, TAKE(n * (wide + SLOTS)), TAKE(wide + SLOTS), TAKE(wide + SLOTS), TAKE(wide + SLOTS), TAKE(wide + SLOTS), COUNT(wide + SLOTS)};
  int64_t q = 3 * s->q * s->pieces;
  Descent t = {s, {TAKE(9 * f), TAKE(3 * f), TAKE(q)}, {TAKE(9 * f), TAKE(3 * f), TAKE(q)}, {TAKE(9 * f), TAKE(3 * f), TAKE(q)},
               &held, &closure, &rows, &step, TAKE(m), TAKE(m * n), TAKE(SLOTS), TAKE(SLOTS * n), TAKE(n), TAKE(n * n),
               TAKE(all * n), TAKE(wide + n), TAKE(all), TAKE(m), TAKE(n * n), TAKE(2 * n * n), TAKE(n * n + all), TAKE(n),
               TAKE(n), TAKE(n), TAKE(n), TAKE((2 * n + all) * all + 2 * all + 6 * n), TAKE(SLOTS), TAKE(SLOTS * n),
               COUNT(3 * all), COUNT(all), (unsigned char *)COUNT(s->pairs), (unsigned char *)COUNT(3 * n + SLOTS), 0, longest, path};
  for (int64_t one = 0; one < count; one++, xs += n, sides += n, begun += n, aside += n, pulls += all, ends += 6) {
    int64_t steps = 0, saddles = 0, end = ARRIVED, hold = kind[one] > 0, *side = sides;
    held.many = 0, held.side = side, held.pieces = pieces + 4 * SLOTS * one, held.sign = sign + SLOTS * one;
    t.counted = 0;
    memset(t.mu, 0, all * sizeof(double));
    memset(t.added, 0, n);
    if (kind[one] == 2) {
      if (fold(&t, xs, side)) come_to_limits(s, xs, side);
      else end = OPEN;
      const int64_t *pick = picks + PICKS * one;
      int64_t brought = 0, wanted = 0;
      for (int c = 0; c < PICKS && pick[c] && end == ARRIVED && wanted == brought; c++, wanted++)
        for (int64_t rank = pick[c] - 1, met = 0; rank >= 0 && !met; rank--) brought += met = touch(&t, xs, rank);
      if (wanted && !brought) end = OPEN;
      hold = brought > 0;
      for (int64_t i = 0; i < n; i++) hold |= side[i] != 0;
    } else
      hold_given(s, &held, slots[one], given + 8 * SLOTS * one, at + 12 * SLOTS * one, signs + SLOTS * one);
    memcpy(begun, xs, n * sizeof(double));
    if (end == ARRIVED) end = go_down(&t, xs, hold, pauses, most[one], aside, begun, &steps, &saddles);
    int64_t folded = 0;
    for (int64_t i = 0; i < n && !kind[one]; i++) folded |= side[i] != 0, side[i] *= end != OPEN;
    if (end == OPEN && folded) { /* what is fully folded opens as it closes */
      memcpy(xs, begun, n * sizeof(double));
      end = go_down(&t, xs, hold, pauses, most[one], aside, begun, &steps, &saddles);
    }
    memset(pulls, 0, all * sizeof(double));
    if (end == ARRIVED) {
      int64_t many;
      survey(&t, xs, &many);
      for (int64_t i = 0; i < many; i++) pulls[t.which[i]] = t.mu[i] * (t.which[i] < n ? s->measure[t.which[i]] : 1.0);
    }
    ends[0] = end, ends[1] = steps, ends[2] = saddles, ends[3] = t.counted, ends[4] = held.many, ends[5] = hold;
  }
}
