/* SuiteSparse shim: CHOLMOD and UMFPACK behind opaque handles, for factorization.f90.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * It is C because the layout of cholmod_common and cholmod_factor belongs to their C headers and changes with them
 * (doc/developer/decisions/0001). It keeps no static data: all state lives in the handle. Indices count from 0 here.
 * Two things are switched off around the library calls: floating-point traps, because the libraries make NaN and
 * infinities on purpose; and OpenMP, because CHOLMOD spreads its copy loops over four threads whatever the machine has,
 * which fight with the threads of the BLAS (measured: two to ten times slower on two cores). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include <cholmod.h>
#include <umfpack.h>
#include "supernodes_shim.h"

enum { MAX_COLUMNS = 512 }; /* of a supernode */
enum { HUGE_PAGE = 2097152 }; /* huge pages of the operating system, requested for large allocations */
static const double WORTH_THREADS = 3.0e7; /* operations of a factorisation */

/* The status codes of factorization.f90. */
enum { DONE = 0, NOT_POSITIVE = 1, NEARLY_SINGULAR = 2, NOT_FINITE = 3, NO_MEMORY = 4, TOO_LARGE = 5, INVALID = 6 };

typedef struct {
  cholmod_common common;
  cholmod_factor *factor;
  supernode_plan *plan;     /* distribution of the supernodes over the threads */
  int is_single;            /* the entries are in single precision */
  double *value;            /* the entries of the factor: owned by the handle, so that they outlive an analysis */
  size_t capacity;          /* of value */
  cholmod_sparse *permuted; /* lower triangle of P A P', the diagonal entry first in each column */
  int *target;              /* position in permuted of an entry of the caller's matrix */
  size_t n_entries;         /* of the caller's matrix */
} cholesky;

typedef struct {
  int n;
  int *first, *column; /* the matrix by compressed rows: to UMFPACK the columns of its transpose */
  double *value;
  void *symbolic, *numeric;
  int *work_i;
  double *work_x;
} lu;

/* The settings that are disabled around a library call. */
typedef struct {
  fenv_t environment;
  int levels;
} quiet;

static void begin_quiet(quiet *before)
{
  feholdexcept(&before->environment);
#ifdef _OPENMP
  before->levels = omp_get_max_active_levels();
  omp_set_max_active_levels(0);
#endif
}

static void end_quiet(const quiet *before)
{
#ifdef _OPENMP
  omp_set_max_active_levels(before->levels);
#endif
  fesetenv(&before->environment);
}

static int status_of_cholmod(int status)
{
  switch (status) {
  case CHOLMOD_OK: return DONE;
  case CHOLMOD_NOT_POSDEF: return NOT_POSITIVE;
  case CHOLMOD_OUT_OF_MEMORY: return NO_MEMORY;
  case CHOLMOD_TOO_LARGE: return TOO_LARGE;
  default: return INVALID;
  }
}

static int status_of_umfpack(int status)
{
  switch (status) {
  case UMFPACK_OK: return DONE;
  case UMFPACK_WARNING_singular_matrix: return NEARLY_SINGULAR;
  case UMFPACK_ERROR_out_of_memory: return NO_MEMORY;
  default: return INVALID;
  }
}

static int all_finite(const double *value, size_t n)
{
  for (size_t k = 0; k < n; k++)
    if (!isfinite(value[k])) return 0;
  return 1;
}

/* A new handle of a Cholesky factor; NULL without memory. */
void *amontons_cholesky_new(void)
{
  cholesky *self = calloc(1, sizeof *self);
  if (!self) return NULL;
  cholmod_common *c = &self->common;
  if (!cholmod_start(c)) { free(self); return NULL; }
  c->print = 0;
  c->error_handler = NULL;
  c->nmethods = 1;
  c->supernodal = CHOLMOD_SUPERNODAL;
  c->quick_return_if_not_posdef = 1;
  return self;
}

static void forget_matrix(cholesky *self)
{
  cholmod_common *c = &self->common;
  if (self->factor) self->factor->x = NULL;
  amontons_plan_free(self->plan);
  self->plan = NULL;
  cholmod_free_factor(&self->factor, c);
  cholmod_free_sparse(&self->permuted, c);
  self->target = cholmod_free(self->n_entries, sizeof(int), self->target, c);
}

void amontons_cholesky_free(void *handle)
{
  cholesky *self = handle;
  if (!self) return;
  forget_matrix(self);
  cholmod_finish(&self->common);
  free(self->value);
  free(self);
}

