/* Overlay shim: an HDF5 file driver whose file on disk changes from one consistent state to the next, for hdf5_file.f90.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * HDF5 changes a file in place, in an order that is not safe against a power failure. Here the part of the file below the
 * end of the last consistent state does not change while HDF5 writes: such writes are kept in memory, page by page; new data
 * are appended at once. `apply` then writes the pages; the file on disk is then the new consistent state. A checkpoint stores
 * the pages before that, so that they can be written again (doc/developer/decisions/0007). The only static data are the
 * constant description of the driver. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <hdf5.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

enum { PAGE = 4096 };
enum { ANOTHER_WRITES = -1, WAS_CHANGED = -2 }; /* in addition to errno: another job writes the file; its length has changed */

typedef struct {
  int64_t index; /* page number + 1; 0: an empty entry of the table */
  unsigned char *bytes;
} page;

typedef struct {
  int descriptor;
  haddr_t frozen;  /* end of the last consistent state */
  haddr_t end;     /* end of what HDF5 has written */
  off_t length;    /* of the file on disk after our last write */
  page *table;     /* open addressing, n_places a power of two */
  size_t n_places, n_pages;
  int trouble;     /* errno, ANOTHER_WRITES or WAS_CHANGED of the first write that failed. HDF5 gets no error, the owner queries it: HDF5
                    * would keep a file open that it cannot close, and fail at the end of the process */
  int is_held;     /* HDF5 has the file open */
  int is_dropped;  /* further writes of HDF5 are discarded */
} overlay;

typedef struct {
  H5FD_t public; /* must be first */
  overlay *over;
  haddr_t eoa;
} driver_file;

static size_t place_of(const overlay *self, int64_t index)
{
  size_t mask = self->n_places - 1, i = (size_t)(index * 0x9E3779B97F4A7C15ull >> 20) & mask;
  while (self->table[i].index && self->table[i].index != index + 1) i = (i + 1) & mask;
  return i;
}

static unsigned char *page_in_memory(const overlay *self, int64_t index)
{
  return self->n_places ? self->table[place_of(self, index)].bytes : NULL;
}

/* Doubles the table. */
static int grow(overlay *self)
{
  page *old = self->table;
  size_t n_old = self->n_places, n_new = n_old ? 2 * n_old : 256;
  page *table = calloc(n_new, sizeof *table);
  if (!table) return 0;
  self->table = table;
  self->n_places = n_new;
  for (size_t i = 0; i < n_old; i++)
    if (old[i].index) table[place_of(self, old[i].index - 1)] = old[i];
  free(old);
  return 1;
}

/* Reads from disk; bytes beyond the end of the file are zero. */
static int read_disk(const overlay *self, void *buffer, size_t size, off_t at)
{
  unsigned char *to = buffer;
  while (size > 0) {
    ssize_t n = pread(self->descriptor, to, size, at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return 0;
    if (n == 0) { memset(to, 0, size); break; }
    to += n; size -= (size_t)n; at += n;
  }
  return 1;
}

static int write_disk(int descriptor, const void *buffer, size_t size, off_t at)
{
  const unsigned char *from = buffer;
  while (size > 0) {
    ssize_t n = pwrite(descriptor, from, size, at);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return 0;
    from += n; size -= (size_t)n; at += n;
  }
  return 1;
}

/* One job at a time writes a file: a lock of the kernel, which releases it however the job ends. It differs from the locks by
 * which HDF5 excludes readers. Systems without it use none. 0: success. */
static int take_lock(int descriptor)
{
#ifdef F_OFD_SETLK
  struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  if (fcntl(descriptor, F_OFD_SETLK, &lock) < 0 && (errno == EAGAIN || errno == EACCES)) return ANOTHER_WRITES;
#else
  (void)descriptor;
#endif
  return 0;
}

/* 0 if the file still exists with the length of our last write, else the error. */
static int look_for_changes(const overlay *self)
{
  struct stat status;
  if (fstat(self->descriptor, &status) < 0) return errno;
  return status.st_size == self->length && status.st_nlink > 0 ? 0 : WAS_CHANGED;
}

/* The page in memory, read from disk if necessary. */
static unsigned char *fetch(overlay *self, int64_t index)
{
  unsigned char *bytes = page_in_memory(self, index);
  if (bytes) return bytes;
  if (2 * (self->n_pages + 1) > self->n_places && !grow(self)) return NULL;
  bytes = malloc(PAGE);
  if (!bytes) return NULL;
  if (!read_disk(self, bytes, PAGE, (off_t)index * PAGE)) { free(bytes); return NULL; }
  self->table[place_of(self, index)] = (page){.index = index + 1, .bytes = bytes};
  self->n_pages++;
  return bytes;
}

static void forget_pages(overlay *self)
{
  for (size_t i = 0; i < self->n_places; i++) free(self->table[i].bytes);
  free(self->table);
  self->table = NULL;
  self->n_places = self->n_pages = 0;
}

/* --- called by HDF5 ---------------------------------------------------------------------------------------------- */

static void *copy_pointer(const void *info)
{
  overlay **copy = malloc(sizeof *copy);
  if (copy) *copy = *(overlay *const *)info;
  return copy;
}

static herr_t free_pointer(void *info)
{
  free(info);
  return 0;
}

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t list, haddr_t maxaddr)
{
  overlay *const *info = H5Pget_driver_info(list);
  (void)maxaddr;
  if (!info || !*info) return NULL;
  overlay *over = *info;
  int mode = O_CLOEXEC | (flags & H5F_ACC_RDWR ? O_RDWR : O_RDONLY) | (flags & H5F_ACC_CREAT ? O_CREAT : 0) |
             (flags & H5F_ACC_EXCL ? O_EXCL : 0);
  int descriptor = open(name, mode, 0666);
  struct stat status;
  if (descriptor < 0) return NULL;
  over->trouble = take_lock(descriptor);
  if (over->trouble || (flags & H5F_ACC_TRUNC && ftruncate(descriptor, 0) < 0)) { close(descriptor); return NULL; }
  driver_file *file = calloc(1, sizeof *file);
  if (!file || over->descriptor >= 0 || fstat(descriptor, &status) < 0) { free(file); close(descriptor); return NULL; }
  over->descriptor = descriptor;
  over->end = over->frozen = (haddr_t)status.st_size;
  over->length = status.st_size;
  over->is_held = 1;
  file->over = over;
  return &file->public;
}

