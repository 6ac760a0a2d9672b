/* The calls of user routines, for user_routines.f90: arguments of Abaqus from those of Amontons.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#include "user_shim.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* PNEWDT on entry: a routine that leaves it alone wishes no other increment. */
static const double NO_WISH = 1e36;

/* Around each call: serialized, with return to this point after XIT and after a crash; no call follows a crash. */
#define CALL(self, where, statement)                         \
  do {                                                       \
    pthread_mutex_lock(&(self)->lock);                       \
    if ((self)->is_stopped != CRASHED) {                     \
      amontons_user_give_stack();                                          \
      amontons_user_place = where;                                 \
      amontons_user_inside = (self);                                       \
      switch (setjmp(amontons_user_way_out)) {                             \
      case 0: statement; break;                              \
      case CRASHED: amontons_user_report_crash(self); break;               \
      default: break;                                        \
      }                                                      \
      amontons_user_inside = NULL;                                         \
    }                                                        \
    pthread_mutex_unlock(&(self)->lock);                     \
  } while (0)

/* Numbers behind STATEV that no routine may change: each works on a copy, so that it cannot damage the memory of the job. */
enum { N_GUARDS = 256 };
static const double GUARD = 1.7e-181;

static void guard(double *copy, const double *statev, int nstatv)
{
  memcpy(copy, statev, (size_t)nstatv * sizeof *copy);
  for (int i = 0; i < N_GUARDS; i++) copy[nstatv + i] = GUARD;
}

/* Zero arrays in one block, each between numbers that no routine may change, behind it at least as many as it has itself: a matrix
 * may be filled as one of more rows. Returns the block; NULL: no memory. */
static double *guard_arrays(int n, const int *sizes, double **arrays)
{
  size_t total = N_GUARDS;
  for (int k = 0; k < n; k++) total += 2 * (size_t)sizes[k] + N_GUARDS;
  double *block = malloc(total * sizeof *block);
  if (!block) return NULL;
  for (size_t i = 0; i < total; i++) block[i] = GUARD;
  double *next = block + N_GUARDS;
  for (int k = 0; k < n; k++) {
    arrays[k] = next;
    memset(next, 0, (size_t)sizes[k] * sizeof *next);
    next += 2 * (size_t)sizes[k] + N_GUARDS;
  }
  return block;
}

static int is_changed(const double *guard)
{
  return memcmp(guard, &GUARD, sizeof GUARD) != 0;
}

/* Stops the job with a message if the numbers behind or in front of an array have changed. The half of a gap nearer to an array
 * belongs to it. */
static void check_arrays(routines *self, int n, const char *const *names, const int *sizes, double *const *arrays)
{
  for (int k = 0; k < n; k++) {
    int behind = 0, before = 0;
    for (int i = 0; i < sizes[k] + N_GUARDS / 2; i++)
      if (is_changed(&arrays[k][sizes[k] + i])) behind = i + 1;
    for (int i = 1; i <= N_GUARDS / 2; i++)
      if (is_changed(arrays[k] - i)) before = i;
    if (!behind && !before) continue;
    pthread_mutex_lock(&self->lock);
    if (!self->is_stopped) amontons_user_report_outside(self, names[k], sizes[k], behind ? sizes[k] + behind : 1 - before);
    pthread_mutex_unlock(&self->lock);
    return;
  }
}

/* Takes the state variables from the copy; a call that wrote behind them stops the job with a message. */
static void take_guarded(routines *self, const double *copy, double *statev, int nstatv)
{
  int last = N_GUARDS;
  memcpy(statev, copy, (size_t)nstatv * sizeof *copy);
  while (last > 0 && memcmp(&copy[nstatv + last - 1], &GUARD, sizeof GUARD) == 0) last--;
  if (last == 0) return;
  pthread_mutex_lock(&self->lock);
  if (!self->is_stopped) amontons_user_report_overrun(self, nstatv, nstatv + last);
  pthread_mutex_unlock(&self->lock);
}

typedef void umat_routine(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
                          double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
                          const double *time, const double *dtime, const double *temp, const double *dtemp,
                          const double *predef, const double *dpred, const char *cmname, const int *ndi, const int *nshr,
                          const int *ntens, const int *nstatv, const double *props, const int *nprops, const double *coords,
                          const double *drot, double *pnewdt, const double *celent, const double *dfgrd0,
                          const double *dfgrd1, const int *noel, const int *npt, const int *layer, const int *kspt,
                          const int *jstep, const int *kinc, size_t n_cmname);

