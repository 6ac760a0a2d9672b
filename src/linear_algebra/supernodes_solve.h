/* Supernodal triangular solves with a factor whose entries have the type REAL; supernodes_shim.c includes this file for each type.
 * KIND(name) is the name for that type; TRSV and GEMV are its procedures of the BLAS.
 * SPDX-License-Identifier: GPL-3.0-or-later */

static const REAL KIND(PLUS) = 1, KIND(LESS) = -1, KIND(NONE) = 0;

/* The entries of a supernode. */
static const REAL *KIND(numbers_of)(const cholmod_factor *l, int s)
{
  return (const REAL *)l->x + ((const int *)l->px)[s];
}

/* x = inv(L) x for the lower triangle of a supernode, four columns at a time: twice as fast as TRSV of OpenBLAS on narrow ones. */
static void KIND(solve_triangle)(int n, const REAL *l, int ld, REAL *x)
{
  int j = 0;
  for (; j + 4 <= n; j += 4) {
    const REAL *a = l + (size_t)j * (size_t)ld, *b = a + ld, *c = b + ld, *d = c + ld;
    REAL p = x[j] / a[j], q = (x[j + 1] - a[j + 1] * p) / b[j + 1], r = (x[j + 2] - a[j + 2] * p - b[j + 2] * q) / c[j + 2],
         s = (x[j + 3] - a[j + 3] * p - b[j + 3] * q - c[j + 3] * r) / d[j + 3];
    x[j] = p; x[j + 1] = q; x[j + 2] = r; x[j + 3] = s;
#pragma omp simd
    for (int i = j + 4; i < n; i++) x[i] -= a[i] * p + b[i] * q + c[i] * r + d[i] * s;
  }
  for (; j < n; j++) {
    const REAL *a = l + (size_t)j * (size_t)ld;
    x[j] /= a[j];
    for (int i = j + 1; i < n; i++) x[i] -= a[i] * x[j];
  }
}

/* x = inv(L_ss) x for one supernode, and its update of the rows below: of x within the subtree, of `above` beyond. */
static void KIND(forward_alone)(const cholmod_factor *l, int s, int end, REAL *x, REAL *above, REAL *product)
{
  node up = node_of(l, s);
  const REAL *numbers = KIND(numbers_of)(l, s);
  int below = up.rows - up.columns;
  const int *row = up.row + up.columns;
  KIND(solve_triangle)(up.columns, numbers, up.rows, x + up.column);
  if (below == 0) return;
  GEMV("N", &below, &up.columns, &KIND(PLUS), numbers + up.columns, &up.rows, x + up.column, &STEP, &KIND(NONE), product, &STEP);
  int k = 0;
  for (; k < below && row[k] < end; k++) x[row[k]] -= product[k];
  for (; k < below; k++) above[row[k]] -= product[k];
}

static void KIND(backward_alone)(const cholmod_factor *l, int s, REAL *x, REAL *gathered)
{
  node up = node_of(l, s);
  const REAL *numbers = KIND(numbers_of)(l, s);
  int below = up.rows - up.columns;
  const int *row = up.row + up.columns;
  for (int k = 0; k < below; k++) gathered[k] = x[row[k]];
  if (below > 0)
    GEMV("T", &below, &up.columns, &KIND(LESS), numbers + up.columns, &up.rows, gathered, &STEP, &KIND(PLUS), x + up.column, &STEP);
  TRSV("L", "T", "N", &up.columns, numbers, &up.rows, x + up.column, &STEP);
}

/* The same by all threads of a team. */
static void KIND(forward_together)(const cholmod_factor *l, int s, REAL *x, REAL *product, int id, int team)
{
  node up = node_of(l, s);
  const REAL *numbers = KIND(numbers_of)(l, s);
  for (int c = 0; c < up.columns; c += SLICE) {
    int width = up.columns - c < SLICE ? up.columns - c : SLICE, end = c + width;
    const REAL *panel = numbers + (size_t)c * (size_t)up.rows;
    if (id == 0) KIND(solve_triangle)(width, panel + c, up.rows, x + up.column + c);
#pragma omp barrier
    int from = cut_at(end, up.rows, id, team), rows = cut_at(end, up.rows, id + 1, team) - from;
    if (rows > 0) {
      GEMV("N", &rows, &width, &KIND(PLUS), panel + from, &up.rows, x + up.column + c, &STEP, &KIND(NONE), product, &STEP);
      for (int k = 0; k < rows; k++) x[up.row[from + k]] -= product[k];
    }
#pragma omp barrier
  }
}