static void release(overlay *self)
{
  if (self->is_held || !self->is_dropped) return;
  forget_pages(self);
  if (self->descriptor >= 0) close(self->descriptor);
  free(self);
}

/* The overlay outlives the file: its owner decides whether the last pages are applied. */
static herr_t driver_close(H5FD_t *base)
{
  overlay *over = ((driver_file *)base)->over;
  over->is_held = 0;
  release(over);
  free(base);
  return 0;
}

static herr_t driver_query(const H5FD_t *base, unsigned long *flags)
{
  (void)base;
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *base, H5FD_mem_t type)
{
  (void)type;
  return ((const driver_file *)base)->eoa;
}

static herr_t driver_set_eoa(H5FD_t *base, H5FD_mem_t type, haddr_t address)
{
  (void)type;
  ((driver_file *)base)->eoa = address;
  return 0;
}

static haddr_t driver_get_eof(const H5FD_t *base, H5FD_mem_t type)
{
  (void)type;
  return ((const driver_file *)base)->over->end;
}

static herr_t driver_read(H5FD_t *base, H5FD_mem_t type, hid_t list, haddr_t at, size_t size, void *buffer)
{
  const overlay *self = ((driver_file *)base)->over;
  unsigned char *to = buffer;
  (void)type;
  (void)list;
  while (size > 0) {
    int64_t index = (int64_t)(at / PAGE);
    size_t within = at % PAGE, n = PAGE - within < size ? PAGE - within : size;
    const unsigned char *bytes = page_in_memory(self, index);
    if (bytes) memcpy(to, bytes + within, n);
    else if (!read_disk(self, to, n, (off_t)at)) return -1;
    to += n; size -= n; at += n;
  }
  return 0;
}

static herr_t driver_write(H5FD_t *base, H5FD_mem_t type, hid_t list, haddr_t at, size_t size, const void *buffer)
{
  overlay *self = ((driver_file *)base)->over;
  const unsigned char *from = buffer;
  haddr_t end = at + size;
  (void)type;
  (void)list;
  if (self->is_dropped || self->trouble) return 0;
  while (size > 0 && at / PAGE * PAGE < self->frozen) {
    size_t within = at % PAGE, n = PAGE - within < size ? PAGE - within : size;
    unsigned char *bytes = fetch(self, (int64_t)(at / PAGE));
    if (!bytes) { self->trouble = errno ? errno : ENOMEM; return 0; }
    memcpy(bytes + within, from, n);
    from += n; size -= n; at += n;
  }
  if (size > 0) {
    struct stat status;
    self->trouble = look_for_changes(self);
    if (self->trouble) return 0;
    if (!write_disk(self->descriptor, from, size, (off_t)at)) self->trouble = errno;
    if (fstat(self->descriptor, &status) == 0) self->length = status.st_size;
    if (self->trouble) return 0;
  }
  if (end > self->end) self->end = end;
  return 0;
}

static herr_t driver_truncate(H5FD_t *base, hid_t list, hbool_t is_closing)
{
  driver_file *file = (driver_file *)base;
  (void)list;
  (void)is_closing;
  file->over->end = file->eoa;
  return 0;
}

