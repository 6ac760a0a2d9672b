/* Text shim for text.f90: rows of numbers in the columns of Fortran's 1PE12.5, ten times as fast as formatted writes.
 * SPDX-License-Identifier: GPL-3.0-or-later
 *
 * A double times a power of ten in long double (64 bits of mantissa) is accurate to 1e-17; six digits need 1e-6. If the
 * remainder is so close to a half that the rounding of the product decides, printf is used. It is C for long double. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 12, WORTH_THREADS = 1000 };
static const double LOG10_OF_2 = 0.30102999566398120;
static const double NEAR_HALF = 1.0e-9; /* of a unit of the sixth digit */

/* A power of ten in long double, from a table of exact ones. */
static long double power(int k)
{
  static const long double SMALL[28] = {1e0L, 1e1L, 1e2L, 1e3L, 1e4L, 1e5L, 1e6L, 1e7L, 1e8L, 1e9L, 1e10L, 1e11L, 1e12L,
    1e13L, 1e14L, 1e15L, 1e16L, 1e17L, 1e18L, 1e19L, 1e20L, 1e21L, 1e22L, 1e23L, 1e24L, 1e25L, 1e26L, 1e27L};
  long double result = 1;
  for (; k > 27; k -= 27) result *= SMALL[27];
  return result * SMALL[k];
}

/* Sign, digit, point, five digits, exponent of two digits. */
static void put(char *text, int is_negative, long digits, int exponent)
{
  text[0] = is_negative ? '-' : ' ';
  for (int k = 7; k > 2; k--, digits /= 10) text[k] = (char)('0' + digits % 10);
  text[2] = '.';
  text[1] = (char)('0' + digits);
  text[8] = 'E';
  text[9] = exponent < 0 ? '-' : '+';
  if (exponent < 0) exponent = -exponent;
  text[10] = (char)('0' + exponent / 10);
  text[11] = (char)('0' + exponent % 10);
}

/* Writes n values side by side, twelve characters each. Values above 9.9e99 are limited to it, below 1e-99 they are 0. As in
 * CalculiX's files, numbers in the range of single precision are rounded to it first: this may change a sixth digit near a half. */
static void put_digits(const double *values, int n, char *text)
{
  for (int i = 0; i < n; i++, text += WIDTH) {
    double v = fabs(values[i]);
    if (v >= FLT_MIN && v <= FLT_MAX) v = (double)(float)v;
    if (!(v >= 1.0e-99)) { put(text, 0, 0, 0); continue; }
    if (v > 9.9e99) v = 9.9e99;
    int two;
    (void)frexp(v, &two);
    int exponent = (int)floor(two * LOG10_OF_2); /* that of v, or one more */
    long double scaled = exponent <= 5 ? v * power(5 - exponent) : v / power(exponent - 5);
    if (scaled < 99999.5L) { exponent--; scaled = exponent <= 5 ? v * power(5 - exponent) : v / power(exponent - 5); }
    long digits = (long)scaled;
    long double rest = scaled - digits;
    if (fabsl(rest - 0.5L) < NEAR_HALF) {
      char line[32];
      snprintf(line, sizeof line, "%.5E", v);
      exponent = (int)strtol(line + 8, NULL, 10);
      digits = (line[0] - '0') * 100000 + strtol(line + 2, NULL, 10);
    } else if (rest > 0.5L) {
      digits++;
    }
    if (digits >= 1000000) { digits /= 10; exponent++; }
    put(text, signbit(values[i]) != 0, digits, exponent);
  }
}

/* Rows of a block: ' -1', a label in ten columns, the values, the end of the line: 14 + 12 width characters a row. */
void amontons_put_rows(const int *labels, const double *values, int width, int n, char *text)
{
  const size_t length = 14 + (size_t)WIDTH * (size_t)width;
#pragma omp parallel for schedule(static) if(n > WORTH_THREADS)
  for (int i = 0; i < n; i++) {
    int label = labels[i];
    char *row = text + (size_t)i * length;
    memcpy(row, " -1          ", 13);
    for (int k = 12; k > 2 && (label > 0 || k == 12); k--, label /= 10) row[k] = (char)('0' + label % 10);
    put_digits(values + (size_t)i * (size_t)width, width, row + 13);
    row[length - 1] = '\n';
  }
}