/* Arguments of UMAT except STATEV and PROPS; components 11 22 33 12 13 23, of which the routine gets those of its
 * element. The same layout as umat_type of user_routines.f90. */
typedef struct {
  double stress[6], ddsdde[36], energies[3], stran[6], dstran[6], time[2], dtime, temp, dtemp, celent, coords[3], drot[9],
    dfgrd0[9], dfgrd1[9];
  int noel, npt, step, increment;
  int is_taken;          /* 1: valid result; 2: PNEWDT < 1; 0: it has called XIT */
  int ndi, nshr;         /* normal and shear components: 3 3 for solids, 3 1 in plane strain, 2 1 in plane stress, 1 0 in bars */
} umat_values;

/* The positions of the components of an element; their number. */
static int list_components(const umat_values *v, int *place)
{
  for (int i = 0; i < v->ndi; i++) place[i] = i;
  for (int i = 0; i < v->nshr; i++) place[v->ndi + i] = 3 + i;
  return v->ndi + v->nshr;
}

/* UMAT. `fields`: PREDEF and DPRED, nfield numbers each. */
void amontons_user_umat(void *handle, const char *cmname, const double *props, int nprops, double *statev, int nstatv,
                        const double *fields, int nfield, umat_values *v)
{
  routines *self = handle;
  const int one = 1;
  int place[6];
  const int ntens = list_components(v, place);
  double stress[6] = {0}, ddsdde[36] = {0}, stran[6] = {0}, dstran[6] = {0};
  for (int i = 0; i < ntens; i++) {
    stress[i] = v->stress[place[i]];
    stran[i] = v->stran[place[i]];
    dstran[i] = v->dstran[place[i]];
  }
  const int jstep[4] = {v->step, 1, 0, 0};
  double rpl = 0, drpldt = 0, ddsddt[6] = {0}, drplde[6] = {0}, pnewdt = NO_WISH, copy[nstatv + N_GUARDS];
  umat_routine *umat = (umat_routine *)(uintptr_t)self->routine[UMAT];
  const call_place where = {UMAT, v->noel, v->npt, 0, v->step, v->increment};
  guard(copy, statev, nstatv);
  CALL(self, where,
       umat(stress, copy, ddsdde, &v->energies[0], &v->energies[1], &v->energies[2], &rpl, ddsddt, drplde, &drpldt, stran,
            dstran, v->time, &v->dtime, &v->temp, &v->dtemp, fields, fields + nfield, cmname, &v->ndi, &v->nshr, &ntens, &nstatv, props,
            &nprops, v->coords, v->drot, &pnewdt, &v->celent, v->dfgrd0, v->dfgrd1, &v->noel, &v->npt, &one, &one, jstep,
            &v->increment, NAME_LENGTH));
  take_guarded(self, copy, statev, nstatv);
  memset(v->stress, 0, sizeof v->stress);
  memset(v->ddsdde, 0, sizeof v->ddsdde);
  for (int j = 0; j < ntens; j++) {
    v->stress[place[j]] = stress[j];
    for (int i = 0; i < ntens; i++) v->ddsdde[6 * place[j] + place[i]] = ddsdde[ntens * j + i];
  }
  pthread_mutex_lock(&self->lock);
  v->is_taken = self->is_stopped ? 0 : pnewdt < 1 ? 2 : 1;
  if (pnewdt > 0 && pnewdt < self->smallest) self->smallest = pnewdt;
  pthread_mutex_unlock(&self->lock);
}

typedef void sdvini_routine(double *statev, const double *coords, const int *nstatv, const int *ncrds, const int *noel,
                            const int *npt, const int *layer, const int *kspt);

/* SDVINI. 1: done; 0: it has called XIT. */
void amontons_user_sdvini(void *handle, double *statev, int nstatv, const double *coords, int noel, int npt, int *is_taken)
{
  routines *self = handle;
  const int ncrds = 3, one = 1;
  sdvini_routine *sdvini = (sdvini_routine *)(uintptr_t)self->routine[SDVINI];
  const call_place where = {SDVINI, noel, npt, 0, 0, 0};
  double copy[nstatv + N_GUARDS];
  guard(copy, statev, nstatv);
  CALL(self, where,
       sdvini(copy, coords, &nstatv, &ncrds, &noel, &npt, &one, &one));
  take_guarded(self, copy, statev, nstatv);
  *is_taken = !self->is_stopped;
}

