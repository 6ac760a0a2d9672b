/* Supernodal Cholesky: numerical factorisation and triangular solves in parallel, for suitesparse_shim.c.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * CHOLMOD orders and analyses; its factor (rows of each supernode, positions of the entries) is computed and used here, because
 * CHOLMOD is parallel only by the threads of the BLAS, which gain nothing on small blocks and compete with those of OpenMP. Here
 * the elimination tree is distributed: each subtree to one thread, and the few supernodes above them to all threads together, each
 * with some of the rows. The BLAS always runs with one thread. The analysis fixes the distribution, so that the same number of
 * threads gives bitwise the same result.
 * Left-looking: E. Ng, B. Peyton, SIAM J. Sci. Comput. 14 (1993) 1034. It is C for the layout of cholmod_factor. */
#define _GNU_SOURCE
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include <cholmod.h>
#include "supernodes_shim.h"

enum { PANEL = 128, SLICE = 512, MAX_ABOVE = 256 };
static const double EVEN = 1.04; /* admissible ratio of the largest share of the subtrees to the mean */

extern void dsyrk_(const char *, const char *, const int *, const int *, const double *, const double *, const int *,
                   const double *, double *, const int *);
extern void dgemm_(const char *, const char *, const int *, const int *, const int *, const double *, const double *,
                   const int *, const double *, const int *, const double *, double *, const int *);
extern void dtrsm_(const char *, const char *, const char *, const char *, const int *, const int *, const double *,
                   const double *, const int *, double *, const int *);
extern void dpotrf_(const char *, const int *, double *, const int *, int *);
extern void dtrsv_(const char *, const char *, const char *, const int *, const double *, const int *, double *,
                   const int *);
extern void dgemv_(const char *, const int *, const int *, const double *, const double *, const int *, const double *,
                   const int *, const double *, double *, const int *);

extern void strsv_(const char *, const char *, const char *, const int *, const float *, const int *, float *, const int *);
extern void sgemv_(const char *, const int *, const int *, const float *, const float *, const int *, const float *,
                   const int *, const float *, float *, const int *);

static const double ONE = 1, MINUS = -1, ZERO = 0;
static const int STEP = 1;

/* The update of a supernode by its descendant `from`: rows of `from` from the `row`-th on. */
typedef struct {
  int from, row;
} update;

struct supernode_plan {
  int n_parts;            /* number of threads of the plan */
  int n_supernodes, n_above;
  int *first;             /* (n_supernodes + 1) updates of a supernode */
  update *updates;
  int *start, *members;   /* supernodes of each part, and last those above the parts, ascending */
  int *end;               /* (n_supernodes) first column behind the subtree in which it lies */
  int max_rows;          /* of a supernode */
  size_t max_update;     /* numbers of an update */
};

/* The storage of a supernode in the factor. */
typedef struct {
  int columns, rows, column;  /* number of columns and rows, first column */
  const int *row;
  double *x;                  /* rows x columns */
} node;

static node node_of(const cholmod_factor *l, int s)
{
  const int *super = l->super, *pi = l->pi, *px = l->px, *rows = l->s;
  return (node){super[s + 1] - super[s], pi[s + 1] - pi[s], super[s], rows + pi[s],
    l->x ? (double *)l->x + px[s] : NULL};
}

static int is_before(const cholmod_factor *l, int s, int limit)
{
  return ((const int *)l->super)[s] < limit;
}

void amontons_plan_free(supernode_plan *plan)
{
  if (!plan) return;
  free(plan->first);
  free(plan->updates);
  free(plan->start);
  free(plan->members);
  free(plan->end);
  free(plan);
}

