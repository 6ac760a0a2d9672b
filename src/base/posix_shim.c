/* POSIX shim for posix.f90: atomic file writes, signals, and the exit code after an abort by a run-time library.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The flags below are the only variables of the whole program that persist between calls: a signal handler has no
 * argument, and signals belong to the process, not to a job (doc/developer/decisions/0008). They stay 0 unless the main
 * program installs the handlers; the library never does. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

static volatile sig_atomic_t stop_signal = 0;  /* SIGINT or SIGTERM arrived */
static volatile sig_atomic_t n_status_requested = 0; /* SIGUSR1 arrived and was not answered */
static volatile sig_atomic_t is_watching_end = 0;
static struct sigaction access_before, abort_before; /* actions of SIGSEGV and SIGABRT outside the main program */

enum { UNMAPPED_BYTES = 4096 };                      /* from address 0; a null pointer lies there */

/* A second SIGINT or SIGTERM kills the process. An iteration may last minutes, so the first signal is answered at once. */
static void note_stop(int number)
{
  static const char answer[] = "\namontons: the job ends after this iteration; a second signal ends it at once.\n";
  const int before = errno;
  if (stop_signal) {
    signal(number, SIG_DFL);
    raise(number);
  }
  stop_signal = number;
  if (write(STDERR_FILENO, answer, sizeof answer - 1) < 0) errno = before; /* no reader */
  errno = before;
}

static void note_status(int number)
{
  (void)number;
  n_status_requested = 1;
}