typedef void uexternaldb_routine(const int *lop, const int *lrestart, const double *time, const double *dtime,
                                 const int *kstep, const int *kinc);

/* UEXTERNALDB. `times`: step, total, increment; `counts`: LOP, step, increment. */
void amontons_user_uexternaldb(void *handle, const double *times, const int *counts)
{
  routines *self = handle;
  const int none = 0;
  uexternaldb_routine *uexternaldb = (uexternaldb_routine *)(uintptr_t)self->routine[UEXTERNALDB];
  const call_place where = {UEXTERNALDB, 0, 0, 0, counts[1], counts[2]};
  CALL(self, where, uexternaldb(&counts[0], &none, times, &times[2], &counts[1], &counts[2]));
}

typedef void dload_routine(double *f, const int *kstep, const int *kinc, const double *time, const int *noel, const int *npt,
                           const int *layer, const int *kspt, const double *coords, const int *jltyp, const char *sname,
                           size_t n_sname);

/* DLOAD: the magnitude at a point of an element or a face. `counts`: step, increment, noel, npt, jltyp. */
void amontons_user_dload(void *handle, double *f, const double *time, const double *coords, const char *sname,
                         const int *counts, int *is_taken)
{
  routines *self = handle;
  const int one = 1;
  dload_routine *dload = (dload_routine *)(uintptr_t)self->routine[DLOAD];
  const call_place where = {DLOAD, counts[2], counts[3], 0, counts[0], counts[1]};
  CALL(self, where,
       dload(f, &counts[0], &counts[1], time, &counts[2], &counts[3], &one, &one, coords, &counts[4], sname, NAME_LENGTH));
  *is_taken = !self->is_stopped;
}

typedef void utracload_routine(double *alpha, double *t_user, const int *kstep, const int *kinc, const double *time,
                               const int *noel, const int *npt, const double *coords, const double *dircos, const int *jltyp,
                               const char *sname, size_t n_sname);

/* JLTYP / 10 of shear tractions. */
enum { SHEAR_TRACTIONS = 51 };

/* Ends the job with a message. */
static void stop_with(routines *self, const char *text)
{
  const size_t length = strlen(text);
  if ((size_t)self->n_text + length + 1 <= TEXT_CAPACITY) {
    memcpy(self->text + self->n_text, text, length);
    self->n_text += (int)length;
  }
  self->is_stopped = XIT_CALLED;
}

/* Ends the job where a magnitude has no direction, or a shear traction none along the face. */
static void check_direction(routines *self, double alpha, const double *t_user, const double *normal, int jltyp)
{
  const double smallest = 1e-6;   /* part along the face of a unit vector */
  double along[3], size = 0, part = 0;
  const double across = t_user[0] * normal[0] + t_user[1] * normal[1] + t_user[2] * normal[2];
  for (int i = 0; i < 3; i++) {
    along[i] = t_user[i] - (jltyp / 10 == SHEAR_TRACTIONS ? across * normal[i] : 0);
    size += t_user[i] * t_user[i];
    part += along[i] * along[i];
  }
  if (alpha == 0 || (size > 0 && sqrt(part) >= smallest * sqrt(size))) return;
  stop_with(self, "*ERROR: UTRACLOAD gives a magnitude without a direction: T_USER is zero, or normal to a face under shear.\n");
}

/* UTRACLOAD: magnitude and direction of a traction at a point of a face. `counts` as of DLOAD; `dircos`: its axes, the third is
 * the inward normal. */
void amontons_user_utracload(void *handle, double *alpha, double *t_user, const double *time, const double *coords,
                             const double *dircos, const char *sname, const int *counts, int *is_taken)
{
  routines *self = handle;
  utracload_routine *utracload = (utracload_routine *)(uintptr_t)self->routine[UTRACLOAD];
  const call_place where = {UTRACLOAD, counts[2], counts[3], 0, counts[0], counts[1]};
  CALL(self, where,
       (utracload(alpha, t_user, &counts[0], &counts[1], time, &counts[2], &counts[3], coords, dircos, &counts[4], sname,
                  NAME_LENGTH),
        check_direction(self, *alpha, t_user, dircos + 6, counts[4])));
  *is_taken = !self->is_stopped;
}

