/* C API of Amontons: a job controlled by another program. Manual: doc/manual/library.md.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Solution starts from the last commit. amontons_try and amontons_iterate solve without a commit: the caller can inspect
 * their result, then keep it (amontons_commit) or discard it (amontons_rollback). amontons_advance solves and commits.
 *
 * Every function returns a status, which is the exit code of the program; amontons_message returns the error message. The
 * library prints nothing, never ends the process, and has no data outside the job: jobs may run concurrently, each in one
 * thread at a time.
 *
 * libamontons-mpi (make MPI=1) has the same functions, and amontons_open_on opens a job on several ranks. */
#ifndef AMONTONS_H
#define AMONTONS_H
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

#define AMONTONS_ABI 4 /* changes when a structure or a signature below does */

enum {
  AMONTONS_DONE = 0,          /* success */
  AMONTONS_USAGE = 2,         /* the call is wrong: a name, a size, an order of calls */
  AMONTONS_DECK = 3,          /* errors in the deck; the message contains all of them */
  AMONTONS_SETUP = 4,         /* the model check found errors */
  AMONTONS_NOT_CONVERGED = 5, /* the job is as at its last commit */
  AMONTONS_SOLVER = 6,        /* linear solver or memory */
  AMONTONS_IO = 7,            /* reading or writing a file */
  AMONTONS_INTERNAL = 8       /* internal error of Amontons */
};

enum { AMONTONS_GO_ON = 0, AMONTONS_CONVERGED = 1, AMONTONS_DIVERGES = 2, AMONTONS_TOO_SLOW = 3 };

typedef struct amontons_job amontons_job;

/* Receives the log line by line. */
typedef void (*amontons_log)(void *context, const char *line);

typedef struct {
  int32_t abi;             /* AMONTONS_ABI */
  int32_t n_threads;       /* of this job */
  int32_t has_files;       /* 1: write job.vtkhdf, job.sta, job.cvg, job.dat */
  int32_t has_checkpoint;  /* 1: and job.restart at each commit */
  int32_t is_resumed;      /* 1: resume from that checkpoint */
  int32_t is_check;        /* 1: read the deck and check the model only */
  int32_t n_partitions;    /* of job.vtkhdf, each with a file of its own, up to 9999; 0: one file has all */
  const char *deck;        /* path of the deck; with a text only its name in messages */
  const char *text;        /* the deck itself, or NULL */
  const char *job;         /* name of the result files, or NULL: that of the deck */
  const char *outdir;      /* their folder, or NULL: that of the deck */
  const char *dialect;     /* "abaqus", "calculix", or NULL: what the deck says */
  const char *user;        /* user routines (UMAT, ...): a Fortran file or a shared library; or NULL */
  const char *old_job;     /* job of the restart file that *RESTART, READ reads; or NULL */
  amontons_log log;        /* or NULL */
  void *context;           /* first argument of log */
} amontons_options;

#define AMONTONS_OPTIONS {AMONTONS_ABI, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}

int amontons_abi(void);
void amontons_version(char *text, int capacity); /* e.g. "0.1.0", ended by 0 */

/* Friction status of n slave nodes of the caller, at an iterate u and after the whole search direction d (the procedure of
 * doc/theory/contact.md, section 4; no job is needed). All nodes are closed. The arrays contain the nodes at u, then at u + d:
 * tangential[2][n][3] the tangential imbalance, normal_force[2][n] positive in compression, slip[2][n][3] since the
 * start of the increment; direction[n][3] is d there, tangential, relative to the master. controls: NULL, or 5 numbers:
 * tolerance of |DR| over mu N, the same as a force, tolerance of slip, least and largest step length. Output: verdicts[n][2],
 * scenario 1 to 4 (0: none) and AMONTONS_NODE_...; step lengths alpha[n]. Output pointers may be NULL. */
enum { AMONTONS_NODE_STICK = 1, AMONTONS_NODE_SLIP = 2, AMONTONS_NODE_BALANCED = 3, AMONTONS_NODE_OPENED = 4 };
int amontons_classify(int64_t n, const double *tangential, const double *normal_force, const double *slip,
                      const double *direction, const double *mu, const double *controls, int32_t *verdicts,
                      double *alpha);

/* Opens a job. It has the message, and must be closed, even after an error; NULL: no memory. */
int amontons_open(const amontons_options *options, amontons_job **job);

/* The same on the ranks of a communicator, given as MPI_Comm_c2f(comm); MPI runs. All its ranks call, from one thread, the same
 * functions with the same arguments, and get the same values, statuses and messages; the first has the log and writes the
 * files. A process has one communicator at a time. libamontons, which has one rank, returns AMONTONS_USAGE. */
int amontons_open_on(const amontons_options *options, int communicator, amontons_job **job);
void amontons_close(amontons_job *job);
const char *amontons_message(const amontons_job *job); /* of the last call that failed; valid until the next */
int amontons_is_done(const amontons_job *job);         /* 1: all steps are done */

int amontons_advance(amontons_job *job);                       /* one increment as the deck says, committed */
int amontons_advance_to(amontons_job *job, double total_time); /* increments until that time, each committed */
int amontons_try(amontons_job *job, double dt);                /* to the current time + dt, or the end of the step; not committed */
int amontons_begin(amontons_job *job, double dt);              /* an increment to be solved by amontons_iterate */
int amontons_iterate(amontons_job *job, int *verdict);         /* one Newton iteration; AMONTONS_CONVERGED, ... */
int amontons_commit(amontons_job *job);                        /* keep and write the solution */
int amontons_rollback(amontons_job *job);                      /* restore the last commit bitwise */
int amontons_finish(amontons_job *job);                        /* close the files */

/* Values by name, row by row. With values = NULL only the numbers of rows and columns are returned. `set` is a node set, a
 * surface, the label of a node, or "": all nodes; of POINT and ELEMENT quantities an element set or the label of an
 * element. Output pointers may be NULL. */
int amontons_get(amontons_job *job, const char *quantity, const char *set, double *values, int64_t capacity,
                 int64_t *rows, int64_t *columns);
int amontons_set(amontons_job *job, const char *quantity, const char *set, const double *values, int64_t n);

/* The names of "NODE SETS", "ELEMENT SETS", "SURFACES", "PAIRS", "INTERACTIONS", "MATERIALS", or the "QUANTITIES" that
 * amontons_get accepts: one per line, ended by 0. With text = NULL only the size needed is returned. */
int amontons_names(amontons_job *job, const char *kind, char *text, int64_t capacity, int64_t *needed);

/* A matrix by compressed rows, counted from 0: "TANGENT" (on the free unknowns), "MAP" (all unknowns from the free
 * ones), "STIFFNESS" (of the elements, on all unknowns). First query the sizes, then copy. */
int amontons_matrix(amontons_job *job, const char *name, int64_t *rows, int64_t *columns, int64_t *entries);
int amontons_matrix_copy(amontons_job *job, int64_t *first, int64_t *column, double *value);
int amontons_residual_copy(amontons_job *job, double *values); /* of the free unknowns, for the last matrix */

#ifdef __cplusplus
}
#endif
#endif