/* Builds the pattern of tril(P A P') and the position of each entry of A in it: new values then need one pass. */
static int permute_pattern(cholesky *self, int n, int *first, int *column)
{
  cholmod_common *c = &self->common;
  const int *order = self->factor->Perm;
  self->permuted = cholmod_allocate_sparse(n, n, first[n], 0, 1, -1, CHOLMOD_PATTERN, c);
  self->target = cholmod_malloc(first[n], sizeof(int), c);
  int *place = cholmod_malloc(n, sizeof(int), c), *next = cholmod_calloc(n, sizeof(int), c);
  self->n_entries = first[n];
  if (self->permuted && self->target && place && next) {
    int *p = self->permuted->p, *i = self->permuted->i;
    for (int k = 0; k < n; k++) place[order[k]] = k;
    for (int row = 0; row < n; row++)
      for (int k = first[row]; k < first[row + 1]; k++) {
        int a = place[row], b = place[column[k]];
        next[a < b ? a : b]++;
      }
    p[0] = 0;
    for (int k = 0; k < n; k++) {
      p[k + 1] = p[k] + next[k];
      next[k] = p[k] + 1; /* p[k] itself is for the diagonal */
    }
    for (int row = 0; row < n; row++)
      for (int k = first[row]; k < first[row + 1]; k++) {
        int a = place[row], b = place[column[k]], low = a < b ? a : b;
        self->target[k] = a == b ? p[a] : next[low]++;
        i[self->target[k]] = a < b ? b : a;
      }
  }
  cholmod_free(n, sizeof(int), place, c);
  cholmod_free(n, sizeof(int), next, c);
  return c->status;
}

/* Columns of the panels into which a supernode is cut: of equal size, and not too many. */
static size_t panel_width(size_t columns)
{
  size_t n = (columns + MAX_COLUMNS - 1) / MAX_COLUMNS;
  return (columns + n - 1) / n;
}

/* The first column behind a panel that begins at `first`: of at most `width` columns, and not across the border. */
static int panel_end(int first, size_t width, int end, int border)
{
  int last = first + (int)width < end ? first + (int)width : end;
  return first < border && border < last ? border : last;
}

/* Cuts supernodes of many columns, and one with columns on both sides of the border, into panels, each with the rows from its own
 * first column on, so that little memory is wasted above the diagonal of a block. */
static int cut_supernodes(cholmod_factor *l, int border, cholmod_common *c)
{
  const int *super = l->super, *pi = l->pi, *rows = l->s;
  size_t n = 0, n_rows = 0, n_numbers = 0, n_old = l->nsuper + 1, k = 0;
  for (size_t s = 0; s < l->nsuper; s++) {
    size_t width = panel_width((size_t)(super[s + 1] - super[s])), length = (size_t)(pi[s + 1] - pi[s]);
    for (int first = super[s], end; first < super[s + 1]; first = end) {
      end = panel_end(first, width, super[s + 1], border);
      n++;
      n_rows += length - (size_t)(first - super[s]);
      n_numbers += (length - (size_t)(first - super[s])) * (size_t)(end - first);
    }
  }
  if (n == l->nsuper) return 1;
  int *super_new = cholmod_malloc(n + 1, sizeof(int), c), *pi_new = cholmod_malloc(n + 1, sizeof(int), c);
  int *px_new = cholmod_malloc(n + 1, sizeof(int), c), *rows_new = cholmod_malloc(n_rows, sizeof(int), c);
  int is_done = super_new && pi_new && px_new && rows_new;
  if (is_done) pi_new[0] = px_new[0] = super_new[0] = 0;
  for (size_t s = 0; s < l->nsuper && is_done; s++) {
    size_t width = panel_width((size_t)(super[s + 1] - super[s]));
    int length = pi[s + 1] - pi[s];
    for (int first = super[s], end; first < super[s + 1]; first = end, k++) {
      int before = first - super[s];
      end = panel_end(first, width, super[s + 1], border);
      memcpy(rows_new + pi_new[k], rows + pi[s] + before, (size_t)(length - before) * sizeof(int));
      super_new[k + 1] = end;
      pi_new[k + 1] = pi_new[k] + length - before;
      px_new[k + 1] = px_new[k] + (length - before) * (end - first);
    }
  }
  if (!is_done) {
    cholmod_free(n + 1, sizeof(int), super_new, c);
    cholmod_free(n + 1, sizeof(int), pi_new, c);
    cholmod_free(n + 1, sizeof(int), px_new, c);
    cholmod_free(n_rows, sizeof(int), rows_new, c);
    return 0;
  }
  cholmod_free(n_old, sizeof(int), l->super, c);
  cholmod_free(n_old, sizeof(int), l->pi, c);
  cholmod_free(n_old, sizeof(int), l->px, c);
  cholmod_free(l->ssize, sizeof(int), l->s, c);
  l->super = super_new;
  l->pi = pi_new;
  l->px = px_new;
  l->s = rows_new;
  l->nsuper = n;
  l->ssize = n_rows;
  l->xsize = n_numbers;
  return 1;
}