typedef void creep_routine(double *decra, double *deswa, double *statev, double *serd, const double *ec, const double *esw,
                           const double *p, const double *qtild, const double *temp, const double *dtemp, const double *predef,
                           const double *dpred, const double *time, const double *dtime, const char *cmname, const int *leximp,
                           const int *lend, const double *coords, const int *nstatv, const int *noel, const int *npt,
                           const int *layer, const int *kspt, const int *kstep, const int *kinc, size_t n_cmname);

/* creep_type of user_routines.f90. */
typedef struct {
  double decra[5], ec[2], p, qtild, temp, dtemp, time[3], dtime, coords[3];
  int noel, npt, step, increment;
  int is_taken;
} creep_values;

/* Ends the job where CREEP gives what is no creep. */
static void check_creep(routines *self, double decra, double deswa)
{
  if (deswa != 0)
    stop_with(self, "*ERROR: CREEP gives a swelling, DESWA(1), which is not supported.\n");
  else if (decra < 0)
    stop_with(self, "*ERROR: CREEP gives a negative increment of the creep strain, DECRA(1).\n");
}

/* CREEP: implicit, at the end of the increment, without STATEV and field variables. */
void amontons_user_creep(void *handle, const char *cmname, creep_values *v)
{
  routines *self = handle;
  const int one = 1, none = 0;
  const double nothing[2] = {0};
  double deswa[5] = {0}, serd = 0, copy[N_GUARDS], no_state[1];
  creep_routine *creep = (creep_routine *)(uintptr_t)self->routine[CREEP];
  const call_place where = {CREEP, v->noel, v->npt, 0, v->step, v->increment};
  memset(v->decra, 0, sizeof v->decra);
  guard(copy, no_state, none);
  CALL(self, where,
       (creep(v->decra, deswa, copy, &serd, v->ec, nothing, &v->p, &v->qtild, &v->temp, &v->dtemp, nothing, nothing, v->time,
              &v->dtime, cmname, &one, &one, v->coords, &none, &v->noel, &v->npt, &one, &one, &v->step, &v->increment, NAME_LENGTH),
        check_creep(self, v->decra[0], deswa[0])));
  take_guarded(self, copy, no_state, none);
  v->is_taken = !self->is_stopped;
}

typedef void disp_routine(double *u, const int *kstep, const int *kinc, const double *time, const int *node, const int *noel,
                          const int *jdof, const double *coords);

/* DISP: a prescribed displacement. `time`: step, total, increment; `counts`: step, increment, node, jdof. */
void amontons_user_disp(void *handle, double *u, const double *time, const double *coords, const int *counts, int *is_taken)
{
  routines *self = handle;
  const int none = 0;
  double answer[3] = {*u, 0, 0};
  disp_routine *disp = (disp_routine *)(uintptr_t)self->routine[DISP];
  const call_place where = {DISP, 0, 0, counts[2], counts[0], counts[1]};
  CALL(self, where,
       disp(answer, &counts[0], &counts[1], time, &counts[2], &none, &counts[3], coords));
  *u = answer[0];
  *is_taken = !self->is_stopped;
}

typedef void uamp_routine(const char *name, const double *time, const double *old, const double *dt, const int *nprops,
                          const double *props, const int *nsvars, double *svars, const int *flags, const int *nsensor,
                          const double *sensor_values, const char *sensor_names, const int *sensor_table, double *value,
                          int *defined, double *derivative, double *second, double *integral, double *double_integral,
                          size_t n_name, size_t n_sensor_names);

/* uamp_type of user_routines.f90. */
typedef struct {
  double time[2], dt, old, value;   /* time: step, total */
  int is_first, step, increment;    /* is_first: the call before the first increment */
  int is_taken;
} uamp_values;