/* The updates of each supernode by its descendants, in ascending order. */
static int list_updates(supernode_plan *plan, const cholmod_factor *l, const int *super_of)
{
  const int *super = l->super;
  int n = plan->n_supernodes;
  plan->first = calloc((size_t)n + 2, sizeof(int));
  if (!plan->first) return 0;
  for (int pass = 0; pass < 2; pass++) {
    for (int d = 0; d < n; d++) {
      node down = node_of(l, d);
      for (int k = down.columns; k < down.rows;) {
        int s = super_of[down.row[k]], begin = k;
        while (k < down.rows && down.row[k] < super[s + 1]) k++;
        if (pass == 0) plan->first[s + 2]++;
        else plan->updates[plan->first[s + 1]++] = (update){d, begin};
        size_t size = (size_t)(down.rows - begin) * (size_t)(k - begin);
        if (size > plan->max_update) plan->max_update = size;
      }
      if (down.rows > plan->max_rows) plan->max_rows = down.rows;
    }
    if (pass) break;
    for (int s = 0; s < n; s++) plan->first[s + 2] += plan->first[s + 1];
    plan->updates = malloc(((size_t)plan->first[n + 1] + 1) * sizeof(update));
    if (!plan->updates) return 0;
  }
  return 1;
}

/* Multiplications for each supernode, and for its subtree. */
static void weigh(const supernode_plan *plan, const cholmod_factor *l, const int *parent, double *subtree)
{
  for (int s = 0; s < plan->n_supernodes; s++) {
    node up = node_of(l, s);
    double c = up.columns, work = c * c * c / 3 + c * c * (up.rows - c) + 100 * c;
    for (int k = plan->first[s]; k < plan->first[s + 1]; k++) {
      node down = node_of(l, plan->updates[k].from);
      int m = down.rows - plan->updates[k].row, n = 0;
      while (n < m && down.row[plan->updates[k].row + n] < up.column + up.columns) n++;
      work += (double)down.columns * n * (m - n / 2.0) + 4.0 * n * m + 500;
    }
    subtree[s] += work;
    if (parent[s] >= 0) subtree[parent[s]] += subtree[s];
  }
}

/* Distributes the subtrees over the parts: the largest first, each to the part with the least work. Returns whether the parts are
 * balanced. */
static int share(const int *roots, int n_roots, const double *subtree, int n_parts, int *part_of, double *load)
{
  double sum = 0, most = 0;
  for (int p = 0; p < n_parts; p++) load[p] = 0;
  for (int k = 0; k < n_roots; k++) { /* the roots come in descending order */
    int least = 0;
    for (int p = 1; p < n_parts; p++)
      if (load[p] < load[least]) least = p;
    part_of[k] = least;
    load[least] += subtree[roots[k]];
    sum += subtree[roots[k]];
  }
  for (int p = 0; p < n_parts; p++) most = fmax(most, load[p]);
  return most * n_parts <= EVEN * sum;
}

static void insert(int *roots, int *n, int root, const double *subtree)
{
  int k = (*n)++;
  for (; k > 0 && subtree[roots[k - 1]] < subtree[root]; k--) roots[k] = roots[k - 1];
  roots[k] = root;
}

/* Cuts the tree: moves the root of the largest subtree above the parts, until the subtrees can be balanced. */
static void cut(supernode_plan *plan, const int *parent, const double *subtree, int *part, int *work, double *load)
{
  int n = plan->n_supernodes, n_roots = 0, *roots = work, *part_of = work + n, *child = work + 2 * n, *next = work + 3 * n;
  for (int s = 0; s < n; s++) child[s] = -1;
  for (int s = n - 1; s >= 0; s--) {
    part[s] = -2; /* not known yet */
    if (parent[s] < 0) { insert(roots, &n_roots, s, subtree); continue; }
    next[s] = child[parent[s]];
    child[parent[s]] = s;
  }
  while (!share(roots, n_roots, subtree, plan->n_parts, part_of, load) && plan->n_above < MAX_ABOVE) {
    int s = roots[0];
    if (child[s] < 0) break;
    n_roots--;
    memmove(roots, roots + 1, (size_t)n_roots * sizeof(int));
    part[s] = plan->n_parts;
    plan->n_above++;
    for (int c = child[s]; c >= 0; c = next[c]) insert(roots, &n_roots, c, subtree);
  }
  share(roots, n_roots, subtree, plan->n_parts, part_of, load);
  for (int k = 0; k < n_roots; k++) part[roots[k]] = part_of[k];
}