/* Threads for a factorisation of so many operations. */
static int threads_worth(double operations)
{
#ifdef _OPENMP
  if (operations > WORTH_THREADS) return omp_get_max_threads();
#endif
  return 1;
}

/* Orders and analyses a symmetric matrix: upper triangle by rows, every diagonal entry present. Without a permutation
 * (NULL) METIS orders the unknowns. The last n_last of the order are in supernodes of their own. Statistics: entries of L;
 * multiplications and additions; bytes needed for factor, permuted matrix and work; supernodes. */
int amontons_cholesky_analyse(void *handle, int n, int *first, int *column, int *permutation, int n_last, double statistics[4])
{
  cholesky *self = handle;
  cholmod_common *c = &self->common;
  quiet before;
  begin_quiet(&before);
  forget_matrix(self);
  cholmod_sparse matrix = {.nrow = n, .ncol = n, .nzmax = first[n], .p = first, .i = column, .stype = -1,
    .itype = CHOLMOD_INT, .xtype = CHOLMOD_PATTERN, .dtype = CHOLMOD_DOUBLE, .sorted = 1, .packed = 1};
  c->method[0].ordering = permutation ? CHOLMOD_GIVEN : CHOLMOD_METIS;
  self->factor = cholmod_analyze_p(&matrix, permutation, NULL, 0, c);
  if (self->factor && c->status == CHOLMOD_OK) cut_supernodes(self->factor, n - n_last, c);
  if (self->factor && c->status == CHOLMOD_OK) permute_pattern(self, n, first, column);
  if (self->factor && c->status == CHOLMOD_OK) {
    const cholmod_factor *l = self->factor;
    statistics[0] = c->lnz;
    statistics[1] = c->fl;
    statistics[2] = 8.0 * l->xsize + 4.0 * l->ssize + 8.0 * l->maxcsize * threads_worth(c->fl) + 16.0 * first[n] + 60.0 * n;
    statistics[3] = l->nsuper;
  }
  end_quiet(&before);
  if (!self->factor && c->status == CHOLMOD_OK) return INVALID;
  if (c->status == CHOLMOD_OK) self->plan = amontons_plan_new(self->factor, threads_worth(c->fl));
  if (c->status == CHOLMOD_OK && !self->plan) return NO_MEMORY;
  return status_of_cholmod(c->status);
}

/* Allocates the entries of the factor. The memory of an earlier analysis is reused if it is large enough: new memory makes a
 * factorisation up to 1.5 times as slow, because of page faults. */