/* UAMP: the value of an amplitude; there are no sensors. */
void amontons_user_uamp(void *handle, const char *name, const double *props, int nprops, double *svars, int nsvars,
                        uamp_values *v)
{
  routines *self = handle;
  const int none = 0;
  const int flags[4] = {v->is_first, 0, v->step, v->increment};
  int defined[4] = {0, 0, 0, 0};
  const double no_sensor = 0;
  double derivative = 0, second = 0, integral = 0, double_integral = 0;
  char no_name[NAME_LENGTH];
  memset(no_name, ' ', sizeof no_name);
  uamp_routine *uamp = (uamp_routine *)(uintptr_t)self->routine[UAMP];
  const call_place where = {UAMP, 0, 0, 0, v->step, v->increment};
  CALL(self, where,
       uamp(name, v->time, &v->old, &v->dt, &nprops, props, &nsvars, svars, flags, &none, &no_sensor, no_name, &none,
            &v->value, defined, &derivative, &second, &integral, &double_integral, NAME_LENGTH, NAME_LENGTH));
  v->is_taken = !self->is_stopped;
}

typedef void fric_routine(int *lm, double *tau, double *ddtddg, double *ddtddp, double *dslip, double *sed, double *sfd,
                          double *ddtddt, double *pnewdt, double *statev, const double *dgam, const double *taulm,
                          const double *press, const double *dpress, const double *ddpddh, const double *slip,
                          const int *kstep, const int *kinc, const double *time, const double *dtime, const int *noel,
                          const char *ciname, const char *slname, const char *msname, const int *npt, const int *node,
                          const int *npatch, const double *coords, const double *rcoord, const double *drot,
                          const double *temp, const double *predef, const int *nfdir, const int *mcrd, const int *npred,
                          const int *nstatv, const double *chrlngth, const double *props, const int *nprops, size_t n_ciname,
                          size_t n_slname, size_t n_msname);

/* fric_type of user_routines.f90. */
typedef struct {
  double tau[2], ddtddg[4], ddtddp[2], dslip[2], sed, sfd, dgam[2], taulm[2], press, dpress, ddpddh, slip[2], time[2], dtime,
    coords[3], length, temp[2];
  int lm, node, nfdir, mcrd, step, increment, is_taken;
} fric_values;

/* FRIC. `names`: interaction, slave, master, NAME_LENGTH letters each. */
void amontons_user_fric(void *handle, const char *names, const double *props, int nprops, double *statev, int nstatv,
                        fric_values *v)
{
  routines *self = handle;
  const int none = 0, one = 1;
  const double turn[4] = {1, 0, 0, 1}, no_field[2] = {0, 0};
  double ddtddt[4] = {0}, pnewdt = NO_WISH;
  fric_routine *fric = (fric_routine *)(uintptr_t)self->routine[FRIC];
  const call_place where = {FRIC, 0, 0, v->node, v->step, v->increment};
  CALL(self, where,
       fric(&v->lm, v->tau, v->ddtddg, v->ddtddp, v->dslip, &v->sed, &v->sfd, ddtddt, &pnewdt, statev, v->dgam, v->taulm,
            &v->press, &v->dpress, &v->ddpddh, v->slip, &v->step, &v->increment, v->time, &v->dtime, &none, names, names +
            NAME_LENGTH, names + 2 * NAME_LENGTH, &one, &v->node, &none, v->coords, v->coords, turn, v->temp, no_field,
            &v->nfdir, &v->mcrd, &none, &nstatv, &v->length, props, &nprops, NAME_LENGTH, NAME_LENGTH, NAME_LENGTH));
  v->is_taken = !self->is_stopped;
}

typedef void uinter_routine(double *stress, double *ddsddr, double *dviscous, double *dstructural, double *flux, double *ddfddt,
                            double *ddsddt, double *ddfddr, double *statev, double *sed, double *sfd, double *spd, double *svd,
                            double *scd, double *pnewdt, const double *rdisp, const double *drdisp, const double *temp,
                            const double *dtemp, const double *predef, const double *dpred, const double *time,
                            const double *dtime, const double *freqr, const char *ciname, const char *slname,
                            const char *msname, const double *props, const double *coords, const double *alocaldir,
                            const double *drot, const double *area, const double *chrlngth, const int *node, const int *ndir,
                            const int *nstatv, const int *npred, const int *nprops, const int *mcrd, const int *kstep,
                            const int *kinc, const int *kit, const int *linper, int *lopenclose, int *lstate, int *lsdi,
                            const int *lprint, size_t n_ciname, size_t n_slname, size_t n_msname);

