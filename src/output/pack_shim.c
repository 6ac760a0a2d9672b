/* Pack shim: writes one chunk of doubles to an HDF5 data set, compressed like shuffle and deflate but faster, for hdf5_file.f90.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Shuffle sorts the eight bytes of all doubles into eight planes. The planes of the exponents and of the first digits are compressible;
 * those of the last digits are noise, on which deflate spends nearly all of its time without effect. Here noise planes are written
 * uncompressed ("stored" blocks of RFC 1951), intermediate planes by Huffman codes alone, and planes with repetitions by zlib.
 * Any reader of HDF5 reads the chunk. It is C because the Fortran interface of HDF5 1.10 lacks H5Dwrite_chunk, and for zlib. */
#include <hdf5.h>
#include <math.h>
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { BYTES = 8, LEVEL = 1, MAX_STORED = 65535, HEAD = 2, WORTH_THREADS = 20000, SAMPLE = 2048, EVERY = 16384 };
enum { MODULUS = 65521, SUMMED = 4096, SYMBOLS = 257, LONGEST = 15 };
static const double REPEATED = 1.0; /* bits per byte: a plane with less entropy is deflated, to use its repetitions */
static const double NOISE = 6.7; /* bits per byte: a plane with more entropy is stored. Deflate saves a tenth of a plane with
                                    7.2 bits, 1.5 % of a file, and takes half of the compression time for it. */

