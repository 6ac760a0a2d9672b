/* User shim for user_routines.f90: user routines in a shared library: compiled if they are Fortran, loaded, and called.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The routines have the argument lists of Abaqus. Calls are serialized, whatever the number of threads: common
 * blocks and saved variables of the user are safe. XIT and STDB_ABQERR are defined here; XIT leaves the routine, and its
 * caller gets a status. A routine that crashes is left in the same way. All state is in the handle, except a thread's current
 * call and, while a library is open, the signal handlers of the process. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <link.h>
#include <ucontext.h>
#endif

/* The routines, in the order of user_routines.f90. */
enum { UMAT, FRIC, UINTER, DLOAD, DISP, UAMP, SDVINI, UEL, N_ROUTINES };
static const char *const NAMES[N_ROUTINES] = {"umat", "fric", "uinter", "dload", "disp", "uamp", "sdvini", "uel"};
static const char *const CAPITALS[N_ROUTINES] = {"UMAT", "FRIC", "UINTER", "DLOAD", "DISP", "UAMP", "SDVINI", "UEL"};

/* Status codes of opening; the same numbers as in user_routines.f90. */
enum { OPENED = 0, NO_FILE = 1, NOT_COMPILED = 2, NOT_LOADED = 3, NO_ROUTINE = 4, NO_MEMORY = 5 };

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

/* How a routine was left, and the exit code of a job whose routine ends the process (EXIT_NOT_CONVERGED of errors.f90). */
enum { XIT_CALLED = 1, CRASHED = 2, EXIT_CODE = 5 };

/* Where a routine is called; numbers from 1, 0: none. */
typedef struct {
  int routine, element, point, node, step, increment;
} call_place;

/* The current call of a thread. */
static _Thread_local routines *inside;
static _Thread_local jmp_buf way_out;
static _Thread_local call_place place_of_call;
static _Thread_local int caught;   /* signal */

/* --- procedures that the routines may call ------------------------------------------------------------------------ */

static void say(routines *self, const char *text, size_t length)
{
  if ((size_t)self->n_text + length + 2 > TEXT_CAPACITY) return;
  memcpy(self->text + self->n_text, text, length);
  self->n_text += (int)length;
  self->text[self->n_text++] = '\n';
}

static void leave(void)
{
  inside->is_stopped = XIT_CALLED;
  longjmp(way_out, XIT_CALLED);
}

/* SUBROUTINE XIT */
void xit_(void);
void xit_(void)
{
  if (inside) leave();
}

/* The next item of a list of STDB_ABQERR: %I from intv, %R from realv, %S from charv (8 letters each). */
static int put_item(char *to, size_t capacity, char kind, const int *intv, const double *realv, const char *charv, int *next)
{
  if (kind == 'I') return snprintf(to, capacity, "%d", intv[next[0]++]);
  if (kind == 'R') return snprintf(to, capacity, "%g", realv[next[1]++]);
  int length = 8;
  const char *from = charv + 8 * next[2]++;
  while (length > 0 && from[length - 1] == ' ') length--;
  return snprintf(to, capacity, "%.*s", length, from);
}

/* SUBROUTINE STDB_ABQERR(LOP, STRING, INTV, REALV, CHARV): 1 a note, -1 a warning, -2 an error, -3 an error that ends
 * the analysis at once. */
void stdb_abqerr_(const int *lop, const char *string, const int *intv, const double *realv, const char *charv,
                  size_t n_string, size_t n_charv);
void stdb_abqerr_(const int *lop, const char *string, const int *intv, const double *realv, const char *charv,
                  size_t n_string, size_t n_charv)
{
  char line[1024];
  size_t n = 0;
  int next[3] = {0, 0, 0};
  (void)n_charv;
  if (!inside) return;
  n += (size_t)snprintf(line, sizeof line, "%s", *lop == 1 ? "" : *lop == -1 ? "*WARNING: " : "*ERROR: ");
  while (n_string > 0 && string[n_string - 1] == ' ') n_string--;
  for (size_t i = 0; i < n_string && n + 64 < sizeof line; i++) {
    if (string[i] == '%' && i + 1 < n_string && strchr("IRS", string[i + 1])) {
      n += (size_t)put_item(line + n, sizeof line - n, string[++i], intv, realv, charv, next);
    } else {
      line[n++] = string[i];
    }
  }
  say(inside, line, n);
  if (*lop <= -3) leave();
}