/* uinter_type of user_routines.f90. */
typedef struct {
  double stress[3], ddsddr[9], sed, sfd, rdisp[3], drdisp[3], temp[2], time[2], dtime, coords[3], axes[9], area;
  int node, ndir, mcrd, step, increment, is_closed, is_taken;
} uinter_values;

/* UINTER: in the plane the matrices have two rows. */
void amontons_user_uinter(void *handle, const char *names, const double *props, int nprops, double *statev, int nstatv,
                          uinter_values *v)
{
  routines *self = handle;
  const int none = 0, n = v->ndir;
  const double turn[4] = {1, 0, 0, 1}, nothing[6] = {0}, length = sqrt(v->area);
  double d[9] = {0}, viscous[9] = {0}, structural[9] = {0}, flux[2] = {0}, ddfddt[4] = {0}, ddsddt[6] = {0}, ddfddr[6] = {0};
  double spd = 0, svd = 0, scd = 0, pnewdt = NO_WISH;
  int state = -1, sdi = 0;
  uinter_routine *uinter = (uinter_routine *)(uintptr_t)self->routine[UINTER];
  const call_place where = {UINTER, 0, 0, v->node, v->step, v->increment};
  CALL(self, where,
       uinter(v->stress, d, viscous, structural, flux, ddfddt, ddsddt, ddfddr, statev, &v->sed, &v->sfd, &spd, &svd, &scd,
              &pnewdt, v->rdisp, v->drdisp, v->temp, nothing, nothing, nothing, v->time, &v->dtime, nothing, names, names +
              NAME_LENGTH, names + 2 * NAME_LENGTH, props, v->coords, v->axes, turn, &v->area, &length, &v->node, &n, &nstatv,
              &none, &nprops, &v->mcrd, &v->step, &v->increment, &none, &none, &v->is_closed, &state, &sdi, &none, NAME_LENGTH,
              NAME_LENGTH, NAME_LENGTH));
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) v->ddsddr[3 * j + i] = d[n * j + i];
  if (n < 3) v->stress[2] = 0;
  v->is_taken = !self->is_stopped;
}

typedef void uel_routine(double *rhs, double *amatrx, double *svars, double *energy, const int *ndofel, const int *nrhs,
                         const int *nsvars, const double *props, const int *nprops, const double *coords, const int *mcrd,
                         const int *nnode, const double *u, const double *du, const double *v, const double *a, const int *jtype,
                         const double *time, const double *dtime, const int *kstep, const int *kinc, const int *jelem,
                         const double *params, const int *ndload, const int *jdltyp, const double *adlmag, const double *predef,
                         const int *npredf, const int *lflags, const int *mlvarx, const double *ddlmag, const int *mdload,
                         double *pnewdt, const int *jprops, const int *njprop, const double *period);

/* uel_type of user_routines.f90. */
typedef struct {
  double time[2], dtime, period;    /* time: step, total */
  int lflags[10], ndofel, nsvars, mcrd, nnode, npredf, jtype, element, step, increment;
  int is_taken;                     /* 1: valid result; 2: PNEWDT < 1; 0: it has called XIT */
} uel_values;

/* The arrays of UEL that it may damage by writing outside of them. */
enum { RHS, AMATRX, SVARS, ENERGY, COORDS, U, DU, V, A, PREDEF, N_UEL_ARRAYS, N_ENERGIES = 8 };
static const char *const UEL_ARRAYS[N_UEL_ARRAYS] = {"RHS", "AMATRX", "SVARS", "ENERGY", "COORDS", "U", "DU", "V", "A", "PREDEF"};

/* UEL. `inputs`: coords, u, du, predef; `memory`: svars, energy; `counts`: nprops, njprop. There are no loads on user elements and
 * no velocities. */
