/* Two jobs in one program, coupled: two bars in series, each a job; the displacement of the interface goes one way, the
 * force comes back, until they agree. Each increment is tried, rolled back and tried again; then both jobs commit.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "amontons.h"

static const char *deck =
    "*NODE, NSET=ALL\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
    "*ELEMENT, TYPE=C3D8, ELSET=BAR\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=BOTTOM\n1,2,3,4\n*NSET, NSET=TOP\n5,6,7,8\n"
    "*MATERIAL, NAME=M\n*ELASTIC\n%g, 0.\n*SOLID SECTION, ELSET=BAR, MATERIAL=M\n"
    "*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\nALL, 1, 2\n%s, 3, 3\n%s*END STEP\n";

static int failed(const char *verb, int status, amontons_job *job)
{
  if (status) printf("%s: status %d: %s\n", verb, status, amontons_message(job));
  return status;
}

#define TRY(verb, job) do { if (failed(#verb, (verb), (job))) return 1; } while (0)

static int start(double modulus, const char *held, const char *more, amontons_job **job)
{
  char text[2000];
  amontons_options options = AMONTONS_OPTIONS;
  snprintf(text, sizeof text, deck, modulus, held, more);
  options.text = text;
  return failed("open", amontons_open(&options, job), *job);
}

/* The sum of a quantity's third component over a set of four nodes. */
static int sum3(amontons_job *job, const char *quantity, const char *set, double *sum)
{
  double values[12];
  int64_t rows, columns;
  int status = failed("get", amontons_get(job, quantity, set, values, 12, &rows, &columns), job);
  *sum = 0;
  for (int i = 0; i < rows; i++) *sum += values[3 * i + 2];
  return status;
}

int main(void)
{
  const double soft = 100, stiff = 250, stroke = 0.04;
  amontons_job *lower, *upper;
  /* The lower bar gets the displacement of the interface at its top, the upper one the force at its bottom. */
  if (start(soft, "BOTTOM", "TOP, 3, 3\n", &lower) || start(stiff, "TOP", "", &upper)) return 1;
  double u = 0;
  for (int increment = 1; increment <= 4; increment++) {
    int iteration = 0;
    for (double change = 1; fabs(change) > 1e-13; iteration++) {
      double force, at, all = stroke * increment / 4;
      if (iteration > 0) {
        TRY(amontons_rollback(lower), lower);
        TRY(amontons_rollback(upper), upper);
      }
      TRY(amontons_set(lower, "U3", "TOP", &u, 1), lower);
      TRY(amontons_try(lower, 0.25), lower);
      if (sum3(lower, "RF", "TOP", &force)) return 1;
      double share = -force / 4;
      TRY(amontons_set(upper, "CF3", "BOTTOM", &share, 1), upper);
      TRY(amontons_set(upper, "U3", "TOP", &all, 1), upper);
      TRY(amontons_try(upper, 0.25), upper);
      if (sum3(upper, "U", "BOTTOM", &at)) return 1;
      change = at / 4 - u;
      u += change;
      if (iteration > 100) { printf("the bars do not agree\n"); return 1; }
    }
    TRY(amontons_commit(lower), lower);
    TRY(amontons_commit(upper), upper);
    printf("increment %d: %d iterations, interface at %.12f\n", increment, iteration, u);
  }
  int is_done = amontons_is_done(lower) && amontons_is_done(upper);
  double expected = stroke * stiff / (soft + stiff);
  amontons_close(lower);
  amontons_close(upper);
  printf("expected %.12f, both done: %d\n", expected, is_done);
  return fabs(u - expected) > 1e-12 || !is_done;
}
