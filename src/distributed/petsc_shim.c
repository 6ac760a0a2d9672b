/* Ranks by MPI, and the distributed linear solver by PETSc (distributed_shim.h); built by make MPI=1 alone.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Sums have a fixed order: each rank adds one part of the array, rank by rank, and passes it on to all. PETSc's matrix is assembled
 * from entries of the rank's own rows. The kinds of solver are those of distributed_solver.f90.
 *
 * A process has one communicator at a time: that of the program, or that of the jobs which a calling program has open. */
#define _GNU_SOURCE
#include "distributed_shim.h"
#include <fenv.h>
#include <petscksp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { GAMG = 1, HYPRE = 2, MUMPS = 3, BDDC = 5 };
enum { DONE = 0, BROKEN = 1, FAILED = 2 };
enum { JOIN_DONE = 0, JOIN_NOT_RUNNING = 2, JOIN_NO_MEMBER = 3, JOIN_OTHER = 4 }; /* of mpi_ranks.f90 */
enum { N_MOTIONS = 6, BLOCK = 1 << 16, FEW = 64 };
static const double SMALLEST_MOTION = 1.0e-8; /* of a rigid motion beside those before it */

typedef struct {
  int kind;
  PetscInt n; /* rows of this rank */
  Mat matrix;
  Mat part;          /* of this rank, for BDDC: the matrix is their sum */
  PetscReal *places; /* three coordinates for each row, for BDDC */
  KSP ksp;
  Vec b, x;
} solver;

static MPI_Comm communicator = MPI_COMM_NULL; /* of the ranks; null: this process is the only one */
static int n_jobs = 0;                        /* that joined it */

static int is_running(void)
{
  int begun = 0, ended = 0;
  MPI_Initialized(&begun);
  if (begun) MPI_Finalized(&ended);
  return begun && !ended;
}

static int has_ranks(void) { return communicator != MPI_COMM_NULL && is_running(); }

/* Without the handlers of PETSc: signals and errors are the program's. */
static void begin_petsc(void)
{
  PetscInitializeNoArguments();
  PetscPopSignalHandler();
  PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
}

void amontons_ranks_begin(void)
{
  int provided;
  MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_dup(MPI_COMM_WORLD, &communicator);
  begin_petsc();
}

void amontons_ranks_end(void)
{
  if (!is_running()) return;
  PetscFinalize();
  if (communicator != MPI_COMM_NULL) MPI_Comm_free(&communicator);
  MPI_Finalize();
}

/* Whether the jobs that are open have the ranks of this communicator, in its order. */
static int is_joined(MPI_Comm wanted)
{
  int result = MPI_UNEQUAL;
  if (wanted == MPI_COMM_NULL || communicator == MPI_COMM_NULL) return wanted == communicator;
  MPI_Comm_compare(wanted, communicator, &result);
  return result == MPI_IDENT || result == MPI_CONGRUENT;
}

/* PETSc begins with the process alone, so that no rank outside of the communicator has to take part; its objects name theirs. */
int amontons_ranks_join(int has_communicator, int handle)
{
  MPI_Comm wanted = MPI_COMM_NULL;
  PetscBool is_begun = PETSC_FALSE;
  int is_inter = 0;
  if (has_communicator) {
    if (!is_running()) return JOIN_NOT_RUNNING;
    wanted = MPI_Comm_f2c(handle);
    if (wanted == MPI_COMM_NULL) return JOIN_NO_MEMBER;
    MPI_Comm_test_inter(wanted, &is_inter);
    if (is_inter) return JOIN_NO_MEMBER;
  }
  if (n_jobs > 0) {
    if (!is_joined(wanted)) return JOIN_OTHER;
  } else if (has_communicator) {
    MPI_Comm_dup(wanted, &communicator);
    PetscInitialized(&is_begun);
    if (!is_begun) {
      PETSC_COMM_WORLD = MPI_COMM_SELF;
      begin_petsc();
    }
  }
  n_jobs++;
  return JOIN_DONE;
}