/* Starts recording SIGINT, SIGTERM and SIGUSR1. A signal that the caller ignores (nohup, a shell's &) stays ignored. */
void amontons_watch_signals(void)
{
  const int stops[] = {SIGINT, SIGTERM};
  struct sigaction action = {.sa_handler = note_stop, .sa_flags = SA_RESTART}, before;
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < 2; i++)
    if (sigaction(stops[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(stops[i], &action, NULL);
  action.sa_handler = note_status;
  sigaction(SIGUSR1, &action, NULL);
  signal(SIGXFSZ, SIG_IGN); /* the file size limit gives a write error, not a kill */
}

/* The number of the signal that requested a stop; 0: none. */
int amontons_stop_signal(void)
{
  return stop_signal;
}

/* 1 if a status was requested since the last call. */
int amontons_status_requested(void)
{
  int is_requested = n_status_requested;
  n_status_requested = 0;
  return is_requested;
}

/* The process lock serializes text operations. gfortran stores the length of a string function result (character(:),
 * allocatable) in a static variable of the calling statement, so two threads there at the same time would exchange their lengths.
 * A procedure of the library holds the lock; the solution phase, long and without text, releases it. The lock is
 * recursive: a thread may take it again. */
static pthread_mutex_t words = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local int depth = 0;

void amontons_acquire_lock(void)
{
  if (depth++ == 0) pthread_mutex_lock(&words);
}

void amontons_release_lock(void)
{
  if (--depth == 0) pthread_mutex_unlock(&words);
}

/* Releases the lock if this thread holds it; the result is the argument of amontons_resume_lock. */
int amontons_suspend_lock(void)
{
  int before = depth;
  depth = 0;
  if (before) pthread_mutex_unlock(&words);
  return before;
}

void amontons_resume_lock(int before)
{
  if (before) pthread_mutex_lock(&words);
  depth = before;
}

/* A thread that writes a line if nothing else was written for a while: an iteration in one long factorization says nothing. */
struct heartbeat {
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t wake;
  struct timespec due;
  double seconds;
  int descriptor, is_done;
  char text[160];
};

static void set_due(struct heartbeat *beat)
{
  clock_gettime(CLOCK_REALTIME, &beat->due);
  const double due = beat->due.tv_nsec + 1e9 * beat->seconds;
  beat->due.tv_sec += (time_t)(due / 1e9);
  beat->due.tv_nsec = (long)(due - 1e9 * (double)(time_t)(due / 1e9));
}

static void *write_beats(void *argument)
{
  struct heartbeat *beat = argument;
  pthread_mutex_lock(&beat->lock);
  while (!beat->is_done) {
    const struct timespec due = beat->due;
    if (pthread_cond_timedwait(&beat->wake, &beat->lock, &due) != ETIMEDOUT) continue;
    if (due.tv_sec != beat->due.tv_sec || due.tv_nsec != beat->due.tv_nsec) continue; /* a line was written meanwhile */
    set_due(beat);
    const size_t n = strlen(beat->text);
    if (n && write(beat->descriptor, beat->text, n) < 0) beat->is_done = 1; /* no reader */
  }
  pthread_mutex_unlock(&beat->lock);
  return NULL;
}

/* Starts the thread; NULL if there is none. Signals go to other threads. */
void *amontons_start_heartbeat(int descriptor, double seconds)
{
  struct heartbeat *beat = calloc(1, sizeof *beat);
  sigset_t all, before;
  if (!beat) return NULL;
  beat->descriptor = descriptor;
  beat->seconds = seconds;
  pthread_mutex_init(&beat->lock, NULL);
  pthread_cond_init(&beat->wake, NULL);
  set_due(beat);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const int failed = pthread_create(&beat->thread, NULL, write_beats, beat);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (!failed) return beat;
  free(beat);
  return NULL;
}

/* A line was written just now: the next one is due in some seconds. */
void amontons_postpone_heartbeat(void *handle)
{
  struct heartbeat *beat = handle;
  pthread_mutex_lock(&beat->lock);
  set_due(beat);
  pthread_mutex_unlock(&beat->lock);
}

/* Sets the text alone. */
void amontons_set_heartbeat(void *handle, const char *text)
{
  struct heartbeat *beat = handle;
  pthread_mutex_lock(&beat->lock);
  snprintf(beat->text, sizeof beat->text, "%s%s", text, *text ? "\n" : "");
  pthread_mutex_unlock(&beat->lock);
}

void amontons_stop_heartbeat(void *handle)
{
  struct heartbeat *beat = handle;
  pthread_mutex_lock(&beat->lock);
  beat->is_done = 1;
  pthread_cond_signal(&beat->wake);
  pthread_mutex_unlock(&beat->lock);
  pthread_join(beat->thread, NULL);
  free(beat);
}

static const char no_memory[] = "*ERROR: There is not enough memory for this job.\n";

/* gfortran does not check the memory of array temporaries: an expression without memory is written at address 0. HDF5 aborts
 * if memory ends at the wrong place. Any other invalid access or abort is a bug: it occurs again, now with the action of the
 * run-time library. */
static void end_without_memory(int number, siginfo_t *info, void *context)
{
  (void)context;
  if (errno == ENOMEM && (number == SIGABRT || (uintptr_t)info->si_addr < UNMAPPED_BYTES)) {
    ssize_t unused = write(STDOUT_FILENO, no_memory, strlen(no_memory));
    (void)unused;
    _exit(6);
  }
  sigaction(number, number == SIGABRT ? &abort_before : &access_before, NULL);
  if (number == SIGABRT) raise(number);
}

/* Runs when the process ends. Unless the main program announced a regular end, a run-time library has ended the process after
 * its own message and with its own exit code: most often memory is exhausted. */
static void give_exit_code(void)
{
  const char no_space[] = "*ERROR: A file could not be written: is the disk full?\n";
  const char other[] = "*ERROR: Amontons was ended by the run-time library, see its message above.\n";
  if (!is_watching_end) return;
  const int reason = errno, is_memory = reason == ENOMEM;
  const int is_space = reason == ENOSPC || reason == EDQUOT || reason == EFBIG || reason == EIO;
  const char *line = is_memory ? no_memory : is_space ? no_space : other;
  ssize_t unused = write(STDOUT_FILENO, line, strlen(line));
  (void)unused;
  _exit(is_memory ? 6 : is_space ? 7 : 8);
}

/* Starts monitoring the end of the process (is_on = 1), or announces a regular end (0). */
void amontons_watch_end(int is_on)
{
  if (is_on && !is_watching_end) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = end_without_memory;
    action.sa_flags = SA_SIGINFO;
    atexit(give_exit_code);
    sigaction(SIGSEGV, &action, &access_before);
    sigaction(SIGABRT, &action, &abort_before);
  } else if (!is_on && is_watching_end) {
    sigaction(SIGSEGV, &access_before, NULL);
    sigaction(SIGABRT, &abort_before, NULL);
  }
  is_watching_end = is_on;
}

/* Blocks of 16 MB and more go back to the system when they are freed. By default the threshold follows the blocks that were freed, up
 * to 32 MB: then the blocks of one phase of a job leave holes that the next one does not fill. Smaller blocks are used again: vectors
 * of a million unknowns that each iteration gave back took a tenth of a job into new pages. */
void amontons_return_blocks(void)
{
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 16 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

/* Ends the process at once. */
void amontons_end_process(int code)
{
  fflush(NULL);
  _exit(code);
}

/* What libraries read of the environment before the program begins, and it sets unless one of the two is there. Threads that wait
 * spin for half a millisecond before they sleep: libgomp's default (some 15 ms) makes two threads on a busy machine several times
 * slower than one. Large blocks of memory get pages of 2 MB, where the system lends them on request: a tenth of a large job goes
 * into small pages. */
static const struct {
  const char *name, *value, *instead;
} SETTINGS[] = {
  {"GOMP_SPINCOUNT", "10000", "OMP_WAIT_POLICY"},
  {"GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", "GLIBC_TUNABLES"},
};
enum { N_SETTINGS = sizeof SETTINGS / sizeof *SETTINGS };

/* Restarts the program with its arguments and these settings. Returns without change if none is needed, or if the system does not
 * report the executable (only Linux does). */
void amontons_begin_again(void)
{
  enum { LONGEST = 65536 };
  int is_needed[N_SETTINGS], n_needed = 0;
  for (int i = 0; i < N_SETTINGS; i++) {
    is_needed[i] = !getenv(SETTINGS[i].name) && !getenv(SETTINGS[i].instead);
    n_needed += is_needed[i];
  }
  if (!n_needed) return;
  char *text = malloc(LONGEST), **arguments = calloc(LONGEST / 2, sizeof *arguments), path[4096];
  FILE *file = fopen("/proc/self/cmdline", "rb");
  size_t length = file && text && arguments ? fread(text, 1, LONGEST, file) : 0;
  ssize_t end = readlink("/proc/self/exe", path, sizeof path - 1);
  if (file) fclose(file);
  if (length > 0 && length < LONGEST && end > 0) {
    path[end] = 0;
    int n = 0;
    for (size_t i = 0; i < length && n < LONGEST / 2 - 1; i += strlen(text + i) + 1) arguments[n++] = text + i;
    for (int i = 0; i < N_SETTINGS; i++)
      if (is_needed[i]) setenv(SETTINGS[i].name, SETTINGS[i].value, 0);
    execv(path, arguments);
    for (int i = 0; i < N_SETTINGS; i++)
      if (is_needed[i]) unsetenv(SETTINGS[i].name);
  }
  free(text);
  free(arguments);
}

/* 1 if so much memory is available at once. */
int amontons_has_memory(int64_t n_bytes)
{
  void *memory = malloc((size_t)n_bytes);
  free(memory);
  return memory != NULL;
}

/* The number after a word of a file like /proc/meminfo; with an empty word: the first number; -1 if not found. */
static double number_in(const char *path, const char *word)
{
  char line[256];
  double number = -1;
  FILE *file = fopen(path, "r");
  if (!file) return -1;
  while (fgets(line, sizeof line, file)) {
    if (strncmp(line, word, strlen(word)) != 0) continue;
    if (sscanf(line + strlen(word), "%lf", &number) != 1) number = -1;
    break;
  }
  fclose(file);
  return number;
}

/* Peak resident memory of the process, in megabytes of 10^6 bytes; 0: unknown. getrusage includes the memory of the process
   before it became this program; it is used only without /proc. */
double amontons_peak_megabytes(void)
{
  double kilobytes = number_in("/proc/self/status", "VmHWM:");
  if (kilobytes >= 0) return kilobytes * 1024.0 / 1.0e6;
  struct rusage usage;
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
#ifdef __APPLE__
  return (double)usage.ru_maxrss / 1.0e6; /* bytes there, kilobytes elsewhere */
#else
  return (double)usage.ru_maxrss * 1024.0 / 1.0e6;
#endif
}

/* Memory available to the process [megabytes]: limited by the system, the control group and the limit of the address space.
   1e9 if the system does not report it. */
double amontons_available_megabytes(void)
{
  double least = 1e9, found = number_in("/proc/meminfo", "MemAvailable:");
  if (found >= 0 && found / 1024 < least) least = found / 1024;
  double group = number_in("/sys/fs/cgroup/memory.max", ""), used = number_in("/sys/fs/cgroup/memory.current", "");
  if (group >= 0 && used >= 0 && (group - used) / 1048576 < least) least = (group - used) / 1048576;
  struct rlimit limit;
  double pages = number_in("/proc/self/statm", "");
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && pages >= 0) {
    double left = ((double)limit.rlim_cur - pages * (double)sysconf(_SC_PAGESIZE)) / 1048576;
    if (left < least) least = left;
  }
  return least > 0 ? least : 0;
}

/* The same without the use of other processes: the limit by machine, control group and process. It is constant during
   a run. */
double amontons_whole_megabytes(void)
{
  double least = 1e9, found = number_in("/proc/meminfo", "MemTotal:"), group = number_in("/sys/fs/cgroup/memory.max", "");
  if (found >= 0 && found / 1024 < least) least = found / 1024;
  if (group >= 0 && group / 1048576 < least) least = group / 1048576;
  struct rlimit limit;
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && (double)limit.rlim_cur / 1048576 < least)
    least = (double)limit.rlim_cur / 1048576;
  return least;
}