void amontons_user_uel(void *handle, const double *props, const int *jprops, const int *counts, const double *inputs, double *rhs,
                       double *amatrx, double *memory, uel_values *v)
{
  routines *self = handle;
  const int one = 1, none = 0, no_type = 0;
  const double no_load = 0, params[3] = {0};
  const int n = v->ndofel, sizes[N_UEL_ARRAYS] = {n, n * n, v->nsvars, N_ENERGIES, v->mcrd * v->nnode, n, n, n, n,
                                                  2 * v->npredf * v->nnode};
  double pnewdt = NO_WISH, *array[N_UEL_ARRAYS], *block = guard_arrays(N_UEL_ARRAYS, sizes, array);
  uel_routine *uel = (uel_routine *)(uintptr_t)self->routine[UEL];
  const call_place where = {UEL, v->element, 0, 0, v->step, v->increment};
  v->is_taken = 0;
  if (!block) return;
  memcpy(array[SVARS], memory, (size_t)v->nsvars * sizeof *memory);
  memcpy(array[ENERGY], memory + v->nsvars, N_ENERGIES * sizeof *memory);
  for (int k = COORDS; k <= PREDEF; inputs += k == V || k == A ? 0 : sizes[k], k++)
    if (k != V && k != A) memcpy(array[k], inputs, (size_t)sizes[k] * sizeof *inputs);
  CALL(self, where,
       uel(array[RHS], array[AMATRX], array[SVARS], array[ENERGY], &v->ndofel, &one, &v->nsvars, props, &counts[0], array[COORDS],
           &v->mcrd, &v->nnode, array[U], array[DU], array[V], array[A], &v->jtype, v->time, &v->dtime, &v->step, &v->increment,
           &v->element, params, &none, &no_type, &no_load, array[PREDEF], &v->npredf, v->lflags, &v->ndofel, &no_load, &one,
           &pnewdt, jprops, &counts[1], &v->period));
  check_arrays(self, N_UEL_ARRAYS, UEL_ARRAYS, sizes, array);
  memcpy(rhs, array[RHS], (size_t)n * sizeof *rhs);
  memcpy(amatrx, array[AMATRX], (size_t)n * (size_t)n * sizeof *amatrx);
  memcpy(memory, array[SVARS], (size_t)v->nsvars * sizeof *memory);
  memcpy(memory + v->nsvars, array[ENERGY], N_ENERGIES * sizeof *memory);
  free(block);
  pthread_mutex_lock(&self->lock);
  v->is_taken = self->is_stopped ? 0 : pnewdt < 1 ? 2 : 1;
  if (pnewdt > 0 && pnewdt < self->smallest) self->smallest = pnewdt;
  pthread_mutex_unlock(&self->lock);
}

typedef void usdfld_routine(double *field, double *statev, double *pnewdt, const double *direct, const double *t,
                            const double *celent, const double *time, const double *dtime, const char *cmname,
                            const char *orname, const int *nfield, const int *nstatv, const int *noel, const int *npt,
                            const int *layer, const int *kspt, const int *kstep, const int *kinc, const int *ndi,
                            const int *nshr, const double *coord, const int *jmac, const int *jmatyp, const int *matlayo,
                            const int *laccfla, size_t n_cmname, size_t n_orname);

/* usdfld_type of user_routines.f90. Tensors: 11 22 33 12 13 23, strains with engineering shears. */
typedef struct {
  double stress[6], strain[6], plastic[7], time[2], dtime, temp, celent, coords[3], direct[9];   /* plastic: strain, PEEQ */
  int noel, npt, ndi, nshr, nfield, nstatv, step, increment;
  int is_taken;          /* 1: valid result; 2: PNEWDT < 1; 0: it has called XIT */
} usdfld_values;

enum { N_ARRAY = 15 };   /* length of ARRAY, JARRAY and FLGRAY */

/* What GETVRM reads: the point of the current call. */
static _Thread_local const usdfld_values *point_of_call;
static _Thread_local const double *fields_of_call, *statev_of_call;

void amontons_user_usdfld(void *handle, const char *names, double *field, double *statev, usdfld_values *v)
{
  routines *self = handle;
  const int one = 1, none = 0;
  const double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double pnewdt = NO_WISH, copy[v->nstatv + N_GUARDS];
  usdfld_routine *usdfld = (usdfld_routine *)(uintptr_t)self->routine[USDFLD];
  const call_place where = {USDFLD, v->noel, v->npt, 0, v->step, v->increment};
  double given[v->nfield + N_GUARDS];
  point_of_call = v;
  fields_of_call = given;
  statev_of_call = copy;
  guard(given, field, v->nfield);
  guard(copy, statev, v->nstatv);
  CALL(self, where,
       usdfld(given, copy, &pnewdt, v->direct, turn, &v->celent, v->time, &v->dtime, names, names + NAME_LENGTH, &v->nfield,
              &v->nstatv, &v->noel, &v->npt, &one, &one, &v->step, &v->increment, &v->ndi, &v->nshr, v->coords, &none, &none,
              &none, &none, NAME_LENGTH, NAME_LENGTH));
  take_guarded(self, copy, statev, v->nstatv);
  memcpy(field, given, (size_t)v->nfield * sizeof *field);
  for (int i = N_GUARDS; i > 0; i--)
    if (is_changed(&given[v->nfield + i - 1])) {
      pthread_mutex_lock(&self->lock);
      if (!self->is_stopped) amontons_user_report_outside(self, "FIELD", v->nfield, v->nfield + i);
      pthread_mutex_unlock(&self->lock);
      break;
    }
  point_of_call = NULL;
  pthread_mutex_lock(&self->lock);
  v->is_taken = self->is_stopped ? 0 : pnewdt < 1 ? 2 : 1;
  if (pnewdt > 0 && pnewdt < self->smallest) self->smallest = pnewdt;
  pthread_mutex_unlock(&self->lock);
}