static void KIND(backward_together)(const cholmod_factor *l, int s, REAL *x, REAL *gathered, int id, int team)
{
  node up = node_of(l, s);
  const REAL *numbers = KIND(numbers_of)(l, s);
  for (int c = (up.columns - 1) / SLICE * SLICE; c >= 0; c -= SLICE) {
    int width = up.columns - c < SLICE ? up.columns - c : SLICE, end = c + width, below = up.rows - end;
    const REAL *panel = numbers + (size_t)c * (size_t)up.rows;
    int from = cut_at(0, width, id, team), columns = cut_at(0, width, id + 1, team) - from;
    if (below > 0 && columns > 0) {
      for (int k = 0; k < below; k++) gathered[k] = x[up.row[end + k]];
      GEMV("T", &below, &columns, &KIND(LESS), panel + (size_t)from * (size_t)up.rows + end, &up.rows, gathered, &STEP, &KIND(PLUS),
             x + up.column + c + from, &STEP);
    }
#pragma omp barrier
    if (id == 0) TRSV("L", "T", "N", &width, panel + c, &up.rows, x + up.column + c, &STEP);
#pragma omp barrier
  }
}

/* x = inv(L) x in the order of elimination, by the supernodes before a column alone. Returns 0 without memory. */
int KIND(amontons_plan_forward)(const supernode_plan *plan, const cholmod_factor *l, int limit, REAL *x)
{
  int n_parts = plan->n_parts, is_poor = 0;
  size_t capacity = plan->n_above > 0 ? l->n : 1;
  REAL *above = malloc((size_t)n_parts * capacity * sizeof(REAL));
  if (!above) return 0;
#pragma omp parallel num_threads(n_parts)
  {
    int id, team;
    REAL *product = malloc(((size_t)plan->max_rows + 1) * sizeof(REAL));
    join_team(product != NULL, &id, &team, &is_poor);
    for (int p = id; p < n_parts && !is_poor; p += team) {
      REAL *mine = above + (size_t)p * capacity;
      EACH_ABOVE(c) mine[c] = 0;
      for (int k = plan->start[p]; k < plan->start[p + 1] && is_before(l, plan->members[k], limit); k++)
        KIND(forward_alone)(l, plan->members[k], plan->end[plan->members[k]], x, mine, product);
    }
#pragma omp barrier
#pragma omp master
    if (!is_poor)
      EACH_ABOVE(c)
        for (int p = 0; p < n_parts; p++) x[c] += above[(size_t)p * capacity + (size_t)c];
#pragma omp barrier
    for (int k = plan->start[n_parts]; k < plan->n_supernodes && is_before(l, plan->members[k], limit) && !is_poor; k++)
      KIND(forward_together)(l, plan->members[k], x, product, id, team);
    free(product);
  }
  free(above);
  return !is_poor;
}

/* x = inv(L') x in the order of elimination, by the supernodes before a column alone: behind it x is known. Returns 0 without memory. */
int KIND(amontons_plan_backward)(const supernode_plan *plan, const cholmod_factor *l, int limit, REAL *x)
{
  int n_parts = plan->n_parts, is_poor = 0;
#pragma omp parallel num_threads(n_parts)
  {
    int id, team;
    REAL *gathered = malloc(((size_t)plan->max_rows + 1) * sizeof(REAL));
    join_team(gathered != NULL, &id, &team, &is_poor);
    for (int k = plan->n_supernodes - 1; k >= plan->start[n_parts] && !is_poor; k--)
      if (is_before(l, plan->members[k], limit)) KIND(backward_together)(l, plan->members[k], x, gathered, id, team);
    for (int p = id; p < n_parts && !is_poor; p += team)
      for (int k = plan->start[p + 1] - 1; k >= plan->start[p]; k--)
        if (is_before(l, plan->members[k], limit)) KIND(backward_alone)(l, plan->members[k], x, gathered);
    free(gathered);
  }
  return !is_poor;
}
