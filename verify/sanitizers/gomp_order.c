/* Reports to ThreadSanitizer what libgomp orders: regions, barriers, critical sections and tasks, which it cannot see because
 * libgomp waits by futexes and is not instrumented. Preloaded before libgomp; `make races` does.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Only the order that OpenMP promises is reported, with one exception that makes the detector milder: a task is taken to come
 * after every task that has ended before it began. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

extern void __tsan_acquire(void *place);
extern void __tsan_release(void *place);

static char barrier_token, critical_token, task_token;

/* The next function of a name, looked up once. */
#define NEXT(name, type)         \
  static __typeof__(type) *next; \
  if (!next) next = (__typeof__(type) *)dlsym(RTLD_NEXT, #name)

typedef void body(void *data);

typedef struct {
  body *function;
  void *data;
  char fork, join;
} region;

static void enter(void *place)
{
  region *self = place;
  __tsan_acquire(&self->fork);
  self->function(self->data);
  __tsan_release(&self->join);
}

/* A region: all threads come after its start, and what follows comes after all of them. */
#define REGION(call)                                 \
  region *self = malloc(sizeof *self);               \
  *self = (region){.function = function, .data = data}; \
  __tsan_release(&self->fork);                       \
  call;                                              \
  __tsan_acquire(&self->join);                       \
  free(self)

void GOMP_parallel(body *function, void *data, unsigned n_threads, unsigned flags);
void GOMP_parallel(body *function, void *data, unsigned n_threads, unsigned flags)
{
  NEXT(GOMP_parallel, void(body *, void *, unsigned, unsigned));
  REGION(next(enter, self, n_threads, flags));
}

void GOMP_parallel_sections(body *function, void *data, unsigned n_threads, unsigned count, unsigned flags);
void GOMP_parallel_sections(body *function, void *data, unsigned n_threads, unsigned count, unsigned flags)
{
  NEXT(GOMP_parallel_sections, void(body *, void *, unsigned, unsigned, unsigned));
  REGION(next(enter, self, n_threads, count, flags));
}

#define LOOP(name)                                                                                              \
  void name(body *function, void *data, unsigned n_threads, long start, long end, long step, long chunk,        \
            unsigned flags);                                                                                    \
  void name(body *function, void *data, unsigned n_threads, long start, long end, long step, long chunk,        \
            unsigned flags)                                                                                     \
  {                                                                                                             \
    NEXT(name, void(body *, void *, unsigned, long, long, long, long, unsigned));                               \
    REGION(next(enter, self, n_threads, start, end, step, chunk, flags));                                       \
  }
LOOP(GOMP_parallel_loop_dynamic)
LOOP(GOMP_parallel_loop_nonmonotonic_dynamic)
LOOP(GOMP_parallel_loop_static)
LOOP(GOMP_parallel_loop_guided)
LOOP(GOMP_parallel_loop_nonmonotonic_guided)

/* What every thread of a team waits for. */
#define BARRIER(name)                \
  void name(void);                   \
  void name(void)                    \
  {                                  \
    NEXT(name, void(void));          \
    __tsan_release(&barrier_token);  \
    next();                          \
    __tsan_acquire(&barrier_token);  \
  }
BARRIER(GOMP_barrier)
BARRIER(GOMP_loop_end)
BARRIER(GOMP_sections_end)

/* One thread at a time. */
#define LOCK(name)                   \
  void name(void);                   \
  void name(void)                    \
  {                                  \
    NEXT(name, void(void));          \
    next();                          \
    __tsan_acquire(&critical_token); \
  }
#define UNLOCK(name)                 \
  void name(void);                   \
  void name(void)                    \
  {                                  \
    NEXT(name, void(void));          \
    __tsan_release(&critical_token); \
    next();                          \
  }
LOCK(GOMP_critical_start)
UNLOCK(GOMP_critical_end)
LOCK(GOMP_atomic_start)
UNLOCK(GOMP_atomic_end)

void GOMP_critical_name_start(void **name);
void GOMP_critical_name_start(void **name)
{
  NEXT(GOMP_critical_name_start, void(void **));
  next(name);
  __tsan_acquire(name);
}

void GOMP_critical_name_end(void **name);
void GOMP_critical_name_end(void **name)
{
  NEXT(GOMP_critical_name_end, void(void **));
  __tsan_release(name);
  next(name);
}

/* A task runs after its making; its arguments are copied here, because the wrapper needs the function beside them. */
typedef struct {
  body *function;
  char start;
  _Alignas(16) char data[];
} task;

static void run_task(void *place)
{
  task *self = *(task **)place;
  __tsan_acquire(&self->start);
  __tsan_acquire(&task_token);
  self->function(self->data);
  __tsan_release(&task_token);
  free(self);
}

void GOMP_task(body *function, void *data, void (*copy)(void *, void *), long size, long align, _Bool condition, unsigned flags,
               void **depend, int priority);
void GOMP_task(body *function, void *data, void (*copy)(void *, void *), long size, long align, _Bool condition, unsigned flags,
               void **depend, int priority)
{
  NEXT(GOMP_task, void(body *, void *, void (*)(void *, void *), long, long, _Bool, unsigned, void **, int));
  (void)align;
  task *self = malloc(sizeof *self + (size_t)size);
  self->function = function;
  if (copy)
    copy(self->data, data);
  else
    memcpy(self->data, data, (size_t)size);
  __tsan_release(&self->start);
  next(run_task, &self, 0, sizeof self, _Alignof(task *), condition, flags, depend, priority);
}

void GOMP_taskwait(void);
void GOMP_taskwait(void)
{
  NEXT(GOMP_taskwait, void(void));
  next();
  __tsan_acquire(&task_token);
}