static const H5FD_class_t driver = {
#if H5_VERSION_GE(1, 13, 0)
  .version = H5FD_CLASS_VERSION,
  .value = (H5FD_class_value_t)600,
#endif
  .name = "amontons_overlay", .maxaddr = (haddr_t)INT64_MAX, .fc_degree = H5F_CLOSE_WEAK,
  .fapl_size = sizeof(overlay *), .fapl_copy = copy_pointer, .fapl_free = free_pointer,
  .open = driver_open, .close = driver_close, .query = driver_query, .get_eoa = driver_get_eoa,
  .set_eoa = driver_set_eoa, .get_eof = driver_get_eof, .read = driver_read, .write = driver_write,
  .truncate = driver_truncate, .fl_map = H5FD_FLMAP_DICHOTOMY};

/* --- called by hdf5_file.f90 ------------------------------------------------------------------------------------- */

/* A new overlay without a file; NULL without memory. */
void *amontons_overlay_new(void)
{
  overlay *self = calloc(1, sizeof *self);
  if (self) self->descriptor = -1;
  return self;
}

/* The next file opened with this property list uses the overlay. Negative: failure. */
int amontons_overlay_attach(void *self, hid_t list)
{
  hid_t id = H5FDregister(&driver);
  if (id < 0) return -1;
  int status = H5Pset_driver(list, id, &self);
  H5FDunregister(id);
  return status;
}

int64_t amontons_overlay_pages(const void *handle)
{
  return (int64_t)((const overlay *)handle)->n_pages;
}

int amontons_overlay_page_size(void)
{
  return PAGE;
}

/* errno of the first write that failed, ANOTHER_WRITES or WAS_CHANGED; 0: none. */
int amontons_overlay_trouble(const void *handle)
{
  return ((const overlay *)handle)->trouble;
}

/* Ends of the last consistent state and of the next one [bytes]. */
void amontons_overlay_ends(const void *handle, int64_t *frozen, int64_t *end)
{
  const overlay *self = handle;
  *frozen = (int64_t)self->frozen;
  *end = (int64_t)self->end;
}

/* Copies the pages with their new contents, or those on disk. 0: success, else errno, ANOTHER_WRITES or WAS_CHANGED. */
int amontons_overlay_take(const void *handle, int is_old, int64_t *index, unsigned char *bytes)
{
  const overlay *self = handle;
  size_t k = 0;
  for (size_t i = 0; i < self->n_places; i++) {
    if (!self->table[i].index) continue;
    index[k] = self->table[i].index - 1;
    if (!is_old) memcpy(bytes + k * PAGE, self->table[i].bytes, PAGE);
    else if (!read_disk(self, bytes + k * PAGE, PAGE, (off_t)index[k] * PAGE)) return errno;
    k++;
  }
  return 0;
}

/* Syncs the appended data to disk; the file gets its new length. 0: success, else errno, ANOTHER_WRITES or WAS_CHANGED. */
int amontons_overlay_sync(void *handle)
{
  overlay *self = handle;
  int status = look_for_changes(self);
  if (status) return status;
  if (self->length < (off_t)self->end) {
    if (ftruncate(self->descriptor, (off_t)self->end) < 0) return errno;
    self->length = (off_t)self->end;
  }
  return fdatasync(self->descriptor) < 0 ? errno : 0;
}

/* Writes the pages: the file on disk is then the next consistent state. 0: success, else errno, ANOTHER_WRITES or WAS_CHANGED. */
int amontons_overlay_apply(void *handle)
{
  overlay *self = handle;
  if (self->trouble) return self->trouble;
  if (self->descriptor < 0) return 0;
  int status = look_for_changes(self);
  if (status) return status;
  for (size_t i = 0; i < self->n_places; i++)
    if (self->table[i].index && !write_disk(self->descriptor, self->table[i].bytes, PAGE,
                                            (off_t)(self->table[i].index - 1) * PAGE)) return errno;
  if (ftruncate(self->descriptor, (off_t)self->end) < 0) return errno;
  self->frozen = self->end;
  self->length = (off_t)self->end;
  forget_pages(self);
  return 0;
}

/* Pages that were not applied are lost, and further writes of HDF5 are discarded: a file that it cannot close because
 * the disk is full would otherwise cause errors at the end of the process. All memory is freed once HDF5 closes the file. */
void amontons_overlay_free(void *handle)
{
  overlay *self = handle;
  if (!self) return;
  self->is_dropped = 1;
  release(self);
}

/* Restores a file: writes pages into it and truncates it. 0: success, else errno, ANOTHER_WRITES or WAS_CHANGED. */
int amontons_overlay_mend(const char *path, int64_t n_pages, const int64_t *index, const unsigned char *bytes,
                          int64_t end)
{
  int descriptor = open(path, O_RDWR | O_CLOEXEC), status = 0;
  if (descriptor < 0) return errno;
  status = take_lock(descriptor);
  for (int64_t k = 0; k < n_pages && !status; k++)
    if (!write_disk(descriptor, bytes + k * PAGE, PAGE, (off_t)index[k] * PAGE)) status = errno;
  if (!status && (ftruncate(descriptor, (off_t)end) < 0 || fsync(descriptor) < 0)) status = errno;
  close(descriptor);
  return status;
}
