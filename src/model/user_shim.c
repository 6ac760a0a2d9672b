/* User shim for user_routines.f90: user routines in a shared library: compiled if they are Fortran, loaded; their crashes.
 * user_calls_shim.c calls them.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The routines have the argument lists of Abaqus. Calls are serialized, whatever the number of threads: common
 * blocks and saved variables of the user are safe. XIT and STDB_ABQERR are defined here; XIT leaves the routine, and its
 * caller gets a status. A routine that crashes is left in the same way. All state is in the handle, except a thread's current
 * call and, while a library is open, the signal handlers of the process. */
#define _GNU_SOURCE
#include "user_shim.h"
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <link.h>
#include <ucontext.h>
#endif

static const char *const NAMES[N_ROUTINES] = {"umat", "fric", "uinter", "dload", "disp", "uamp", "sdvini", "uel", "usdfld",
                                              "uexternaldb", "utracload", "creep"};
static const char *const CAPITALS[N_ROUTINES] = {"UMAT", "FRIC", "UINTER", "DLOAD", "DISP", "UAMP", "SDVINI", "UEL", "USDFLD",
                                                 "UEXTERNALDB", "UTRACLOAD", "CREEP"};

/* Status codes of opening; the same numbers as in user_routines.f90. */
enum { OPENED = 0, NO_FILE = 1, NOT_COMPILED = 2, NOT_LOADED = 3, NO_ROUTINE = 4, NO_MEMORY = 5 };

/* The exit code of a job whose routine ends the process (EXIT_NOT_CONVERGED of errors.f90). */
enum { EXIT_CODE = 5 };

_Thread_local routines *amontons_user_inside;
_Thread_local jmp_buf amontons_user_way_out;
_Thread_local call_place amontons_user_place;
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
  amontons_user_inside->is_stopped = XIT_CALLED;
  longjmp(amontons_user_way_out, XIT_CALLED);
}

/* SUBROUTINE XIT */
void xit_(void);
void xit_(void)
{
  if (amontons_user_inside) leave();
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
  if (!amontons_user_inside) return;
  n += (size_t)snprintf(line, sizeof line, "%s", *lop == 1 ? "" : *lop == -1 ? "*WARNING: " : "*ERROR: ");
  while (n_string > 0 && string[n_string - 1] == ' ') n_string--;
  for (size_t i = 0; i < n_string && n + 64 < sizeof line; i++) {
    if (string[i] == '%' && i + 1 < n_string && strchr("IRS", string[i + 1])) {
      n += (size_t)put_item(line + n, sizeof line - n, string[++i], intv, realv, charv, next);
    } else {
      line[n++] = string[i];
    }
  }
  say(amontons_user_inside, line, n);
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
  give_text(to, capacity, length, amontons_user_inside ? amontons_user_inside->folder : ".");
}

void getjobname_(char *to, int *length, size_t capacity);
void getjobname_(char *to, int *length, size_t capacity)
{
  give_text(to, capacity, length, amontons_user_inside ? amontons_user_inside->job : "job");
}

/* SUBROUTINE MUTEXINIT(ID), MUTEXLOCK(ID), MUTEXUNLOCK(ID), ID = 1 to 100 as in Abaqus. A thread may lock again what it has. */
enum { N_MUTEXES = 100 };
static pthread_mutex_t mutexes[N_MUTEXES];
static pthread_once_t mutexes_once = PTHREAD_ONCE_INIT;

static void make_mutexes(void)
{
  pthread_mutexattr_t kind;
  pthread_mutexattr_init(&kind);
  pthread_mutexattr_settype(&kind, PTHREAD_MUTEX_RECURSIVE);
  for (int i = 0; i < N_MUTEXES; i++) pthread_mutex_init(&mutexes[i], &kind);
  pthread_mutexattr_destroy(&kind);
}

static pthread_mutex_t *mutex_of(const int *id)
{
  pthread_once(&mutexes_once, make_mutexes);
  return *id >= 1 && *id <= N_MUTEXES ? &mutexes[*id - 1] : NULL;
}

void mutexinit_(const int *id);
void mutexinit_(const int *id)
{
  mutex_of(id);
}

void mutexlock_(const int *id);
void mutexlock_(const int *id)
{
  pthread_mutex_t *mutex = mutex_of(id);
  if (mutex) pthread_mutex_lock(mutex);
}

void mutexunlock_(const int *id);
void mutexunlock_(const int *id)
{
  pthread_mutex_t *mutex = mutex_of(id);
  if (mutex) pthread_mutex_unlock(mutex);
}

/* Utility routines in Fortran (user_utilities): named here, so that programs hold them and a library finds them. */
extern void rotsig_(void), sinv_(void), sprinc_(void), sprind_(void);
extern void (*const amontons_user_utilities[])(void);
void (*const amontons_user_utilities[])(void) = {rotsig_, sinv_, sprinc_, sprind_};

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
static _Thread_local _Alignas(16) char signal_stack[STACK_SIZE];
static _Thread_local int has_signal_stack;
static pthread_mutex_t handlers_lock = PTHREAD_MUTEX_INITIALIZER;