void amontons_ranks_leave(void)
{
  if (n_jobs > 0) n_jobs--;
  if (n_jobs == 0 && has_ranks()) MPI_Comm_free(&communicator);
}

int amontons_rank(void)
{
  int rank = 0;
  if (has_ranks()) MPI_Comm_rank(communicator, &rank);
  return rank;
}

int amontons_n_ranks(void)
{
  int n = 1;
  if (has_ranks()) MPI_Comm_size(communicator, &n);
  return n;
}

/* The part of n numbers that rank r adds: from first[r] to first[r + 1]. */
static void divide(int n, int n_ranks, int *count, int *first)
{
  for (int r = 0; r < n_ranks; r++) {
    first[r] = (int)((int64_t)n * r / n_ranks);
    count[r] = (int)((int64_t)n * (r + 1) / n_ranks) - first[r];
  }
}

/* A few numbers: one message of all ranks to all. */
static void sum_few(double *x, int n, int size)
{
  double parts[FEW * size];
  MPI_Allgather(x, n, MPI_DOUBLE, parts, n, MPI_DOUBLE, communicator);
  for (int k = 0; k < n; k++) {
    x[k] = parts[k];
    for (int r = 1; r < size; r++) x[k] += parts[r * n + k];
  }
}

void amontons_ranks_sum(double *x, int64_t n)
{
  const int size = amontons_n_ranks(), rank = amontons_rank();
  if (size == 1) return;
  if (n <= FEW) {
    sum_few(x, (int)n, size);
    return;
  }
  int count[size], first[size], own_count[size], own_first[size];
  double parts[BLOCK + size]; /* half a megabyte of the stack: a sum never lacks memory */
  for (int64_t start = 0; start < n; start += BLOCK) {
    const int m = (int)(n - start < BLOCK ? n - start : BLOCK);
    divide(m, size, count, first);
    const int own = count[rank];
    for (int r = 0; r < size; r++) {
      own_count[r] = own;
      own_first[r] = r * own;
    }
    MPI_Alltoallv(x + start, count, first, MPI_DOUBLE, parts, own_count, own_first, MPI_DOUBLE, communicator);
    for (int k = 0; k < own; k++) {
      double sum = parts[k];
      for (int r = 1; r < size; r++) sum += parts[(size_t)r * (size_t)own + (size_t)k];
      parts[k] = sum;
    }
    MPI_Allgatherv(parts, own, MPI_DOUBLE, x + start, count, first, MPI_DOUBLE, communicator);
  }
}

void amontons_ranks_gather(double *x, const int *counts)
{
  const int size = amontons_n_ranks();
  if (size == 1) return;
  int first[size];
  first[0] = 0;
  for (int r = 1; r < size; r++) first[r] = first[r - 1] + counts[r - 1];
  MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, x, counts, first, MPI_DOUBLE, communicator);
}

void amontons_ranks_exchange(int n, const int *other, const int *send_first, const double *sent, const int *receive_first,
                             double *received)
{
  if (n == 0) return;
  MPI_Request request[2 * n];
  for (int k = 0; k < n; k++)
    MPI_Irecv(received + receive_first[k], receive_first[k + 1] - receive_first[k], MPI_DOUBLE, other[k], 0, communicator, request + k);
  for (int k = 0; k < n; k++)
    MPI_Isend(sent + send_first[k], send_first[k + 1] - send_first[k], MPI_DOUBLE, other[k], 0, communicator, request + n + k);
  MPI_Waitall(2 * n, request, MPI_STATUSES_IGNORE);
}

double amontons_ranks_min(double x)
{
  if (amontons_n_ranks() > 1) MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_DOUBLE, MPI_MIN, communicator);
  return x;
}

void amontons_ranks_broadcast(char *bytes, int n, int root)
{
  if (amontons_n_ranks() > 1) MPI_Bcast(bytes, n, MPI_CHAR, root, communicator);
}