static void give_text(char *to, size_t capacity, int *length, const char *from)
{
  size_t n = strlen(from) < capacity ? strlen(from) : capacity;
  memset(to, ' ', capacity);
  memcpy(to, from, n);
  *length = (int)n;
}

/* SUBROUTINE GETOUTDIR(OUTDIR, LENOUTDIR), GETJOBNAME(JOBNAME, LENJOBNAME) */
void getoutdir_(char *to, int *length, size_t capacity);
void getoutdir_(char *to, int *length, size_t capacity)
{
  give_text(to, capacity, length, inside ? inside->folder : ".");
}

void getjobname_(char *to, int *length, size_t capacity);
void getjobname_(char *to, int *length, size_t capacity)
{
  give_text(to, capacity, length, inside ? inside->job : "job");
}

/* --- routines that crash ------------------------------------------------------------------------------------------ */

enum { N_SIGNALS = 5, STACK_SIZE = 65536 };
static const int SIGNALS[N_SIGNALS] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
static const char *const CAUSES[N_SIGNALS] = {
  "it used memory that it does not own (an array index out of bounds, a missing argument, or arrays too large for the stack)",
  "it used memory that it does not own (an array index out of bounds, or a missing argument)",
  "it divided an integer by zero",
  "it ran into invalid code (a call with wrong arguments)",
  "it was aborted (often by memory overwritten before)"};
static struct sigaction handlers_before[N_SIGNALS];
static int n_open_libraries, is_exit_watched;
static _Thread_local char signal_stack[STACK_SIZE];
static _Thread_local int has_signal_stack;
static pthread_mutex_t handlers_lock = PTHREAD_MUTEX_INITIALIZER;

/* The sentence about a call that went wrong. */
static int describe_call(const routines *self, const char *cause, char *to, int capacity)
{
  const call_place *at = &place_of_call;
  int n = snprintf(to, (size_t)capacity, "The routine %s of %s has crashed", CAPITALS[at->routine], self->file);
  if (at->element > 0) n += snprintf(to + n, (size_t)(capacity - n), " at element %d", at->element);
  if (at->point > 0) n += snprintf(to + n, (size_t)(capacity - n), ", integration point %d", at->point);
  if (at->node > 0) n += snprintf(to + n, (size_t)(capacity - n), " at node %d", at->node);
  if (at->increment > 0) n += snprintf(to + n, (size_t)(capacity - n), " in increment %d of step %d", at->increment, at->step);
  n += snprintf(to + n, (size_t)(capacity - n), ": %s.", cause);
  return n < capacity ? n : capacity - 1;
}

static const char *cause_of(int number)
{
  for (int i = 0; i < N_SIGNALS; i++)
    if (SIGNALS[i] == number) return CAUSES[i];
  return "";
}

/* The Fortran units, if the run-time library has this. */
extern void _gfortran_flush_i4(void *unit) __attribute__((weak));

/* Ends the process with the sentence about the current call. */
static void end_process(const char *cause)
{
  static const char start[] = "*ERROR: ";
  char text[2048];
  routines *self = inside;
  inside = NULL;
  int n = describe_call(self, cause, text, (int)sizeof text - 100);
  n += snprintf(text + n, 100, " When it is repaired, amontons --resume continues the job from its checkpoint.\n");
  if (write(STDOUT_FILENO, start, sizeof start - 1) < 0 || write(STDOUT_FILENO, text, (size_t)n) < 0) _exit(EXIT_CODE);
  _exit(EXIT_CODE);
}

/* Whether a signal comes from the code of the library itself, so that no lock of the C library is held. */
static int is_from_library(const routines *self, void *context)
{
  uintptr_t address = 0;
#if defined(__linux__) && defined(__x86_64__)
  address = (uintptr_t)((ucontext_t *)context)->uc_mcontext.gregs[REG_RIP];
#elif defined(__linux__) && defined(__aarch64__)
  address = (uintptr_t)((ucontext_t *)context)->uc_mcontext.pc;
#else
  (void)context;
#endif
  return address >= self->low && address < self->high;
}

static void handle_signal(int number, siginfo_t *info, void *context)
{
  (void)info;
  if (!inside) {
    for (int i = 0; i < N_SIGNALS; i++)
      if (SIGNALS[i] == number) sigaction(number, &handlers_before[i], NULL);
    raise(number);
    return;
  }
  if (!is_from_library(inside, context)) end_process(cause_of(number));
  caught = number;
  inside->is_stopped = CRASHED;
  longjmp(way_out, CRASHED);
}