/* The sentence about a call that went wrong. */
static int describe_call(const routines *self, const char *verb, const char *cause, char *to, int capacity)
{
  const call_place *at = &amontons_user_place;
  int n = snprintf(to, (size_t)capacity, "The routine %s of %s %s", CAPITALS[at->routine], self->file, verb);
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
  routines *self = amontons_user_inside;
  amontons_user_inside = NULL;
  int n = describe_call(self, "has crashed", cause, text, (int)sizeof text - 100);
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
  if (!amontons_user_inside) {
    for (int i = 0; i < N_SIGNALS; i++)
      if (SIGNALS[i] == number) sigaction(number, &handlers_before[i], NULL);
    raise(number);
    return;
  }
  if (!is_from_library(amontons_user_inside, context)) end_process(cause_of(number));
  caught = number;
  amontons_user_inside->is_stopped = CRASHED;
  longjmp(amontons_user_way_out, CRASHED);
}

static atomic_int is_flushed;

static void *flush_units(void *unused)
{
  _gfortran_flush_i4(NULL);
  is_flushed = 1;
  return unused;
}

/* Flushes the units, for a second at most: after an error in a statement of input or output that statement's unit stays locked. */
static void flush_what_is_free(void)
{
  pthread_t helper;
  const struct timespec pause = {.tv_nsec = 10000000};
  if (!_gfortran_flush_i4 || pthread_create(&helper, NULL, flush_units, NULL)) return;
  for (int i = 0; i < 100 && !is_flushed; i++) nanosleep(&pause, NULL);
}

/* A routine that ends the process: STOP, or an error of the Fortran run-time library. */
static void handle_exit(void)
{
  if (!amontons_user_inside) return;
  fflush(NULL);
  flush_what_is_free();
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
void amontons_user_give_stack(void)
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

/* Whether a file says that it is in free form, as compilers of Abaqus's users read it: !DIR$ FREEFORM, !DEC$ FREEFORM. */
static int is_free_form(const char *source)
{
  char line[1024], mark[3], word[9];
  int is_so = 0;
  FILE *file = fopen(source, "r");
  while (!is_so && file && fgets(line, sizeof line, file))
    is_so = sscanf(line, " !%*1[dD]%2[a-zA-Z]$ %8[a-zA-Z]", mark, word) == 2 && (!strcasecmp(mark, "IR") || !strcasecmp(mark, "EC")) &&
            !strcasecmp(word, "FREEFORM");
  if (file) fclose(file);
  return is_so;
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
 * accept: long lines (they count a tabulator as one column), old language, free form in a file of any name, and constants of
 * single precision beside arguments of double precision (sign(1.0, x)), by default reals of double precision. The latter two
 * where the file does not compile without; messages are those of the first attempt. */
static int compile(const char *source, const char *folder, char *message, int capacity)
{
  enum { MAX_WORDS = 64, N_PRECISION = 2, N_MORE = N_PRECISION + 1 };
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
                                  modules, "-o", target, source, "-ffree-line-length-none"};
  int n = 15;
  if (!has_sequence_numbers(source)) words[n++] = "-ffixed-line-length-none";
  if (is_free_form(source)) words[n++] = "-ffree-form";
  if (has_directives(source)) words[n++] = "-cpp";
  char *flags = add_flags(words, &n, MAX_WORDS - N_MORE - 1);
  int is_done = run_compiler(words, folder, "log", message, capacity);
  char ignored[16];
  for (int i = 0; i < N_PRECISION; i++) words[n + i] = precision[i];
  if (!is_done) is_done = run_compiler(words, folder, "second", ignored, sizeof ignored);
  if (!is_done && !is_free_form(source)) {
    words[n + N_PRECISION] = "-ffree-form";
    is_done = run_compiler(words, folder, "third", ignored, sizeof ignored);
  }
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

static void report(routines *self, const char *verb, const char *cause)
{
  char text[2048] = "*ERROR: ";
  const int n = describe_call(self, verb, cause, text + 8, (int)sizeof text - 8);
  say(self, text, (size_t)n + 8);
}

/* A message of the call that has crashed. */
void amontons_user_report_crash(routines *self)
{
  report(self, "has crashed", cause_of(caught));
}

void amontons_user_report_overrun(routines *self, int nstatv, int last)
{
  char cause[100];
  snprintf(cause, sizeof cause, "it wrote STATEV(%d), but *DEPVAR gives it %d state variable%s", last, nstatv,
           nstatv == 1 ? "" : "s");
  self->is_stopped = CRASHED;
  report(self, "is wrong", cause);
}

void amontons_user_report_outside(routines *self, const char *name, int size, int number)
{
  char cause[100];
  snprintf(cause, sizeof cause, "it wrote number %d of the array %s, which has %d", number, name, size);
  self->is_stopped = CRASHED;
  report(self, "is wrong", cause);
}
