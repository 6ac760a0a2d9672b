/* One rank without MPI: the ranks of a program that was not built with MPI=1 (distributed_shim.h).
 * SPDX-License-Identifier: GPL-3.0-or-later */
#include "distributed_shim.h"
#include <stddef.h>
#include <stdlib.h>

void amontons_ranks_begin(void) {}
void amontons_ranks_end(void) {}

int amontons_ranks_join(int has_communicator, int handle)
{
  (void)handle;
  return has_communicator ? 1 : 0;
}

void amontons_ranks_leave(void) {}
int amontons_rank(void) { return 0; }
int amontons_n_ranks(void) { return 1; }

void amontons_ranks_sum(double *x, int64_t n) { (void)x, (void)n; }

void amontons_ranks_gather(double *x, const int *counts) { (void)x, (void)counts; }
void amontons_ranks_exchange(int n, const int *other, const int *send_first, const double *sent, const int *receive_first,
                             double *received)
{
  (void)n, (void)other, (void)send_first, (void)sent, (void)receive_first, (void)received;
}

double amontons_ranks_min(double x) { return x; }
void amontons_ranks_broadcast(char *bytes, int n, int root) { (void)bytes, (void)n, (void)root; }

int amontons_ranks_meet(double seconds)
{
  (void)seconds;
  return 1;
}

void amontons_ranks_abort(int code) { exit(code); }

int amontons_solver_exists(void) { return 0; }

void *amontons_solver_new(int kind, int n_rows, int n_entries, const int *row, const int *column, const double *motions)
{
  (void)kind, (void)n_rows, (void)n_entries, (void)row, (void)column, (void)motions;
  return NULL;
}

void *amontons_solver_new_parts(int n_rows, int n_held, const int *held, int n_entries, const int *row, const int *column,
                                const double *motions, const double *coordinates)
{
  (void)n_rows, (void)n_held, (void)held, (void)n_entries, (void)row, (void)column, (void)motions, (void)coordinates;
  return NULL;
}

int amontons_solver_update(void *handle, const double *value)
{
  (void)handle, (void)value;
  return 2;
}

int amontons_solver_apply(void *handle, const double *b, double *x)
{
  (void)handle, (void)b, (void)x;
  return 2;
}

int amontons_solver_solve(void *handle, const double *b, double *x, double tolerance, double absolute, int most, int *iterations,
                          double *residual)
{
  (void)handle, (void)b, (void)x, (void)tolerance, (void)absolute, (void)most;
  *iterations = 0;
  *residual = 1;
  return 2;
}

void amontons_solver_free(void *handle) { (void)handle; }
