/* Pack shim: one chunk of doubles into an HDF5 data set, packed as its filters shuffle and deflate would, but faster, for store.f90.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Shuffle sorts the eight bytes of all doubles into eight planes. The planes of the exponents and of the first digits can be packed;
 * those of the last digits are noise, on which deflate spends nearly all of its time for nothing. Here the planes of noise go into
 * the same stream as they are ("stored" blocks of RFC 1951). Any reader of HDF5 reads the chunk. It is C because the chunk is
 * written by H5Dwrite_chunk, which the Fortran interface of HDF5 1.10 does not have, and packed by zlib. */
#include <hdf5.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { BYTES = 8, LEVEL = 1, MOST_STORED = 65535, HEAD = 2, WORTH_THREADS = 20000, SAMPLE = 2048, EVERY = 16384 };
enum { MODULUS = 65521, SUMMED = 4096, SHUFFLED = 1024 };
static const double NOISE = 6.7; /* bits a byte: a plane with more entropy than this is left as it is. Deflate makes a tenth less of a
                                    plane with 7.2 bits, 1.5 % of a file, and took half of the time of packing for it. */

/* The entropy of a plane in bits a byte, by a sample: a stretch of SAMPLE bytes in each EVERY. */
static double entropy(const unsigned char *plane, size_t n)
{
  size_t count[4][256] = {{0}}, seen = 0; /* four tables, so that equal neighbours do not wait for each other */
  double bits = 0;
  for (size_t start = 0; start < n; start += EVERY) {
    size_t end = start + SAMPLE < n ? start + SAMPLE : n;
    for (size_t i = start; i < end; i++) count[i & 3][plane[i]]++;
    seen += end - start;
  }
  for (int k = 0; k < 256; k++) {
    size_t c = count[0][k] + count[1][k] + count[2][k] + count[3][k];
    if (c) bits -= (double)c * log2((double)c / (double)seen);
  }
  return bits / (double)seen;
}

/* The planes, one after the other; so many values at a time that they stay in the cache while each plane takes its byte of them. */
static void shuffle(const uint64_t *values, size_t n, unsigned char *planes)
{
#pragma omp parallel for schedule(static) if(n > WORTH_THREADS)
  for (size_t start = 0; start < n; start += SHUFFLED) {
    size_t end = start + SHUFFLED < n ? start + SHUFFLED : n;
    for (size_t j = 0; j < BYTES; j++)
      for (size_t i = start; i < end; i++) planes[j * n + i] = (unsigned char)(values[i] >> 8 * j);
  }
}

/* Adler's sum of RFC 1950 of a plane. Over SUMMED bytes a and b do not reach 2^32, and the compiler adds them up in vectors. */
static uLong adler_sum(const unsigned char *plane, size_t n)
{
  uint32_t a = 1, b = 0;
  for (size_t start = 0; start < n; start += SUMMED) {
    uint32_t m = (uint32_t)(n - start < SUMMED ? n - start : SUMMED), sum = 0, weighted = 0;
    for (uint32_t i = 0; i < m; i++) {
      sum += plane[start + i];
      weighted += (m - i) * plane[start + i];
    }
    b = (b + m * a % MODULUS + weighted % MODULUS) % MODULUS;
    a = (a + sum) % MODULUS;
  }
  return (uLong)b << 16 | a;
}

/* A plane as it is, in stored blocks: a byte 0, length and its complement, the bytes. Returns the length. */
static size_t store(const unsigned char *plane, size_t n, unsigned char *to)
{
  unsigned char *start = to;
  for (size_t done = 0; done < n;) {
    size_t m = n - done < MOST_STORED ? n - done : MOST_STORED;
    *to++ = 0;
    *to++ = (unsigned char)(m & 255);
    *to++ = (unsigned char)(m >> 8);
    *to++ = (unsigned char)(~m & 255);
    *to++ = (unsigned char)(~m >> 8 & 255);
    memcpy(to, plane + done, m);
    to += m;
    done += m;
  }
  return (size_t)(to - start);
}

/* A plane deflated, up to the border of a byte, so that another piece can follow. Returns the length, 0 if it fails. */
static size_t squeeze(unsigned char *plane, size_t n, unsigned char *to, size_t room)
{
  z_stream z = {0};
  if (deflateInit2(&z, LEVEL, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_RLE) != Z_OK) return 0;
  z.next_in = plane;
  z.avail_in = (uInt)n;
  z.next_out = to;
  z.avail_out = (uInt)room;
  int status = deflate(&z, Z_FULL_FLUSH);
  size_t length = status == Z_OK && z.avail_in == 0 && z.avail_out > 0 ? room - z.avail_out : 0;
  deflateEnd(&z);
  return length;
}

/* Packs the planes, each by itself, into one zlib stream (RFC 1950): threads share them, and the bytes do not depend on who did what.
 * Each plane has `room` bytes in `packed`. Returns the length of the stream, 0 if it fails. */
static size_t pack(unsigned char *planes, size_t n, unsigned char *packed, size_t room)
{
  size_t length[BYTES];
  uLong sum[BYTES];
#pragma omp parallel for schedule(dynamic) if(n > WORTH_THREADS)
  for (int j = 0; j < BYTES; j++) {
    unsigned char *plane = planes + (size_t)j * n, *to = packed + HEAD + (size_t)j * room;
    length[j] = entropy(plane, n) > NOISE ? 0 : squeeze(plane, n, to, room);
    if (length[j] == 0) length[j] = store(plane, n, to);
    sum[j] = adler_sum(plane, n);
  }
  size_t total = HEAD;
  uLong check = sum[0];
  packed[0] = 0x78; /* deflate with a window of 32 kB */
  packed[1] = 0x01;
  for (int j = 0; j < BYTES; j++) {
    memmove(packed + total, packed + HEAD + (size_t)j * room, length[j]);
    total += length[j];
    if (j > 0) check = adler32_combine(check, sum[j], (z_off_t)n);
  }
  packed[total++] = 0x03; /* an empty block, the last one */
  packed[total++] = 0x00;
  for (int k = 24; k >= 0; k -= 8) packed[total++] = (unsigned char)(check >> k & 255);
  return total;
}

/* Writes n doubles (as words of 64 bits) as one whole chunk at an offset (in C's order of dimensions) of a data set with the filters shuffle and
 * deflate. Returns 0, or 1 if it could not be packed here (no memory, another order of bytes): then nothing is written; negative
 * if HDF5 could not write. */
int amontons_write_chunk(hid_t data_set, const hsize_t *offset, const uint64_t *values, size_t n)
{
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
  return 1;
#endif
  const size_t room = n + n / 512 + 4096; /* stored blocks have 5 bytes for 65535; slack for the small ones */
  if (n == 0 || room > 0x7fffffff / BYTES) return 1;
  unsigned char *planes = malloc(BYTES * n), *packed = malloc(BYTES * room + 2 * HEAD + 8);
  size_t length = 0;
  int status = 1;
  if (planes && packed) {
    shuffle(values, n, planes);
    length = pack(planes, n, packed, room);
  }
  if (length) status = H5Dwrite_chunk(data_set, H5P_DEFAULT, 0, offset, length, packed) < 0 ? -1 : 0;
  free(planes);
  free(packed);
  return status;
}
