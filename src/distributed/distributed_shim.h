/* Ranks of one job and the distributed linear solver: the interface of mpi_ranks.f90 and distributed_solver.f90 to the machine.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Two files implement it: serial_shim.c, for one process without MPI, and petsc_shim.c, with MPI and PETSc (make MPI=1). The
 * Fortran code is the same for both. Every procedure is collective: all ranks call it, in the same order. */
#ifndef AMONTONS_DISTRIBUTED_SHIM_H
#define AMONTONS_DISTRIBUTED_SHIM_H
#include <stdint.h>

/* Begins and ends the communication of the ranks. Before the begin and after the end there is one rank. */
void amontons_ranks_begin(void);
void amontons_ranks_end(void);

/* A job of a calling program joins the ranks of a communicator (a Fortran handle), or is alone (has_communicator 0); the ranks are
 * those of all jobs of the process until the last one leaves. 0: joined; 1: this program has no MPI; 2: MPI does not run;
 * 3: this process is not in the communicator; 4: other jobs that are open have other ranks. */
int amontons_ranks_join(int has_communicator, int handle);
void amontons_ranks_leave(void);

int amontons_rank(void);    /* of this process, from 0 */
int amontons_n_ranks(void);

/* Sums an array over the ranks, in the order of the ranks: the result has the same bits on all. */
void amontons_ranks_sum(double *x, int64_t n);

/* Completes an array of which each rank has its own part: rank r has counts[r] numbers, one part after the other. */
void amontons_ranks_gather(double *x, const int *counts);

/* Point-to-point messages: to rank other[k] the numbers send_first[k] to send_first[k + 1] of `sent`, and from it those of
 * `received`, by the same scheme. */
void amontons_ranks_exchange(int n, const int *other, const int *send_first, const double *sent, const int *receive_first,
                             double *received);

double amontons_ranks_min(double x);
void amontons_ranks_broadcast(char *bytes, int n, int root);

/* Whether all ranks come here within so many seconds. */
int amontons_ranks_meet(double seconds);

/* Ends the processes of all ranks. */
void amontons_ranks_abort(int code);

/* The distributed solver of a symmetric matrix, given by rows: rank r has the rows after those of rank r - 1.
 * Status: 0 done, 1 not positive definite or not converged, 2 an error of the library. */
int amontons_solver_exists(void);
void *amontons_solver_new(int kind, int n_rows, int n_entries, const int *row, const int *column, const double *motions);

/* Balancing domain decomposition by constraints: the matrix is the sum over the ranks of parts between n_held rows, whose global
 * numbers are `held`, from 0. Entries are both triangles of this rank's part, by places in `held`; six motions and three coordinates
 * for each row of this rank. */
void *amontons_solver_new_parts(int n_rows, int n_held, const int *held, int n_entries, const int *row, const int *column,
                                const double *motions, const double *coordinates);
int amontons_solver_update(void *handle, const double *value);
int amontons_solver_apply(void *handle, const double *b, double *x);
int amontons_solver_solve(void *handle, const double *b, double *x, double tolerance, double absolute, int most, int *iterations,
                          double *residual);
void amontons_solver_free(void *handle);

#endif
