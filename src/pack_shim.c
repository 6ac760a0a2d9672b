/* Pack shim: one chunk of doubles into an HDF5 data set, packed as its filters shuffle and deflate would, but faster, for store.f90.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Shuffle sorts the eight bytes of all doubles into eight planes. The planes of the exponents and of the first digits can be packed;
 * those of the last digits are noise, on which deflate spends nearly all of its time for nothing. Here the planes of noise go into
 * the same stream as they are ("stored" blocks of RFC 1951). Any reader of HDF5 reads the chunk. It is C because the chunk is
 * written by H5Dwrite_chunk, which the Fortran interface of HDF5 1.10 does not have, and packed by zlib. */
#include <hdf5.h>
#include <math.h>
#include <stdlib.h>
#include <zlib.h>

enum { BYTES = 8, LEVEL = 1 };
static const double NOISE = 7.2; /* bits a byte: a plane with more entropy than this is left as it is */

/* The entropy of a plane in bits a byte. */
static double entropy(const unsigned char *plane, size_t n)
{
  size_t count[4][256] = {{0}}; /* four tables, so that equal neighbours do not wait for each other */
  double bits = 0;
  for (size_t i = 0; i < n; i++) count[i & 3][plane[i]]++;
  for (int k = 0; k < 256; k++) {
    size_t c = count[0][k] + count[1][k] + count[2][k] + count[3][k];
    if (c) bits -= (double)c * log2((double)c / (double)n);
  }
  return bits / (double)n;
}

/* The planes, one after the other. */
static void shuffle(const unsigned char *values, size_t n, unsigned char *planes)
{
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < BYTES; j++) planes[j * n + i] = values[BYTES * i + j];
}

/* Packs the planes into one zlib stream. Returns its length, 0 if it fails. */
static size_t pack(unsigned char *planes, size_t n, unsigned char *packed, size_t room)
{
  z_stream z = {0};
  if (deflateInit(&z, LEVEL) != Z_OK) return 0;
  z.next_out = packed;
  z.avail_out = (uInt)room;
  int status = Z_OK;
  for (size_t j = 0; j < BYTES && (status == Z_OK || status == Z_BUF_ERROR); j++) {
    z.next_in = planes + j * n;
    z.avail_in = 0;
    status = deflateParams(&z, entropy(planes + j * n, n) > NOISE ? 0 : LEVEL, Z_DEFAULT_STRATEGY);
    if (status != Z_OK && status != Z_BUF_ERROR) break; /* a buffer error: there was nothing to flush */
    z.avail_in = (uInt)n;
    status = deflate(&z, j + 1 == BYTES ? Z_FINISH : Z_NO_FLUSH);
  }
  size_t length = status == Z_STREAM_END ? room - z.avail_out : 0;
  deflateEnd(&z);
  return length;
}

/* Writes n doubles as one whole chunk at an offset (in C's order of dimensions) of a data set with the filters shuffle and
 * deflate. Returns 0, or 1 if it could not be packed here (no memory, another order of bytes): then nothing is written; negative
 * if HDF5 could not write. */
int amontons_write_chunk(hid_t data_set, const hsize_t *offset, const double *values, size_t n)
{
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
  return 1;
#endif
  const size_t room = BYTES * n + BYTES * n / 512 + 4096; /* stored blocks have 5 bytes for 65535; slack for the small ones */
  if (n == 0 || room > 0x7fffffff) return 1;
  unsigned char *planes = malloc(BYTES * n), *packed = malloc(room);
  size_t length = 0;
  int status = 1;
  if (planes && packed) {
    shuffle((const unsigned char *)values, n, planes);
    length = pack(planes, n, packed, room);
  }
  if (length) status = H5Dwrite_chunk(data_set, H5P_DEFAULT, 0, offset, length, packed) < 0 ? -1 : 0;
  free(planes);
  free(packed);
  return status;
}