/* A barrier that no rank waits for without end: one that failed alone comes here while the others wait elsewhere. */
int amontons_ranks_meet(double seconds)
{
  if (amontons_n_ranks() == 1) return 1;
  MPI_Request request;
  int is_met = 0;
  const struct timespec pause = {0, 10000000};
  if (MPI_Ibarrier(communicator, &request) != MPI_SUCCESS) return 0;
  for (double waited = 0; waited < seconds && !is_met; waited += 0.01) {
    MPI_Test(&request, &is_met, MPI_STATUS_IGNORE);
    if (!is_met) nanosleep(&pause, NULL);
  }
  return is_met;
}

void amontons_ranks_abort(int code)
{
  if (is_running()) MPI_Abort(MPI_COMM_WORLD, code);
  exit(code);
}

int amontons_solver_exists(void) { return has_ranks(); }

/* The senders and the two lengths of their messages, in place of the procedure of PETSc, whose list has the order of arrival: the
 * coarse matrix of BDDC is summed in this order, and the same ranks twice gave other bits. Here it is that of the ranks. */
PetscErrorCode PetscGatherMessageLengths2(MPI_Comm comm, PetscMPIInt n_sent, PetscMPIInt n_received, const PetscMPIInt first[],
                                          const PetscMPIInt second[], PetscMPIInt **senders, PetscMPIInt **firsts,
                                          PetscMPIInt **seconds)
{
  int size, n = 0;
  (void)n_sent;
  MPI_Comm_size(comm, &size);
  PetscMPIInt *sent = calloc(4 * (size_t)size, sizeof *sent), *received = sent + 2 * size;
  if (!sent) return PETSC_ERR_MEM;
  for (int r = 0; r < size; r++) {
    if (first[r] == 0) continue; /* no message: the second length is not set */
    sent[2 * r] = first[r];
    sent[2 * r + 1] = second[r];
  }
  MPI_Alltoall(sent, 2, MPI_INT, received, 2, MPI_INT, comm);
  PetscCall(PetscMalloc1(n_received + 1, senders));
  PetscCall(PetscMalloc1(n_received + 1, firsts));
  PetscCall(PetscMalloc1(n_received + 1, seconds));
  for (int r = 0; r < size && n < n_received; r++) {
    if (received[2 * r] == 0) continue;
    (*senders)[n] = r;
    (*firsts)[n] = received[2 * r];
    (*seconds)[n++] = received[2 * r + 1];
  }
  free(sent);
  return 0;
}