/* The components of a tensor that the element has. */
static void give_tensor(const double *tensor, double *array)
{
  for (int i = 0; i < point_of_call->ndi; i++) array[i] = tensor[i];
  for (int i = 0; i < point_of_call->nshr; i++) array[point_of_call->ndi + i] = tensor[3 + i];
}

/* Invariants of the stress: MISES, none for TRESC, PRESS. */
static void give_invariants(const double *s, double *array)
{
  const double p = -(s[0] + s[1] + s[2]) / 3;
  const double a = s[0] + p, b = s[1] + p, c = s[2] + p;
  array[0] = sqrt(1.5 * (a * a + b * b + c * c + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])));
  array[2] = p;
}

/* The first values, as many as the array takes. */
static void give_first(const double *values, int n, double *array)
{
  memcpy(array, values, (size_t)(n < N_ARRAY ? n : N_ARRAY) * sizeof *array);
}

/* SUBROUTINE GETVRM(VAR, ARRAY, JARRAY, FLGRAY, JRCD, JMAC, JMATYP, MATLAYO, LACCFLA): S, SINV, E, LE, PE, PEEQ, SDV, FV, TEMP and
 * COORD of the point at the start of the increment. JRCD = 1: another variable. */
void getvrm_(const char *var, double *array, int *jarray, char *flgray, int *jrcd, const int *jmac, const int *jmatyp,
             const int *matlayo, const int *laccfla, size_t n_var, size_t n_flgray);
void getvrm_(const char *var, double *array, int *jarray, char *flgray, int *jrcd, const int *jmac, const int *jmatyp,
             const int *matlayo, const int *laccfla, size_t n_var, size_t n_flgray)
{
  enum { LETTERS = 8 };
  char name[LETTERS + 1] = "";
  const usdfld_values *v = point_of_call;
  (void)jmac, (void)jmatyp, (void)matlayo, (void)laccfla;
  while (n_var > 0 && var[n_var - 1] == ' ') n_var--;
  for (size_t i = 0; i < n_var && i < LETTERS; i++) name[i] = (char)(var[i] >= 'a' && var[i] <= 'z' ? var[i] - 'a' + 'A' : var[i]);
  memset(array, 0, N_ARRAY * sizeof *array);
  memset(jarray, 0, N_ARRAY * sizeof *jarray);
  if (n_flgray == 3) memset(flgray, ' ', N_ARRAY * n_flgray);
  *jrcd = 0;
  if (!v || n_var > LETTERS) *jrcd = 1;
  else if (!strcmp(name, "S")) give_tensor(v->stress, array);
  else if (!strcmp(name, "SINV")) give_invariants(v->stress, array);
  else if (!strcmp(name, "E") || !strcmp(name, "LE")) give_tensor(v->strain, array);
  else if (!strcmp(name, "PE")) give_tensor(v->plastic, array), array[6] = v->plastic[6];
  else if (!strcmp(name, "PEEQ")) array[0] = v->plastic[6];
  else if (!strcmp(name, "SDV")) give_first(statev_of_call, v->nstatv, array);
  else if (!strcmp(name, "FV")) give_first(fields_of_call, v->nfield, array);
  else if (!strcmp(name, "TEMP")) array[0] = v->temp;
  else if (!strcmp(name, "COORD")) memcpy(array, v->coords, sizeof v->coords);
  else *jrcd = 1;
}