/* A routine that ends the process: STOP, or an error of the Fortran run-time library. */
static void handle_exit(void)
{
  if (!inside) return;
  fflush(NULL);
  if (_gfortran_flush_i4) _gfortran_flush_i4(NULL);
  end_process("it ended the process, by STOP or by an error of the Fortran library");
}

/* Catches signals while a library is open; those outside its routines go to the handlers before. */
static void catch_signals(void)
{
  struct sigaction action = {0};
  action.sa_sigaction = handle_signal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
  sigemptyset(&action.sa_mask);
  pthread_mutex_lock(&handlers_lock);
  if (n_open_libraries++ == 0)
    for (int i = 0; i < N_SIGNALS; i++) sigaction(SIGNALS[i], &action, &handlers_before[i]);
  if (!is_exit_watched) is_exit_watched = atexit(handle_exit) == 0;
  pthread_mutex_unlock(&handlers_lock);
}

static void restore_signals(void)
{
  pthread_mutex_lock(&handlers_lock);
  if (--n_open_libraries == 0)
    for (int i = 0; i < N_SIGNALS; i++) sigaction(SIGNALS[i], &handlers_before[i], NULL);
  pthread_mutex_unlock(&handlers_lock);
}

/* A stack for the handler of each thread: that of the routine may be full. */
static void give_stack(void)
{
  stack_t stack = {.ss_sp = signal_stack, .ss_size = sizeof signal_stack};
  if (has_signal_stack) return;
  has_signal_stack = 1;
  sigaltstack(&stack, NULL);
}

#ifdef __linux__
/* The addresses of a library. */
static int find_addresses(struct dl_phdr_info *info, size_t size, void *data)
{
  routines *self = data;
  struct link_map *map = NULL;
  (void)size;
  if (dlinfo(self->library, RTLD_DI_LINKMAP, &map) || info->dlpi_addr != map->l_addr) return 0;
  for (int i = 0; i < info->dlpi_phnum; i++) {
    if (info->dlpi_phdr[i].p_type != PT_LOAD) continue;
    const uintptr_t first = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr, last = first + info->dlpi_phdr[i].p_memsz;
    if (!self->low || first < self->low) self->low = first;
    if (last > self->high) self->high = last;
  }
  return 1;
}
#endif

/* --- compilation and loading --------------------------------------------------------------------------------------- */

static int ends_with(const char *path, const char *const *endings)
{
  const char *dot = strrchr(path, '.');
  for (; dot && *endings; endings++)
    if (strcasecmp(dot, *endings) == 0) return 1;
  return 0;
}

/* Writes ABA_PARAM.INC, in both spellings: valid in fixed and in free form. */
static int write_include(const char *folder)
{
  static const char *const names[] = {"ABA_PARAM.INC", "aba_param.inc"};
  char path[1200];
  for (int i = 0; i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[i]);
    FILE *file = fopen(path, "w");
    if (!file) return 0;
    fputs("      implicit real*8(a-h,o-z)\n      parameter (nprecd=2)\n", file);
    if (fclose(file)) return 0;
  }
  return 1;
}

static void remove_folder(const char *folder)
{
  char path[1400];
  DIR *directory = opendir(folder);
  struct dirent *entry;
  while (directory && (entry = readdir(directory))) {
    if (entry->d_name[0] == '.') continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    unlink(path);
  }
  if (directory) closedir(directory);
  rmdir(folder);
}

/* The first lines of the compiler's output. */
static void read_log(const char *folder, char *message, int capacity)
{
  char path[1200];
  snprintf(path, sizeof path, "%s/log", folder);
  FILE *file = fopen(path, "r");
  size_t n = file ? fread(message, 1, (size_t)capacity - 1, file) : 0;
  message[n] = 0;
  while (n > 0 && message[n - 1] == '\n') message[--n] = 0;
  if (file) fclose(file);
}

/* Words of AMONTONS_FFLAGS, separated by blanks. Returns the memory that they are in. */
static char *add_flags(const char **words, int *n, int capacity)
{
  const char *flags = getenv("AMONTONS_FFLAGS");
  char *copy = flags ? strdup(flags) : NULL, *rest = NULL;
  for (char *word = copy ? strtok_r(copy, " \t", &rest) : NULL; word && *n < capacity; word = strtok_r(NULL, " \t", &rest))
    words[(*n)++] = word;
  return copy;
}