/* Lists the members of the parts; a subtree belongs to the part of its root. */
static int list_members(supernode_plan *plan, const cholmod_factor *l, const int *parent, int *part)
{
  const int *super = l->super;
  int n = plan->n_supernodes;
  plan->start = calloc((size_t)plan->n_parts + 3, sizeof(int));
  plan->members = malloc(((size_t)n + 1) * sizeof(int));
  plan->end = malloc(((size_t)n + 1) * sizeof(int));
  if (!plan->start || !plan->members || !plan->end) return 0;
  for (int s = n - 1; s >= 0; s--) {
    int is_root = part[s] != -2;
    plan->end[s] = is_root ? super[s + 1] : plan->end[parent[s]];
    if (!is_root) part[s] = part[parent[s]];
  }
  for (int s = 0; s < n; s++) plan->start[part[s] + 2]++;
  for (int p = 0; p <= plan->n_parts; p++) plan->start[p + 2] += plan->start[p + 1];
  for (int s = 0; s < n; s++) plan->members[plan->start[part[s] + 1]++] = s;
  return 1;
}

/* Creates the plan for a number of threads. NULL without memory. */
supernode_plan *amontons_plan_new(const cholmod_factor *l, int n_parts)
{
  const int *super = l->super;
  int n = (int)l->nsuper, is_done = 0;
  supernode_plan *plan = calloc(1, sizeof *plan);
  int *super_of = malloc((l->n + 1) * sizeof(int)), *parent = malloc(6 * ((size_t)n + 1) * sizeof(int));
  double *subtree = calloc((size_t)n + (size_t)n_parts + 1, sizeof(double));
  if (plan && super_of && parent && subtree) {
    plan->n_parts = n_parts;
    plan->n_supernodes = n;
    for (int s = 0; s < n; s++)
      for (int k = super[s]; k < super[s + 1]; k++) super_of[k] = s;
    for (int s = 0; s < n; s++) {
      node own = node_of(l, s);
      parent[s] = own.rows > own.columns ? super_of[own.row[own.columns]] : -1;
    }
    is_done = list_updates(plan, l, super_of);
    if (is_done) weigh(plan, l, parent, subtree);
    if (is_done) cut(plan, parent, subtree, parent + n, parent + 2 * (size_t)n, subtree + n);
    is_done = is_done && list_members(plan, l, parent, parent + n);
  }
  free(super_of);
  free(parent);
  free(subtree);
  if (!is_done) { amontons_plan_free(plan); plan = NULL; }
  return plan;
}

int amontons_plan_parts(const supernode_plan *plan)
{
  return plan->n_parts;
}

/* --- numerical factorisation --------------------------------------------------------------------------------------- */

/* The workspace of a thread. */
typedef struct {
  int *place;       /* (n) position of a row in the present supernode */
  int *relative;    /* positions of the rows of an update */
  double *product;  /* an update */
} bench;

static int bench_new(bench *self, const supernode_plan *plan, size_t n)
{
  self->place = malloc((n + 1) * sizeof(int));
  self->relative = malloc(((size_t)plan->max_rows + 1) * sizeof(int));
  self->product = malloc((plan->max_update + 1) * sizeof(double));
  return self->place && self->relative && self->product;
}

static void bench_free(bench *self)
{
  free(self->place);
  free(self->relative);
  free(self->product);
}