/* Flushes the directory entry of a file to the storage device. */
static void sync_folder(const char *path)
{
  char *folder = strdup(path);
  if (!folder) return;
  char *slash = strrchr(folder, '/');
  if (slash == folder) slash[1] = 0;
  else if (slash) *slash = 0;
  int descriptor = open(slash ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
  free(folder);
}

static int write_all(int descriptor, const char *from, size_t size)
{
  while (size > 0) {
    ssize_t n = write(descriptor, from, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    from += n;
    size -= (size_t)n;
  }
  return 0;
}

/* A file that takes the place of another one when it is complete: written under a temporary name, synced, renamed (atomic). */

/* The descriptor of the temporary file, or minus errno. */
int amontons_open_new(const char *temporary)
{
  int descriptor = open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return descriptor < 0 ? -errno : descriptor;
}

/* Appends bytes. 0: done, else errno. */
int amontons_append_new(int descriptor, const void *bytes, int64_t n_bytes)
{
  return write_all(descriptor, bytes, (size_t)n_bytes);
}

/* Writes the head over the first bytes and puts the file in its place; with a status before (errno) it is removed. 0: done, else errno. */
int amontons_place_new(int descriptor, const char *path, const char *temporary, const void *head, int64_t n_bytes, int status)
{
  if (!status && lseek(descriptor, 0, SEEK_SET) < 0) status = errno;
  if (!status) status = write_all(descriptor, head, (size_t)n_bytes);
  if (!status && fdatasync(descriptor) < 0) status = errno;
  if (close(descriptor) < 0 && !status) status = errno;
  if (!status && rename(temporary, path) < 0) status = errno;
  if (status) unlink(temporary);
  else sync_folder(path);
  return status;
}

/* Flushes a file to the storage device. 0: done, else errno. */
int amontons_sync_file(const char *path)
{
  int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  int status = fdatasync(descriptor) < 0 ? errno : 0;
  close(descriptor);
  return status;
}

/* Truncates a file to a length. 0: done, else errno; EINVAL if it is shorter. */
int amontons_cut_file(const char *path, int64_t length)
{
  struct stat status;
  if (stat(path, &status) < 0) return errno;
  if (status.st_size < (off_t)length) return EINVAL;
  return truncate(path, (off_t)length) < 0 ? errno : 0;
}

/* The text of an errno, cut to the length of the buffer. */
void amontons_reason(int number, char *text, int capacity)
{
  char buffer[256];
  const char *reason = strerror_r(number, buffer, sizeof buffer);
  snprintf(text, (size_t)capacity, "%s", reason);
}

/* A 64-bit checksum: each word is mixed into a running sum, so that the order matters (after MurmurHash3's finalizer). */
uint64_t amontons_continue_checksum(uint64_t sum, const void *bytes, int64_t n_bytes)
{
  const unsigned char *from = bytes;
  for (int64_t k = 0; k < n_bytes; k += 8) {
    uint64_t word = 0;
    memcpy(&word, from + k, n_bytes - k < 8 ? (size_t)(n_bytes - k) : 8);
    sum = (sum ^ word) * 0xFF51AFD7ED558CCDull;
    sum ^= sum >> 32;
  }
  return sum;
}

uint64_t amontons_checksum(const void *bytes, int64_t n_bytes)
{
  return amontons_continue_checksum(0x9E3779B97F4A7C15ull ^ (uint64_t)n_bytes, bytes, n_bytes);
}