/* Whether the lines of a fixed-form file have numbers in columns 73 to 80 and nothing beyond, as cards had. */
static int has_sequence_numbers(const char *source)
{
  char line[1024];
  int n_long = 0, is_so = 1;
  FILE *file = fopen(source, "r");
  while (is_so && file && fgets(line, sizeof line, file)) {
    size_t length = strcspn(line, "\r\n"), digits = 0;
    while (length > 0 && line[length - 1] == ' ') length--;
    if (length <= 72 || strchr("cC*!", line[0])) continue;
    n_long++;
    for (size_t i = length; i > 72 && line[i - 1] >= '0' && line[i - 1] <= '9'; i--) digits++;
    is_so = length == 80 && digits >= 2;
  }
  if (file) fclose(file);
  return is_so && n_long > 0;
}

/* Whether a file has lines for the preprocessor. */
static int has_directives(const char *source)
{
  char line[1024];
  int has_one = 0;
  FILE *file = fopen(source, "r");
  while (!has_one && file && fgets(line, sizeof line, file)) has_one = line[0] == '#';
  if (file) fclose(file);
  return has_one;
}

/* Runs the compiler. 1: done. */
static int run_compiler(const char *const *words, const char *folder, const char *output, char *message, int capacity)
{
  char log[1200];
  snprintf(log, sizeof log, "%s/%s", folder, output);
  pid_t child = fork();
  if (child == 0) {
    int descriptor = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (descriptor >= 0) {
      dup2(descriptor, STDOUT_FILENO);
      dup2(descriptor, STDERR_FILENO);
    }
    execvp(words[0], (char *const *)(uintptr_t)words);
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0) {
    snprintf(message, (size_t)capacity, "%s cannot be started: %s", words[0], strerror(errno));
    return 0;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return 1;
  read_log(folder, message, capacity);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    snprintf(message, (size_t)capacity, "there is no compiler %s; install it, or name one in AMONTONS_FC", words[0]);
  return 0;
}

/* Compiles a Fortran file into folder/routines.so, the modules into the folder too. 1: done. What compilers of Abaqus's users
 * accept: lines of 132 columns in fixed form, old language, and constants of single precision beside arguments of double
 * precision (sign(1.0, x)), by default reals of double precision if the file does not compile without. */
static int compile(const char *source, const char *folder, char *message, int capacity)
{
  enum { MAX_WORDS = 64, N_PRECISION = 2 };
  static const char *const precision[N_PRECISION] = {"-fdefault-real-8", "-fdefault-double-8"};
  char target[1200], include[1200], modules[1200], beside[1200];
  const char *compiler = getenv("AMONTONS_FC");
  if (!compiler || !*compiler) compiler = "gfortran";
  snprintf(target, sizeof target, "%s/routines.so", folder);
  snprintf(include, sizeof include, "-I%s", folder);
  snprintf(modules, sizeof modules, "-J%s", folder);
  const char *slash = strrchr(source, '/');
  snprintf(beside, sizeof beside, "-I%.*s", slash ? (int)(slash - source) + 1 : 1, slash ? source : ".");
  const char *words[MAX_WORDS] = {compiler, "-shared", "-fPIC", "-O2", "-g", "-w", "-std=legacy", "-frecursive", include, beside,
                                  modules, "-o", target, source};
  int n = 14;
  if (!has_sequence_numbers(source)) words[n++] = "-ffixed-line-length-132";
  if (has_directives(source)) words[n++] = "-cpp";
  char *flags = add_flags(words, &n, MAX_WORDS - N_PRECISION - 1);
  int is_done = run_compiler(words, folder, "log", message, capacity);
  for (int i = 0; i < N_PRECISION; i++) words[n++] = precision[i];
  char ignored[16];
  if (!is_done) is_done = run_compiler(words, folder, "second", ignored, sizeof ignored);
  free(flags);
  return is_done;
}

/* XIT and STDB_ABQERR must be visible to the loaded library, even if Amontons itself was loaded with local symbols. */
static void show_ourselves(void)
{
  Dl_info info;
  if (dladdr((void *)(uintptr_t)&xit_, &info) && info.dli_fname) {
    void *ourselves = dlopen(info.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
    if (ourselves) dlclose(ourselves);
  }
}

static void find_routines(routines *self)
{
  char name[32];
  for (int i = 0; i < N_ROUTINES; i++) {
    snprintf(name, sizeof name, "%s_", NAMES[i]);
    self->routine[i] = dlsym(self->library, name);
    if (self->routine[i]) continue;
    for (char *c = name; *c; c++) *c = (char)(*c >= 'a' && *c <= 'z' ? *c - 'a' + 'A' : *c);
    self->routine[i] = dlsym(self->library, name);
    name[strlen(name) - 1] = 0;
    if (!self->routine[i]) self->routine[i] = dlsym(self->library, name);
  }
}

static int load(routines *self, const char *path, char *message, int capacity)
{
  char full[4200];
  snprintf(full, sizeof full, "%s%s", strchr(path, '/') ? "" : "./", path);
  show_ourselves();
  self->library = dlopen(full, RTLD_NOW | RTLD_LOCAL);
  if (!self->library) {
    const char *reason = dlerror();
    snprintf(message, (size_t)capacity, "%s", reason ? reason : "unknown reason");
    return NOT_LOADED;
  }
  find_routines(self);
#ifdef __linux__
  dl_iterate_phdr(find_addresses, self);
#endif
  for (int i = 0; i < N_ROUTINES; i++)
    if (self->routine[i]) return OPENED;
  return NO_ROUTINE;
}

/* Opens a shared library, or a Fortran file that is compiled first. Returns OPENED or an error status, with the message of the
 * compiler or the loader. */
int amontons_user_open(const char *path, char *message, int capacity, void **handle)
{
  static const char *const fortran[] = {".f", ".for", ".f90", ".f95", ".f03", ".f08", ".ftn", ".fpp", NULL};
  char folder[1024] = "", compiled[1200];
  struct stat file;
  *handle = NULL;
  message[0] = 0;
  if (stat(path, &file) < 0) return NO_FILE;
  routines *self = calloc(1, sizeof *self);
  if (!self) return NO_MEMORY;
  pthread_mutex_init(&self->lock, NULL);
  self->smallest = 1;
  snprintf(self->file, sizeof self->file, "%s", path);
  int status = OPENED;
  if (ends_with(path, fortran)) {
    const char *where = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/amontons-XXXXXX", where && *where ? where : "/tmp");
    snprintf(message, (size_t)capacity, "there is no space for temporary files in %s", where && *where ? where : "/tmp");
    if (!mkdtemp(folder)) folder[0] = 0;
    status = folder[0] && write_include(folder) && compile(path, folder, message, capacity) ? OPENED : NOT_COMPILED;
    snprintf(compiled, sizeof compiled, "%s/routines.so", folder);
    path = compiled;
  }
  if (status == OPENED) status = load(self, path, message, capacity);
  if (folder[0]) remove_folder(folder);
  if (status == OPENED) {
    catch_signals();
    *handle = self;
  } else {
    if (self->library) dlclose(self->library);
    pthread_mutex_destroy(&self->lock);
    free(self);
  }
  return status;
}

void amontons_user_close(void *handle)
{
  routines *self = handle;
  if (!self) return;
  restore_signals();
  dlclose(self->library);
  pthread_mutex_destroy(&self->lock);
  free(self);
}

/* 1: the library contains the routine. */
int amontons_user_has(const void *handle, int which)
{
  const routines *self = handle;
  return self && self->routine[which] ? 1 : 0;
}

/* Folder and name of the job, for GETOUTDIR and GETJOBNAME. */
void amontons_user_job(void *handle, const char *folder, const char *job)
{
  routines *self = handle;
  snprintf(self->folder, sizeof self->folder, "%s", folder);
  snprintf(self->job, sizeof self->job, "%s", job);
}

/* Reports since the last query: the smallest PNEWDT, the messages, whether XIT was called or a routine has crashed. */
void amontons_user_news(void *handle, double *smallest, int *is_stopped, char *text, int capacity)
{
  routines *self = handle;
  pthread_mutex_lock(&self->lock);
  *smallest = self->smallest;
  *is_stopped = self->is_stopped;
  int n = self->n_text < capacity - 1 ? self->n_text : capacity - 1;
  memcpy(text, self->text, (size_t)n);
  text[n] = 0;
  self->smallest = 1;
  self->is_stopped = 0;
  self->n_text = 0;
  pthread_mutex_unlock(&self->lock);
}

/* --- the calls --------------------------------------------------------------------------------------------------- */

/* A message of the call that has crashed. */
static void report_crash(routines *self)
{
  char text[2048] = "*ERROR: ";
  const int n = describe_call(self, cause_of(caught), text + 8, (int)sizeof text - 8);
  say(self, text, (size_t)n + 8);
}

/* Around each call: serialized, with return to this point after XIT and after a crash; no call follows a crash. */
#define CALL(self, where, statement)                         \
  do {                                                       \
    pthread_mutex_lock(&(self)->lock);                       \
    if ((self)->is_stopped != CRASHED) {                     \
      give_stack();                                          \
      place_of_call = where;                                 \
      inside = (self);                                       \
      switch (setjmp(way_out)) {                             \
      case 0: statement; break;                              \
      case CRASHED: report_crash(self); break;               \
      default: break;                                        \
      }                                                      \
      inside = NULL;                                         \
    }                                                        \
    pthread_mutex_unlock(&(self)->lock);                     \
  } while (0)

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

void amontons_user_umat(void *handle, const char *cmname, const double *props, int nprops, double *statev, int nstatv,
                        umat_values *v)
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
  const double none = 0;
  double rpl = 0, drpldt = 0, ddsddt[6] = {0}, drplde[6] = {0}, pnewdt = 1;
  umat_routine *umat = (umat_routine *)(uintptr_t)self->routine[UMAT];
  const call_place where = {UMAT, v->noel, v->npt, 0, v->step, v->increment};
  CALL(self, where,
       umat(stress, statev, ddsdde, &v->energies[0], &v->energies[1], &v->energies[2], &rpl, ddsddt, drplde, &drpldt, stran,
            dstran, v->time, &v->dtime, &v->temp, &v->dtemp, &none, &none, cmname, &v->ndi, &v->nshr, &ntens, &nstatv, props,
            &nprops, v->coords, v->drot, &pnewdt, &v->celent, v->dfgrd0, v->dfgrd1, &v->noel, &v->npt, &one, &one, jstep,
            &v->increment, NAME_LENGTH));
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
  CALL(self, where,
       sdvini(statev, coords, &nstatv, &ncrds, &noel, &npt, &one, &one));
  *is_taken = !self->is_stopped;
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
  double ddtddt[4] = {0}, pnewdt = 1;
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
  double spd = 0, svd = 0, scd = 0, pnewdt = 1;
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
  int lflags[5], ndofel, nsvars, mcrd, nnode, npredf, jtype, element, step, increment;
  int is_taken;                     /* 1: valid result; 2: PNEWDT < 1; 0: it has called XIT */
} uel_values;

/* UEL. `inputs`: coords, u, du, predef; `memory`: svars, energy; `counts`: nprops, njprop. There are no loads on user elements and
 * no velocities. */
void amontons_user_uel(void *handle, const double *props, const int *jprops, const int *counts, const double *inputs, double *rhs,
                       double *amatrx, double *memory, uel_values *v)
{
  routines *self = handle;
  const int one = 1, none = 0, no_type = 0;
  const double no_load = 0, params[3] = {0};
  const double *coords = inputs, *u = coords + v->mcrd * v->nnode, *du = u + v->ndofel, *predef = du + v->ndofel;
  double pnewdt = 1, *rest = calloc((size_t)v->ndofel, sizeof *rest);
  uel_routine *uel = (uel_routine *)(uintptr_t)self->routine[UEL];
  const call_place where = {UEL, v->element, 0, 0, v->step, v->increment};
  v->is_taken = 0;
  if (!rest) return;
  CALL(self, where,
       uel(rhs, amatrx, memory, memory + v->nsvars, &v->ndofel, &one, &v->nsvars, props, &counts[0], coords, &v->mcrd, &v->nnode,
           u, du, rest, rest, &v->jtype, v->time, &v->dtime, &v->step, &v->increment, &v->element, params, &none, &no_type,
           &no_load, predef, &v->npredf, v->lflags, &v->ndofel, &no_load, &one, &pnewdt, jprops, &counts[1], &v->period));
  free(rest);
  pthread_mutex_lock(&self->lock);
  v->is_taken = self->is_stopped ? 0 : pnewdt < 1 ? 2 : 1;
  if (pnewdt > 0 && pnewdt < self->smallest) self->smallest = pnewdt;
  pthread_mutex_unlock(&self->lock);
}