/* The near null space of AMG and BDDC: rigid motions at the free unknowns, orthonormal; those that depend on others are left out. */
static PetscErrorCode attach_motions(solver *self, const double *motions)
{
  Vec kept[N_MOTIONS];
  PetscInt n_kept = 0;
  MatNullSpace space;
  for (int m = 0; m < N_MOTIONS; m++) {
    PetscScalar *values;
    PetscReal before, after;
    PetscCall(VecDuplicate(self->b, &kept[n_kept]));
    PetscCall(VecGetArray(kept[n_kept], &values));
    for (PetscInt i = 0; i < self->n; i++) values[i] = motions[N_MOTIONS * i + m];
    PetscCall(VecRestoreArray(kept[n_kept], &values));
    PetscCall(VecNorm(kept[n_kept], NORM_2, &before));
    for (int pass = 0; pass < 2; pass++)
      for (PetscInt k = 0; k < n_kept; k++) {
        PetscScalar overlap;
        PetscCall(VecDot(kept[n_kept], kept[k], &overlap));
        PetscCall(VecAXPY(kept[n_kept], -overlap, kept[k]));
      }
    PetscCall(VecNorm(kept[n_kept], NORM_2, &after));
    if (after > SMALLEST_MOTION * before) {
      PetscCall(VecScale(kept[n_kept], 1.0 / after));
      n_kept++;
    } else {
      PetscCall(VecDestroy(&kept[n_kept]));
    }
  }
  if (n_kept == 0) return 0;
  PetscCall(MatNullSpaceCreate(communicator, PETSC_FALSE, n_kept, kept, &space));
  PetscCall(MatSetNearNullSpace(self->matrix, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (PetscInt k = 0; k < n_kept; k++) PetscCall(VecDestroy(&kept[k]));
  return 0;
}

/* Options of the preconditioners, by the prefix of the solver. */
static PetscErrorCode choose(solver *self)
{
  static const char *const settings[][2] = {
    {"-amontons_pc_gamg_agg_nsmooths", "1"}, {"-amontons_mg_levels_ksp_type", "chebyshev"},
    {"-amontons_mg_levels_pc_type", "jacobi"}, {"-amontons_mg_levels_ksp_max_it", "2"},
    {"-amontons_pc_hypre_boomeramg_coarsen_type", "HMIS"}, {"-amontons_pc_hypre_boomeramg_interp_type", "ext+i"},
    {"-amontons_pc_hypre_boomeramg_strong_threshold", "0.5"}, {"-amontons_mat_mumps_icntl_13", "1"},
    {"-amontons_mat_mumps_icntl_24", "1"}, /* these two: MUMPS counts all pivots, null ones too */
    {"-amontons_pc_bddc_corner_selection", "1"},
    {"-amontons_pc_bddc_coarse_eqs_per_proc", "1000000000"}, /* on one rank */
    {"-amontons_pc_bddc_use_deluxe_scaling", "1"},
    {"-amontons_pc_bddc_switch_static", "1"}, /* residuals within the parts are corrected, too: else they stay at 1e-9 */
    {"-amontons_pc_bddc_dirichlet_pc_type", "cholesky"}, {"-amontons_pc_bddc_dirichlet_pc_factor_mat_solver_type", "mumps"},
    {"-amontons_pc_bddc_neumann_pc_type", "cholesky"}, {"-amontons_pc_bddc_neumann_pc_factor_mat_solver_type", "mumps"}};
  PC pc;
  for (size_t k = 0; k < sizeof settings / sizeof settings[0]; k++)
    PetscCall(PetscOptionsSetValue(NULL, settings[k][0], settings[k][1]));
  if (amontons_n_ranks() > 1) { /* the other products of coarse matrices of ranks add by the arrival of messages */
    PetscCall(PetscOptionsSetValue(NULL, "-matptap_via", "allatonce"));
  } else {
    PetscCall(PetscOptionsClearValue(NULL, "-matptap_via"));
  }
  PetscCall(KSPCreate(communicator, &self->ksp));
  PetscCall(KSPSetOptionsPrefix(self->ksp, "amontons_"));
  PetscCall(KSPSetOperators(self->ksp, self->matrix, self->matrix));
  PetscCall(KSPSetType(self->ksp, KSPCG));
  PetscCall(KSPSetNormType(self->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPGetPC(self->ksp, &pc));
  if (self->kind == GAMG) PetscCall(PCSetType(pc, PCGAMG));
  if (self->kind == HYPRE) {
    PetscCall(PCSetType(pc, PCHYPRE));
    PetscCall(PCHYPRESetType(pc, "boomeramg"));
  }
  if (self->kind == BDDC) {
    PetscCall(PCSetType(pc, PCBDDC));
    PetscCall(PCSetCoordinates(pc, 3, self->n, self->places)); /* by which corners are chosen */
  }
  if (self->kind == MUMPS) {
    PetscCall(PCSetType(pc, PCCHOLESKY));
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  }
  PetscCall(KSPSetFromOptions(self->ksp));
  return 0;
}

/* What is known of the matrix, its vectors and preconditioner. */
static PetscErrorCode complete(solver *self, const double *motions)
{
  PetscCall(MatSetOption(self->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(self->matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  if (self->kind != MUMPS) PetscCall(MatSetOption(self->matrix, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(self->matrix, &self->x, &self->b));
  if (self->kind == GAMG || self->kind == BDDC) PetscCall(attach_motions(self, motions));
  return choose(self);
}

static PetscErrorCode create(solver *self, PetscCount n_entries, const int *row, const int *column, const double *motions)
{
  PetscInt *i = malloc((size_t)n_entries * sizeof *i), *j = malloc((size_t)n_entries * sizeof *j);
  for (PetscCount k = 0; k < n_entries; k++) {
    i[k] = row[k];
    j[k] = column[k];
  }
  PetscCall(MatCreate(communicator, &self->matrix));
  PetscCall(MatSetSizes(self->matrix, self->n, self->n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(self->matrix, MATAIJ));
  PetscCall(MatSetBlockSize(self->matrix, 3));
  PetscCall(MatSetPreallocationCOO(self->matrix, n_entries, i, j));
  free(i);
  free(j);
  return complete(self, motions);
}

/* The matrix as a sum of parts. */
static PetscErrorCode create_parts(solver *self, int n_held, const int *held, PetscCount n_entries, const int *row, const int *column,
                                   const double *motions)
{
  PetscInt *number = malloc((size_t)(n_held + 1) * sizeof *number);
  PetscInt *i = malloc((size_t)(n_entries + 1) * sizeof *i), *j = malloc((size_t)(n_entries + 1) * sizeof *j);
  ISLocalToGlobalMapping map;
  for (int k = 0; k < n_held; k++) number[k] = held[k];
  for (PetscCount k = 0; k < n_entries; k++) {
    i[k] = row[k];
    j[k] = column[k];
  }
  PetscCall(ISLocalToGlobalMappingCreate(communicator, 1, n_held, number, PETSC_COPY_VALUES, &map));
  PetscCall(MatCreateIS(communicator, 1, self->n, self->n, PETSC_DETERMINE, PETSC_DETERMINE, map, map, &self->matrix));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscCall(MatCreate(PETSC_COMM_SELF, &self->part));
  PetscCall(MatSetSizes(self->part, n_held, n_held, n_held, n_held));
  PetscCall(MatSetType(self->part, MATSEQAIJ));
  PetscCall(MatSetPreallocationCOO(self->part, n_entries, i, j));
  PetscCall(MatSetOption(self->part, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(self->part, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  PetscCall(MatISSetLocalMat(self->matrix, self->part));
  free(number);
  free(i);
  free(j);
  return complete(self, motions);
}

void *amontons_solver_new(int kind, int n_rows, int n_entries, const int *row, const int *column, const double *motions)
{
  solver *self = calloc(1, sizeof *self);
  fenv_t environment;
  if (!self) return NULL;
  self->kind = kind;
  self->n = n_rows;
  feholdexcept(&environment);
  PetscErrorCode code = create(self, n_entries, row, column, motions);
  fesetenv(&environment);
  if (code == 0) return self;
  free(self);
  return NULL;
}

void *amontons_solver_new_parts(int n_rows, int n_held, const int *held, int n_entries, const int *row, const int *column,
                                const double *motions, const double *coordinates)
{
  solver *self = calloc(1, sizeof *self);
  fenv_t environment;
  if (!self) return NULL;
  self->kind = BDDC;
  self->n = n_rows;
  feholdexcept(&environment);
  self->places = malloc((size_t)(3 * n_rows + 1) * sizeof *self->places);
  for (int k = 0; k < 3 * n_rows; k++) self->places[k] = coordinates[k];
  PetscErrorCode code = create_parts(self, n_held, held, n_entries, row, column, motions);
  fesetenv(&environment);
  if (code == 0) return self;
  free(self->places);
  free(self);
  return NULL;
}

/* New values and their preconditioner. A factor with negative pivots is not one of a positive definite matrix. */
static PetscErrorCode set_up(solver *self, const double *value, int *status)
{
  PC pc;
  PCFailedReason reason;
  PetscCall(MatSetValuesCOO(self->part ? self->part : self->matrix, value, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(self->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(self->matrix, MAT_FINAL_ASSEMBLY));
  if (self->kind == BDDC) { /* its set-up does not begin anew with other values */
    PetscCall(KSPDestroy(&self->ksp));
    PetscCall(choose(self));
  }
  PetscCall(KSPSetOperators(self->ksp, self->matrix, self->matrix));
  PetscCall(KSPGetPC(self->ksp, &pc));
  PetscCall(KSPSetUp(self->ksp));
  PetscCall(PCGetFailedReason(pc, &reason));
  *status = reason == PC_NOERROR ? DONE : BROKEN;
  if (*status == DONE && self->kind == MUMPS) {
    Mat factor;
    PetscInt negative, zero, positive;
    PetscCall(PCFactorGetMatrix(pc, &factor));
    PetscCall(MatGetInertia(factor, &negative, &zero, &positive));
    if (negative + zero > 0) *status = BROKEN;
  }
  return 0;
}

int amontons_solver_update(void *handle, const double *value)
{
  solver *self = handle;
  fenv_t environment;
  int status = DONE;
  feholdexcept(&environment);
  PetscErrorCode code = set_up(self, value, &status);
  fesetenv(&environment);
  return code == 0 ? status : FAILED;
}

/* Copies to the vectors, applies, copies back. most < 0: the preconditioner alone. */
static PetscErrorCode run(solver *self, const double *b, double *x, double tolerance, double absolute, int most, int *iterations,
                          double *residual, int *status)
{
  PetscScalar *to;
  const PetscScalar *from;
  PetscCall(VecGetArrayWrite(self->b, &to));
  if (self->n > 0) memcpy(to, b, (size_t)self->n * sizeof *to);
  PetscCall(VecRestoreArrayWrite(self->b, &to));
  *status = DONE;
  if (most < 0) {
    PC pc;
    PetscCall(KSPGetPC(self->ksp, &pc));
    PetscCall(PCApply(pc, self->b, self->x));
  } else {
    KSPConvergedReason reason;
    PetscInt n;
    PetscReal norm, size;
    Vec rest;
    PetscCall(KSPSetTolerances(self->ksp, tolerance, absolute, PETSC_DEFAULT, most));
    PetscCall(KSPSolve(self->ksp, self->b, self->x));
    PetscCall(KSPGetConvergedReason(self->ksp, &reason));
    PetscCall(KSPGetIterationNumber(self->ksp, &n));
    PetscCall(VecDuplicate(self->b, &rest));
    PetscCall(MatMult(self->matrix, self->x, rest));
    PetscCall(VecAYPX(rest, -1.0, self->b));
    PetscCall(VecNorm(rest, NORM_2, &norm));
    PetscCall(VecNorm(self->b, NORM_2, &size));
    PetscCall(VecDestroy(&rest));
    *iterations = (int)n;
    *residual = size > 0 ? norm / size : 0;
    if (reason <= 0) *status = BROKEN;
  }
  PetscCall(VecGetArrayRead(self->x, &from));
  if (self->n > 0) memcpy(x, from, (size_t)self->n * sizeof *x);
  PetscCall(VecRestoreArrayRead(self->x, &from));
  return 0;
}

int amontons_solver_apply(void *handle, const double *b, double *x)
{
  int status = DONE, iterations;
  double residual;
  fenv_t environment;
  feholdexcept(&environment);
  PetscErrorCode code = run(handle, b, x, 0, 0, -1, &iterations, &residual, &status);
  fesetenv(&environment);
  return code == 0 ? status : FAILED;
}

int amontons_solver_solve(void *handle, const double *b, double *x, double tolerance, double absolute, int most, int *iterations,
                          double *residual)
{
  int status = DONE;
  fenv_t environment;
  feholdexcept(&environment);
  PetscErrorCode code = run(handle, b, x, tolerance, absolute, most, iterations, residual, &status);
  fesetenv(&environment);
  return code == 0 ? status : FAILED;
}

void amontons_solver_free(void *handle)
{
  solver *self = handle;
  if (!self) return;
  if (is_running()) {
    KSPDestroy(&self->ksp);
    MatDestroy(&self->matrix);
    MatDestroy(&self->part);
    VecDestroy(&self->b);
    VecDestroy(&self->x);
  }
  free(self->places);
  free(self);
}