static int reserve_workspace(cholesky *self)
{
  cholmod_factor *l = self->factor;
  if (self->capacity < l->xsize) {
    free(self->value);
    self->value = NULL;
    self->capacity = l->xsize + l->xsize / 16;
    size_t bytes = (self->capacity * sizeof(double) + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    if (posix_memalign((void **)&self->value, HUGE_PAGE, bytes) != 0) self->value = NULL;
    if (!self->value) self->capacity = 0;
#ifdef MADV_HUGEPAGE
    if (self->value && bytes >= 8 * HUGE_PAGE) madvise(self->value, bytes, MADV_HUGEPAGE);
#endif
  }
  self->is_single = 0;
  l->x = self->value;
  l->xtype = self->value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  return self->value != NULL;
}

/* The smallest ratio of a squared pivot to its diagonal entry, and its unknown. */
static double smallest_pivot(const cholesky *self, int *unknown)
{
  const cholmod_factor *l = self->factor;
  const int *super = l->super, *pi = l->pi, *px = l->px, *first = self->permuted->p, *order = l->Perm;
  const double *x = l->x, *a = self->permuted->x;
  double smallest = INFINITY;
  for (size_t s = 0; s < l->nsuper; s++)
    for (int k = super[s]; k < super[s + 1]; k++) {
      double pivot = x[px[s] + (size_t)(k - super[s]) * (size_t)(pi[s + 1] - pi[s] + 1)];
      double ratio = pivot * pivot / a[first[k]];
      if (ratio >= smallest) continue;
      smallest = ratio;
      *unknown = order[k];
      if (isnan(ratio)) return ratio;
    }
  return smallest;
}

/* Factorises new values in the pattern analysed and keeps the memory. A shift (or NULL) is added to the diagonal.
 * `unknown` is where it failed, or has the smallest pivot; `ratio` is that pivot's square over its diagonal entry. */
int amontons_cholesky_factorise(void *handle, const double *value, const double *shift, int *unknown, double *ratio)
{
  cholesky *self = handle;
  cholmod_factor *l = self->factor;
  const int n = (int)l->n, *first = self->permuted->p, *order = l->Perm;
  double *x = malloc(self->n_entries * sizeof *x);
  *ratio = 0;
  *unknown = -1;
  if (!x) return NO_MEMORY;
  for (size_t k = 0; k < self->n_entries; k++) x[self->target[k]] = value[k];
  if (shift)
    for (int k = 0; k < n; k++) x[first[k]] += shift[order[k]];
  int is_finite = all_finite(x, self->n_entries);
  if (!is_finite || !reserve_workspace(self)) {
    free(x);
    return is_finite ? NO_MEMORY : NOT_FINITE;
  }
  self->permuted->x = x; /* for this factorisation only: the memory is reused afterwards */
  self->permuted->xtype = CHOLMOD_REAL;
  fenv_t environment;
  feholdexcept(&environment);
  int broken = amontons_plan_factorise(self->plan, self->permuted, l);
  if (broken == 0) *ratio = smallest_pivot(self, unknown);
  if (broken > 0) *unknown = order[broken - 1];
  fesetenv(&environment);
  self->permuted->x = NULL;
  self->permuted->xtype = CHOLMOD_PATTERN;
  free(x);
  return broken < 0 ? NO_MEMORY : broken > 0 ? NOT_POSITIVE : DONE;
}

/* Rounds the entries of the factor to single precision: half the memory, and half the time of a solve. The next factorisation has
 * double precision again. */
void amontons_cholesky_round(void *handle)
{
  cholesky *self = handle;
  char *bytes = (char *)self->value;
  const size_t n = self->factor->xsize;
  for (size_t k = 0; k < n; k++) { /* in place: a number is read before anything is written over it */
    double number;
    memcpy(&number, bytes + k * sizeof number, sizeof number);
    float rounded = (float)number;
    memcpy(bytes + k * sizeof rounded, &rounded, sizeof rounded);
  }
  char *smaller = realloc(self->value, (n / 2 + 1) * sizeof(double));
  if (smaller) self->value = (double *)smaller;
  if (smaller) self->capacity = n / 2 + 1;
  self->factor->x = self->value;
  self->is_single = 1;
}

/* One solve with a factor in single precision; b is scaled, to avoid underflow. */
static int solve_single(cholesky *self, const double *b, double *x)
{
  const size_t n = self->factor->n;
  const int *order = self->factor->Perm;
  double largest = 0;
  float *permuted = malloc((n + 1) * sizeof *permuted);
  if (!permuted) return 0;
  for (size_t k = 0; k < n; k++) largest = fmax(largest, fabs(b[k]));
  if (!(largest > 0)) largest = 1;
  for (size_t k = 0; k < n; k++) permuted[k] = (float)(b[order[k]] / largest);
  int is_done = amontons_plan_forward_single(self->plan, self->factor, (int)self->factor->n, permuted) &&
                amontons_plan_backward_single(self->plan, self->factor, (int)self->factor->n, permuted);
  for (size_t k = 0; k < n; k++) x[order[k]] = largest * permuted[k];
  free(permuted);
  return is_done;
}

/* Solves A X = B for n_columns right-hand sides, one after the other. */
int amontons_cholesky_solve(void *handle, int n_columns, const double *b, double *x)
{
  cholesky *self = handle;
  const size_t n = self->factor->n;
  const int *order = self->factor->Perm;
  if (self->is_single) {
    int is_solved = 1;
    for (int c = 0; c < n_columns && is_solved; c++) is_solved = solve_single(self, b + c * n, x + c * n);
    return is_solved ? DONE : NO_MEMORY;
  }
  double *permuted = malloc((n + 1) * sizeof *permuted);
  int is_done = permuted != NULL;
  for (int c = 0; c < n_columns && is_done; c++, b += n, x += n) {
    for (size_t k = 0; k < n; k++) permuted[k] = b[order[k]];
    is_done = amontons_plan_forward(self->plan, self->factor, (int)self->factor->n, permuted) &&
              amontons_plan_backward(self->plan, self->factor, (int)self->factor->n, permuted);
    for (size_t k = 0; k < n; k++) x[order[k]] = permuted[k];
  }
  free(permuted);
  return is_done ? DONE : NO_MEMORY;
}

/* The order in which the unknowns are eliminated: order[k] comes k-th. */
void amontons_cholesky_order(void *handle, int *order)
{
  const cholmod_factor *l = ((cholesky *)handle)->factor;
  memcpy(order, l->Perm, l->n * sizeof(int));
}

/* The trailing m x m block of L, by columns, zero above the diagonal. */
void amontons_cholesky_trailing(void *handle, int m, double *block)
{
  const cholmod_factor *l = ((cholesky *)handle)->factor;
  const int *super = l->super, *pi = l->pi, *px = l->px, *rows = l->s, before = (int)l->n - m;
  const double *x = l->x;
  memset(block, 0, (size_t)m * m * sizeof(double));
  for (size_t s = 0; s < l->nsuper; s++)
    for (int k = super[s]; k < super[s + 1]; k++) {
      if (k < before) continue;
      const double *column = x + px[s] + (size_t)(k - super[s]) * (size_t)(pi[s + 1] - pi[s]);
      for (int p = pi[s] + k - super[s]; p < pi[s + 1]; p++)
        block[(size_t)(k - before) * m + rows[p] - before] = column[p - pi[s]];
    }
}

/* One half of a solve, in the order of elimination: x = inv(L) b, or with `is_backward` x = inv(L') b. */
int amontons_cholesky_half_solve(void *handle, int is_backward, const double *b, double *x)
{
  cholesky *self = handle;
  memcpy(x, b, self->factor->n * sizeof *x);
  int is_done = is_backward ? amontons_plan_backward(self->plan, self->factor, (int)self->factor->n, x)
                            : amontons_plan_forward(self->plan, self->factor, (int)self->factor->n, x);
  return is_done ? DONE : NO_MEMORY;
}

/* The first or, with `is_backward`, the second half of a solve with a factor in single precision, in the order of elimination, but
 * for the last n_last unknowns, which have supernodes of their own: x = [inv(L_11) b_1; b_2 - L_21 inv(L_11) b_1], or
 * x_1 = inv(L_11') (b_1 - L_21' x_2). */
int amontons_cholesky_solve_inner(void *handle, int is_backward, int n_last, double *x)
{
  cholesky *self = handle;
  const size_t n = self->factor->n;
  const int limit = (int)n - n_last;
  double largest = 0;
  float *scaled = malloc((n + 1) * sizeof *scaled);
  if (!scaled) return NO_MEMORY;
  for (size_t k = 0; k < n; k++) largest = fmax(largest, fabs(x[k]));
  if (!(largest > 0)) largest = 1;
  for (size_t k = 0; k < n; k++) scaled[k] = (float)(x[k] / largest);
  int is_done = is_backward ? amontons_plan_backward_single(self->plan, self->factor, limit, scaled)
                            : amontons_plan_forward_single(self->plan, self->factor, limit, scaled);
  for (size_t k = 0; k < n; k++) x[k] = largest * scaled[k];
  free(scaled);
  return is_done ? DONE : NO_MEMORY;
}

static void forget_lu(lu *self)
{
  umfpack_di_free_numeric(&self->numeric);
  umfpack_di_free_symbolic(&self->symbolic);
  free(self->first);
  free(self->column);
  free(self->value);
  free(self->work_i);
  free(self->work_x);
  memset(self, 0, sizeof *self);
}

/* A new handle of an LU factor; NULL without memory. */
void *amontons_lu_new(void)
{
  return calloc(1, sizeof(lu));
}

void amontons_lu_free(void *handle)
{
  if (!handle) return;
  forget_lu(handle);
  free(handle);
}

/* Copies the pattern if it has changed. */
static int take_pattern(lu *self, int n, const int *first, const int *column)
{
  const size_t n_first = (size_t)n + 1, n_entries = first[n];
  if (self->symbolic && self->n == n && !memcmp(self->first, first, n_first * sizeof(int)) &&
      !memcmp(self->column, column, n_entries * sizeof(int))) return 1;
  forget_lu(self);
  self->n = n;
  self->first = malloc(n_first * sizeof(int));
  self->column = malloc((n_entries + 1) * sizeof(int));
  self->value = malloc((n_entries + 1) * sizeof(double));
  self->work_i = malloc(n_first * sizeof(int));
  self->work_x = malloc(5 * n_first * sizeof(double));
  if (!self->first || !self->column || !self->value || !self->work_i || !self->work_x) return 0;
  memcpy(self->first, first, n_first * sizeof(int));
  memcpy(self->column, column, n_entries * sizeof(int));
  return 1;
}

/* Factorises an unsymmetric matrix given by compressed rows with ascending columns. The analysis is kept while
 * the pattern does not change. `ratio` is the smallest over the largest pivot, `bytes` the memory used or required. */
int amontons_lu_factorise(void *handle, int n, const int *first, const int *column, const double *value, double *ratio,
                          double *bytes)
{
  lu *self = handle;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO] = {0};
  *ratio = *bytes = 0;
  if (!all_finite(value, first[n])) return NOT_FINITE;
  if (!take_pattern(self, n, first, column)) return NO_MEMORY;
  memcpy(self->value, value, (size_t)first[n] * sizeof(double));
  quiet before;
  begin_quiet(&before);
  umfpack_di_defaults(control);
  control[UMFPACK_PRL] = 0;
  control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  umfpack_di_free_numeric(&self->numeric);
  int status = UMFPACK_OK;
#ifdef _OPENMP
#pragma omp critical(metis) /* the same lock as in graph_partition.f90 */
#endif
  if (!self->symbolic) status = umfpack_di_symbolic(n, n, first, column, value, &self->symbolic, control, info);
  if (status == UMFPACK_OK)
    status = umfpack_di_numeric(self->first, self->column, self->value, self->symbolic, &self->numeric, control, info);
  end_quiet(&before);
  *ratio = info[UMFPACK_RCOND];
  *bytes = info[UMFPACK_SIZE_OF_UNIT] * fmax(info[UMFPACK_PEAK_MEMORY], info[UMFPACK_PEAK_MEMORY_ESTIMATE]);
  return status_of_umfpack(status);
}