/* The entries of the matrix in the rows from low to high (exclusive) of a supernode; all else there is zero. */
static void take_entries(const cholmod_sparse *a, const node *up, bench *work, int low, int high)
{
  const int *p = a->p, *i = a->i;
  const double *x = a->x;
  for (int k = 0; k < up->rows; k++) work->place[up->row[k]] = k;
  for (int c = 0; c < up->columns; c++) {
    double *column = up->x + (size_t)c * (size_t)up->rows;
    memset(column + low, 0, (size_t)(high - low) * sizeof(double));
    for (int k = p[up->column + c]; k < p[up->column + c + 1]; k++) {
      int r = work->place[i[k]];
      if (r >= low && r < high) column[r] += x[k];
    }
  }
}

/* Subtracts the update by another supernode, in the rows from low to high (exclusive) of this one. */
static void subtract_update(const cholmod_factor *l, const node *up, update from, bench *work, int low, int high)
{
  node down = node_of(l, from.from);
  const int *row = down.row + from.row, end = up->column + up->columns;
  const double *x = down.x + from.row;
  int m = down.rows - from.row, n = 0, first = 0;
  while (n < m && row[n] < end) n++;
  for (int k = 0; k < m; k++) work->relative[k] = work->place[row[k]];
  while (first < m && work->relative[first] < low) first++;
  while (m > first && work->relative[m - 1] >= high) m--;
  if (first >= m) return;
  if (n > m) n = m;                            /* columns right of the last row are above the diagonal */
  int square = first == 0 ? n : 0, rest = m - first - square, ld = m - first;
  const int is_dense = work->relative[m - 1] - work->relative[0] == m - 1; /* rows, and so the columns, are contiguous */
  double *c = work->product;
  const double *beta = is_dense ? &ONE : &ZERO;
  if (is_dense) {
    ld = up->rows;
    c = up->x + work->relative[first] + (size_t)work->relative[0] * (size_t)ld;
  }
  if (square > 0) dsyrk_("L", "N", &square, &down.columns, &MINUS, x, &down.rows, beta, c, &ld);
  if (rest > 0)
    dgemm_("N", "T", &rest, &n, &down.columns, &MINUS, x + first + square, &down.rows, x, &down.rows, beta, c + square, &ld);
  if (is_dense) return;
  for (int j = 0; j < n; j++) {
    double *column = up->x + (size_t)work->relative[j] * (size_t)up->rows;
    const double *product = c + (size_t)j * (size_t)ld - first;
    for (int k = j > first ? j : first; k < m; k++) column[work->relative[k]] += product[k];
  }
}

/* Factorises one supernode by one thread. Returns the column in which it failed, from 1; 0: success. */
static int factorise_alone(const supernode_plan *plan, const cholmod_sparse *a, const cholmod_factor *l, int s, bench *work)
{
  node up = node_of(l, s);
  int info, below = up.rows - up.columns;
  take_entries(a, &up, work, 0, up.rows);
  for (int k = plan->first[s]; k < plan->first[s + 1]; k++) subtract_update(l, &up, plan->updates[k], work, 0, up.rows);
  dpotrf_("L", &up.columns, up.x, &up.rows, &info);
  if (info != 0) return up.column + info;
  if (below > 0)
    dtrsm_("R", "L", "T", "N", &below, &up.columns, &ONE, up.x, &up.rows, up.x + up.columns, &up.rows);
  return 0;
}

/* The share of a thread of the range from low to high. */
static int cut_at(int low, int high, int id, int team)
{
  int whole = (high - low) / team * id + (high - low) % team * id / team;
  return id == team ? high : low + (whole & ~7);
}

/* The partition of the rows of a trapezoid into shares of equal area. */
static int cut_area(const node *up, int id, int team)
{
  double c = up->columns, all = c * c / 2 + c * (up->rows - c), area = all * id / team;
  if (id == team) return up->rows;
  return (int)(area <= c * c / 2 ? sqrt(2 * area) : c + (area - c * c / 2) / c) & ~7;
}

