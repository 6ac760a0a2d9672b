/* User routines in a shared library: data that user_shim.c (opening, crashes) and user_calls_shim.c (the calls) share.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef AMONTONS_USER_SHIM_H
#define AMONTONS_USER_SHIM_H
#include <pthread.h>
#include <setjmp.h>
#include <stdint.h>

/* The routines, in the order of user_routines.f90. */
enum { UMAT, FRIC, UINTER, DLOAD, DISP, UAMP, SDVINI, UEL, USDFLD, UEXTERNALDB, UTRACLOAD, CREEP, N_ROUTINES };

enum { TEXT_CAPACITY = 8192, NAME_LENGTH = 80 };

typedef struct {
  void *library;
  void *routine[N_ROUTINES];
  pthread_mutex_t lock;
  double smallest;       /* smallest PNEWDT requested since the last query */
  int is_stopped;        /* XIT_CALLED: or STDB_ABQERR with -3; CRASHED */
  int n_text;
  char text[TEXT_CAPACITY];  /* messages of STDB_ABQERR since the last query */
  char folder[1024], job[256];
  char file[1024];       /* as named by the user */
  uintptr_t low, high;   /* addresses of the library; 0: not known */
} routines;

/* How a routine was left. */
enum { XIT_CALLED = 1, CRASHED = 2 };

/* Where a routine is called; numbers from 1, 0: none. */
typedef struct {
  int routine, element, point, node, step, increment;
} call_place;

/* The current call of a thread. */
extern _Thread_local routines *amontons_user_inside;
extern _Thread_local jmp_buf amontons_user_way_out;
extern _Thread_local call_place amontons_user_place;

/* Gives the handler of signals a stack of its own. */
void amontons_user_give_stack(void);

/* Adds the sentence about the call that has crashed to the messages. */
void amontons_user_report_crash(routines *self);

/* The same of a call that wrote behind its state variables: their number, and the last one that it wrote. */
void amontons_user_report_overrun(routines *self, int nstatv, int last);

/* The same of a call that wrote outside an array: its name, its size, and the number that it wrote, from 1 on. */
void amontons_user_report_outside(routines *self, const char *name, int size, int number);

#endif