/* Solves A x = b with iterative refinement. */
int amontons_lu_solve(void *handle, const double *b, double *x)
{
  lu *self = handle;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  quiet before;
  begin_quiet(&before);
  umfpack_di_defaults(control);
  control[UMFPACK_PRL] = 0;
  int status = umfpack_di_wsolve(UMFPACK_At, self->first, self->column, self->value, x, b, self->numeric, control, info,
                                 self->work_i, self->work_x);
  end_quiet(&before);
  return status_of_umfpack(status);
}

/* The kernels that this processor supports, by their OpenBLAS names: NULL to keep OpenBLAS's choice. */
static const char *kernels_of_processor(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl")) return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return NULL;
}

/* OpenBLAS identifies processors by model numbers. For a newer one it selects the kernels of the year 2004 (Prescott), a fifth
 * as fast. Then the kernels are set and the selection is repeated. A value of OPENBLAS_CORETYPE set by the user is kept. Returns
 * the name of the kernels in use; NULL for another BLAS. To be called before the first use of the BLAS. */
const char *amontons_choose_blas_kernels(void)
{
  char *(*name)(void);
  void (*forget)(void), (*choose)(void);
  *(void **)&name = dlsym(RTLD_DEFAULT, "openblas_get_corename"); /* the POSIX way round ISO C */
  if (!name) return NULL;
  *(void **)&forget = dlsym(RTLD_DEFAULT, "gotoblas_dynamic_quit");
  *(void **)&choose = dlsym(RTLD_DEFAULT, "gotoblas_dynamic_init");
  const char *wanted = kernels_of_processor();
  if (!forget || !choose || !wanted || getenv("OPENBLAS_CORETYPE") || strcmp(name(), "Prescott")) return name();
  setenv("OPENBLAS_CORETYPE", wanted, 1);
  forget();
  choose();
  unsetenv("OPENBLAS_CORETYPE");
  return name();
}

/* Sets the number of threads of OpenBLAS for the whole process. Returns 0 for another BLAS. */
int amontons_set_blas_threads(int n)
{
  void (*set)(int);
  *(void **)&set = dlsym(RTLD_DEFAULT, "openblas_set_num_threads"); /* the POSIX way round ISO C */
  if (!set) return 0;
  set(n);
  return 1;
}