/* The entropy of a plane in bits per byte, from a sample of SAMPLE bytes in each EVERY. */
static double entropy(const unsigned char *plane, size_t n)
{
  size_t count[4][256] = {{0}}, seen = 0; /* four tables, so that equal neighbours cause no dependency */
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

/* Byte j of all values. */
static void gather(const uint64_t *values, size_t n, int j, unsigned char *plane)
{
  for (size_t i = 0; i < n; i++) plane[i] = (unsigned char)(values[i] >> 8 * j);
}

/* Adler's checksum (RFC 1950) of a plane. Over SUMMED bytes a and b do not reach 2^32, so the compiler can vectorize the sums. */
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

/* A plane uncompressed, in stored blocks: a byte 0, length and its complement, the bytes. Returns the length. */
static size_t store(const unsigned char *plane, size_t n, unsigned char *to)
{
  unsigned char *start = to;
  for (size_t done = 0; done < n;) {
    size_t m = n - done < MAX_STORED ? n - done : MAX_STORED;
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

/* A plane deflated, up to a byte boundary, so that another piece can follow. Returns the length, 0 on failure. */
static size_t squeeze(unsigned char *plane, size_t n, unsigned char *to, size_t capacity)
{
  z_stream z = {0};
  if (deflateInit2(&z, LEVEL, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_RLE) != Z_OK) return 0;
  z.next_in = plane;
  z.avail_in = (uInt)n;
  z.next_out = to;
  z.avail_out = (uInt)capacity;
  int status = deflate(&z, Z_FULL_FLUSH);
  size_t length = status == Z_OK && z.avail_in == 0 && z.avail_out > 0 ? capacity - z.avail_out : 0;
  deflateEnd(&z);
  return length;
}

/* Bits in the order of RFC 1951: lowest first; codes with their highest bit first, that is reversed beforehand. */
typedef struct {
  unsigned char *to;
  uint64_t bits;
  unsigned n;
} bit_writer;

static void put_bits(bit_writer *self, uint32_t value, unsigned n)
{
  self->bits |= (uint64_t)value << self->n;
  self->n += n;
}

/* Writes the whole bytes; there must be space for eight. At most 57 bits can then be added before the next call. */
static void flush_bits(bit_writer *self)
{
  memcpy(self->to, &self->bits, sizeof self->bits);
  self->to += self->n >> 3;
  self->bits >>= self->n & ~7u;
  self->n &= 7;
}

/* Ends a block, whose end is written, at a byte boundary: by a stored block without bytes. Returns the place behind it. */
static unsigned char *align(bit_writer *self)
{
  flush_bits(self);
  put_bits(self, 0, 3);
  put_bits(self, 0, (8 - self->n % 8) % 8);
  flush_bits(self);
  put_bits(self, 0xffff0000u, 32);
  flush_bits(self);
  return self->to;
}

/* Lengths of the Huffman codes for counts, at most LONGEST; 0 for symbols that do not occur. */
static void code_lengths(const uint32_t *count, unsigned char *length)
{
  uint64_t weight[2 * SYMBOLS];
  int parent[2 * SYMBOLS], symbol[SYMBOLS], n = 0;
  for (int s = 0; s < SYMBOLS; s++) {
    length[s] = 0;
    if (count[s] == 0) continue;
    int k = n++;                                /* sorted by counts, equal ones by their number */
    for (; k > 0 && count[symbol[k - 1]] > count[s]; k--) symbol[k] = symbol[k - 1];
    symbol[k] = s;
  }
  for (unsigned shift = 0;; shift++) {          /* smaller differences between counts shorten the longest code */
    for (int k = 0; k < n; k++) weight[k] = count[symbol[k]] >> shift > 0 ? count[symbol[k]] >> shift : 1;
    int leaf = 0, branch = n, longest = 0;
    for (int next = n; next < 2 * n - 1; next++) {
      weight[next] = 0;
      for (int child = 0; child < 2; child++) {
        int least = leaf < n && (branch == next || weight[leaf] <= weight[branch]) ? leaf++ : branch++;
        weight[next] += weight[least];
        parent[least] = next;
      }
    }
    for (int k = 0; k < n; k++) {
      int depth = 0;
      for (int at = k; at != 2 * n - 2; at = parent[at]) depth++;
      length[symbol[k]] = (unsigned char)depth;
      if (depth > longest) longest = depth;
    }
    if (longest <= LONGEST) return;
  }
}

/* The codes for the lengths, bits reversed. */
static void number_codes(const unsigned char *length, uint16_t *code)
{
  uint32_t next = 0;
  for (int bits = 1; bits <= LONGEST; bits++, next <<= 1)
    for (int s = 0; s < SYMBOLS; s++) {
      if (length[s] != bits) continue;
      uint32_t turned = 0;
      for (int k = 0; k < bits; k++) turned |= (next >> k & 1) << (bits - 1 - k);
      code[s] = (uint16_t)turned;
      next++;
    }
}

/* A plane as one block of Huffman codes without repetitions, up to a byte boundary: five times as fast as deflate, which searches for
 * repetitions that bytes of exponents do not have. Returns the length, 0 if the plane would not become shorter. */
static size_t encode(const unsigned char *plane, size_t n, unsigned char *to)
{
  uint32_t count[4][SYMBOLS] = {{0}};
  unsigned char length[SYMBOLS];
  uint16_t code[SYMBOLS] = {0};
  size_t bits = 0;
  bit_writer writer = {to, 0, 0};
  for (size_t i = 0; i < n; i++) count[i & 3][plane[i]]++;
  for (int s = 0; s < SYMBOLS; s++) count[0][s] += count[1][s] + count[2][s] + count[3][s];
  count[0][SYMBOLS - 1] = 1; /* the end of the block */
  code_lengths(count[0], length);
  for (int s = 0; s < SYMBOLS; s++) bits += (size_t)count[0][s] * length[s];
  if (bits / 8 + 256 >= n) return 0;
  number_codes(length, code);
  put_bits(&writer, 2 << 1 | 15 << 13, 17);     /* dynamic codes; 257 of bytes, one of distances, all 19 of lengths: */
  for (int k = 0; k < 19; k++) {                /* none for repetitions (16 to 18 come first), four bits for each length from 0 to 15 */
    put_bits(&writer, k < 3 ? 0 : 4, 3);
    flush_bits(&writer);
  }
  for (int s = 0; s <= SYMBOLS; s++) {          /* the last is the length of the unused code of distances */
    unsigned v = s < SYMBOLS ? length[s] : 0;
    put_bits(&writer, (v & 1) << 3 | (v & 2) << 1 | (v & 4) >> 1 | v >> 3, 4);
    flush_bits(&writer);
  }
  size_t i = 0;
  for (; i + 3 <= n; i += 3) {
    for (size_t k = i; k < i + 3; k++) put_bits(&writer, code[plane[k]], length[plane[k]]);
    flush_bits(&writer);
  }
  for (; i < n; i++) put_bits(&writer, code[plane[i]], length[plane[i]]);
  flush_bits(&writer);
  put_bits(&writer, code[SYMBOLS - 1], length[SYMBOLS - 1]);
  return (size_t)(align(&writer) - to);
}

/* n equal bytes, as one block of the fixed codes of RFC 1951: the byte, repetitions of it with length 258 and distance 1 (codes 11000101
 * and 00000), and what remains byte by byte. Returns the length. */
static size_t repeat(unsigned char byte, size_t n, unsigned char *to)
{
  bit_writer writer = {to, 0, 0};
  unsigned bits = byte < 144 ? 8 : 9;
  uint32_t code = byte < 144 ? 0x30u + byte : 0x190u + (byte - 144u), turned = 0;
  for (unsigned k = 0; k < bits; k++) turned |= (code >> k & 1) << (bits - 1 - k);
  put_bits(&writer, 1 << 1, 3);
  put_bits(&writer, turned, bits);
  flush_bits(&writer);
  for (size_t k = 0; k < (n - 1) / 258; k++) {
    put_bits(&writer, 0xa3, 13);
    flush_bits(&writer);
  }
  for (size_t k = 0; k < (n - 1) % 258; k++) {
    put_bits(&writer, turned, bits);
    flush_bits(&writer);
  }
  put_bits(&writer, 0, 7); /* the end of the block */
  return (size_t)(align(&writer) - to);
}

/* Adler's checksum of n equal bytes. */
static uLong adler_of_equal(unsigned char byte, size_t n)
{
  uint64_t a = 1 + (uint64_t)n * byte, b = n + (uint64_t)n * (n + 1) / 2 % MODULUS * byte;
  return (uLong)(b % MODULUS) << 16 | (uLong)(a % MODULUS);
}

/* Compresses the planes one by one, each into its `capacity` bytes of `packed`; their lengths (0 on failure) and checksums. The
 * planes are tasks, which threads that wait at the end of their own work take over. Each has one plane in memory. */
static void pack_planes(const uint64_t *values, size_t n, unsigned char *packed, size_t capacity, size_t *length, uLong *sum)
{
#pragma omp taskloop grainsize(1)
  for (int j = 0; j < BYTES; j++) {
    unsigned char *to = packed + HEAD + (size_t)j * capacity, *plane = malloc(n);
    if (!plane) continue;
    gather(values, n, j, plane);
    double bits = entropy(plane, n);
    length[j] = bits > NOISE ? 0 : bits > REPEATED ? encode(plane, n, to) : squeeze(plane, n, to, capacity);
    if (length[j] == 0) length[j] = store(plane, n, to);
    sum[j] = adler_sum(plane, n);
    free(plane);
  }
}

/* Compresses values into one zlib stream (RFC 1950), plane by plane; the result does not depend on the threads. Each plane has
 * `capacity` bytes in `packed`. Returns the length of the stream, 0 on failure. */
static size_t pack(const uint64_t *values, size_t n, unsigned char *packed, size_t capacity)
{
  size_t length[BYTES] = {0};
  uLong sum[BYTES];
  int is_constant = memcmp(values, values + 1, (n - 1) * sizeof *values) == 0; /* the fields before the first increment */
  if (is_constant) {
    for (int j = 0; j < BYTES; j++) {
      length[j] = repeat((unsigned char)(values[0] >> 8 * j), n, packed + HEAD + (size_t)j * capacity);
      sum[j] = adler_of_equal((unsigned char)(values[0] >> 8 * j), n);
    }
  } else if (omp_in_parallel()) {
    pack_planes(values, n, packed, capacity, length, sum);
  } else {
#pragma omp parallel if(n > WORTH_THREADS)
#pragma omp single
    pack_planes(values, n, packed, capacity, length, sum);
  }
  for (int j = 0; j < BYTES; j++)
    if (length[j] == 0) return 0;
  size_t total = HEAD;
  uLong check = sum[0];
  packed[0] = 0x78; /* deflate with a window of 32 kB */
  packed[1] = 0x01;
  for (int j = 0; j < BYTES; j++) {
    memmove(packed + total, packed + HEAD + (size_t)j * capacity, length[j]);
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
  const size_t capacity = n + n / 512 + 4096; /* stored blocks have 5 bytes for 65535; slack for the small ones */
  if (n == 0 || capacity > 0x7fffffff / BYTES) return 1;
  unsigned char *packed = malloc(BYTES * capacity + 2 * HEAD + 8);
  size_t length = packed ? pack(values, n, packed, capacity) : 0;
  int status = 1;
  if (length) status = H5Dwrite_chunk(data_set, H5P_DEFAULT, 0, offset, length, packed) < 0 ? -1 : 0;
  free(packed);
  return status;
}