/* Factorises one supernode by all threads of a team: to be called by each of them. */
static void factorise_together(const supernode_plan *plan, const cholmod_sparse *a, const cholmod_factor *l, int s,
                               bench *work, int id, int team, int *broken)
{
  node up = node_of(l, s);
  int low = cut_area(&up, id, team), high = cut_area(&up, id + 1, team), ld = up.rows;
  take_entries(a, &up, work, low, high);
  for (int k = plan->first[s]; k < plan->first[s + 1]; k++) subtract_update(l, &up, plan->updates[k], work, low, high);
  for (int c = 0; c < up.columns; c += PANEL) {
    int width = up.columns - c < PANEL ? up.columns - c : PANEL, end = c + width, info = 0;
    double *panel = up.x + (size_t)c * (size_t)ld;
#pragma omp barrier
    int from = cut_at(c, up.rows, id, team), rows = cut_at(c, up.rows, id + 1, team) - from;
    if (c > 0 && rows > 0)
      dgemm_("N", "T", &rows, &width, &c, &MINUS, up.x + from, &ld, up.x + c, &ld, &ONE, panel + from, &ld);
#pragma omp barrier
    if (id == 0) dpotrf_("L", &width, panel + c, &ld, &info);
    if (info != 0 && *broken == 0) *broken = up.column + c + info;
#pragma omp barrier
    if (*broken) return;
    from = cut_at(end, up.rows, id, team);
    rows = cut_at(end, up.rows, id + 1, team) - from;
    if (rows > 0) dtrsm_("R", "L", "T", "N", &rows, &width, &ONE, panel + c, &ld, panel + from, &ld);
  }
#pragma omp barrier
}

/* Starts a thread: its number, the number of threads, and whether the allocation of any thread failed. */
static void join_team(int has_slot, int *id, int *team, int *is_poor)
{
  *id = 0;
  *team = 1;
#ifdef _OPENMP
  *id = omp_get_thread_num();
  *team = omp_get_num_threads();
#endif
  if (!has_slot) {
#pragma omp atomic write
    *is_poor = 1;
  }
#pragma omp barrier
}

/* Factorises a matrix: lower triangle, permuted, packed. Returns the column in which it failed, from 1; 0: success; -1: no
 * memory. */
int amontons_plan_factorise(const supernode_plan *plan, const cholmod_sparse *a, cholmod_factor *l)
{
  int broken = 0, is_poor = 0;
#pragma omp parallel num_threads(plan->n_parts)
  {
    int id, team, own = 0;
    bench work;
    join_team(bench_new(&work, plan, l->n), &id, &team, &is_poor);
    for (int p = id; p < plan->n_parts && !is_poor; p += team)
      for (int k = plan->start[p]; k < plan->start[p + 1]; k++) {
        int at = factorise_alone(plan, a, l, plan->members[k], &work);
        if (at != 0 && (own == 0 || at < own)) own = at;
        if (at != 0) break;
      }
#pragma omp critical(amontons_broken)
    if (own != 0 && (broken == 0 || own < broken)) broken = own;
#pragma omp barrier
    for (int k = plan->start[plan->n_parts]; k < plan->n_supernodes && !broken && !is_poor; k++) {
      factorise_together(plan, a, l, plan->members[k], &work, id, team, &broken);
#pragma omp barrier
    }
    bench_free(&work);
  }
  return is_poor ? -1 : broken;
}

/* --- solves -------------------------------------------------------------------------------------------------------- */

/* Applies `what` to each column of the supernodes above the parts. */
#define EACH_ABOVE(c)                                                               \
  for (int k_ = plan->start[plan->n_parts]; k_ < plan->n_supernodes; k_++)          \
    for (int c = node_of(l, plan->members[k_]).column, end_ = c + node_of(l, plan->members[k_]).columns; c < end_; c++)

#define REAL double
#define KIND(name) name
#define TRSV dtrsv_
#define GEMV dgemv_
#include "supernodes_solve.h"
#undef REAL
#undef KIND
#undef TRSV
#undef GEMV

#define REAL float
#define KIND(name) name##_single
#define TRSV strsv_
#define GEMV sgemv_
#include "supernodes_solve.h"
