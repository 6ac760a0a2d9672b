/* Every verb of amontons.h once. api_calls.f90 and test_api_calls.py do the same in the same order; what the three say is compared line by
 * line, numbers by all their bits.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "amontons.h"

static int n_heard;

static void hear(void *context, const char *line)
{
  if (line[0]) ++*(int *)context;
}

/* One number of all bits of some numbers, in their order. */
static uint64_t mixed(const void *values, int64_t n)
{
  uint64_t sum = 0, bits;
  for (int64_t i = 0; i < n; i++) {
    memcpy(&bits, (const char *)values + 8 * i, 8);
    int by = (int)(i % 63) + 1;
    sum ^= bits << by | bits >> (64 - by);
  }
  return sum;
}

static void *allocate_block(int64_t n)
{
  void *memory = calloc(n > 0 ? (size_t)n : 1, 8);
  if (!memory) exit(9);
  return memory;
}

static void judge(int status, amontons_job *job)
{
  if (!status) return;
  printf("status %d: %s\n", status, amontons_message(job));
  exit(1);
}

static void print_values(amontons_job *job, const char *quantity, const char *set)
{
  int64_t rows, columns;
  judge(amontons_get(job, quantity, set, NULL, 0, &rows, &columns), job);
  double *values = allocate_block(rows * columns);
  judge(amontons_get(job, quantity, set, values, rows * columns, &rows, &columns), job);
  printf("%s of '%s': %lld x %lld %016llX\n", quantity, set, (long long)rows, (long long)columns,
         (unsigned long long)mixed(values, rows * columns));
  free(values);
}

static void print_all(amontons_job *job)
{
  static const char *const nodal[] = {"NODES", "X", "U", "RF", "S", "E", "NT", "CPRESS", "CSHEAR", "COPEN", "CSLIP", "CNORMF", "CSHEARF",
                                      "CSTATUS", "CSCENARIO", "CONTACT FORCE", "INTERNAL FORCE", "APPLIED FORCE", "RESIDUAL"};
  static const char *const numbers[] = {"TIME", "STEP TIME", "TIME LEFT", "STEP", "INCREMENTS", "ITERATIONS", "FRICTION", "FRICTION WORK",
                                        "EXTERNAL WORK", "STRAIN ENERGY"};
  for (size_t i = 0; i < sizeof nodal / sizeof *nodal; i++) print_values(job, nodal[i], "");
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) print_values(job, numbers[i], "");
  print_values(job, "P", "LOWER_TOP");
  print_values(job, "FACE CENTRES", "LOWER_TOP");
  print_values(job, "CF", "LOWER_TOP");
  print_values(job, "U", "UPPER_TOP");
  print_values(job, "POINT S", "UPPER");
  print_values(job, "ELEMENT S", "UPPER");
  print_values(job, "ELEMENT LABEL", "UPPER");
}

/* Nodes in scenarios I to IV, and one that opens. */
static void print_scenarios(void)
{
  const double tangential[2][5][3] = {{{5}, {5}, {1}, {1}, {1}}, {{2}, {4}, {4}, {2}, {1}}};
  const double normal_force[2][5] = {{10, 10, 10, 10, -1}, {10, 10, 10, 10, 10}};
  const double slip[2][5][3] = {{{0}, {0}, {0.2}, {0.2}, {0}}, {{0}, {0}, {0.1}, {-0.1}, {0}}};
  const double direction[5][3] = {{0.1}, {0.1}, {-0.1}, {-0.3}, {0.1}}, mu[5] = {0.3, 0.3, 0.3, 0.3, 0.3};
  int32_t verdicts[5][2];
  double alpha[5];
  int status = amontons_classify(5, &tangential[0][0][0], &normal_force[0][0], &slip[0][0][0], &direction[0][0], mu, NULL, &verdicts[0][0], alpha);
  printf("scenarios: %d", status);
  for (int i = 0; i < 5; i++) printf(" %d", verdicts[i][0]);
  for (int i = 0; i < 5; i++) printf(" %d", verdicts[i][1]);
  printf(" %016llX\n", (unsigned long long)mixed(alpha, 5));
  printf("no nodes: %d\n", amontons_classify(1, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL));
}

static void print_matrix(amontons_job *job, const char *name)
{
  int64_t rows, columns, entries, all, free_ones;
  judge(amontons_matrix(job, "MAP", &all, &free_ones, NULL), job);
  judge(amontons_matrix(job, name, &rows, &columns, &entries), job);
  int64_t *first = allocate_block(rows + 1), *column = allocate_block(entries);
  double *value = allocate_block(entries), *residual = allocate_block(free_ones);
  judge(amontons_matrix_copy(job, first, column, value), job);
  judge(amontons_residual_copy(job, residual), job);
  printf("%s: %lld x %lld, %lld entries %016llX %016llX %016llX, residual %016llX\n", name, (long long)rows, (long long)columns,
         (long long)entries, (unsigned long long)mixed(first, rows + 1), (unsigned long long)mixed(column, entries),
         (unsigned long long)mixed(value, entries), (unsigned long long)mixed(residual, free_ones));
  free(first), free(column), free(value), free(residual);
}

static void print_names(amontons_job *job, const char *kind)
{
  int64_t needed;
  judge(amontons_names(job, kind, NULL, 0, &needed), job);
  char *text = allocate_block(needed);
  judge(amontons_names(job, kind, text, needed, NULL), job);
  for (char *c = text; *c; c++)
    if (*c == '\n') *c = ' ';
  printf("%s: %s\n", kind, text);
  free(text);
}

/* A job of its own for a thread: from the file, to the time 0.4. */
static void *work(void *deck)
{
  amontons_options options = AMONTONS_OPTIONS;
  amontons_job *job;
  int64_t rows, columns;
  options.deck = deck;
  judge(amontons_open(&options, &job), job);
  judge(amontons_advance_to(job, 0.4), job);
  judge(amontons_get(job, "U", "", NULL, 0, &rows, &columns), job);
  double *values = allocate_block(rows * columns);
  judge(amontons_get(job, "U", "", values, rows * columns, NULL, NULL), job);
  amontons_close(job);
  return values;
}

static char *text_of(const char *path)
{
  FILE *file = fopen(path, "r");
  char *text = allocate_block(1 << 16);
  if (!file) exit(9);
  if (fread(text, 1, 8 * (1 << 16) - 1, file) == 0) exit(9);
  fclose(file);
  return text;
}

int main(int n, char **words)
{
  if (n != 2) return 9;
  char *text = text_of(words[1]);
  amontons_options options = AMONTONS_OPTIONS;
  amontons_job *job;
  int verdict, n_iterations = 0;
  double u = -0.0011, force[] = {0.0, 0.02, 0.0}, pressure = 0.5, warm = 35.0, mu = 0.25;

  if (amontons_abi() != AMONTONS_ABI) return 9;
  options.abi = AMONTONS_ABI + 1;
  printf("another interface: %d\n", amontons_open(&options, &job));
  amontons_close(job);
  print_scenarios();
  options.abi = AMONTONS_ABI;
  options.text = text;
  int status = amontons_open_on(&options, 0, &job);
  printf("a communicator: %d, %s\n", status, amontons_message(job));
  amontons_close(job);
  options.log = hear;
  options.context = &n_heard;
  judge(amontons_open(&options, &job), job);
  print_names(job, "NODE SETS");
  print_names(job, "QUANTITIES");
  judge(amontons_advance(job), job);
  judge(amontons_advance_to(job, 0.35), job);
  print_all(job);
  judge(amontons_set(job, "U3", "UPPER_TOP", &u, 1), job);
  judge(amontons_set(job, "CF", "LOWER_TOP", force, 3), job);
  judge(amontons_set(job, "P", "LOWER_TOP", &pressure, 1), job);
  judge(amontons_set(job, "NT", "UPPER_TOP", &warm, 1), job);
  judge(amontons_set(job, "FRICTION", "RUBBING", &mu, 1), job);
  judge(amontons_try(job, 0.2), job);
  print_all(job);
  judge(amontons_rollback(job), job);
  print_all(job);
  judge(amontons_begin(job, 0.1), job);
  do {
    judge(amontons_iterate(job, &verdict), job);
    n_iterations++;
  } while (verdict == AMONTONS_GO_ON);
  printf("verdict %d after %d\n", verdict, n_iterations);
  judge(amontons_commit(job), job);
  print_all(job);
  print_matrix(job, "TANGENT");
  print_matrix(job, "MAP");
  print_matrix(job, "STIFFNESS");
  status = amontons_get(job, "NONSENSE", "", NULL, 0, NULL, NULL);
  printf("an unknown name: %d, %s\n", status, amontons_message(job));
  judge(amontons_advance_to(job, 1.2), job);
  printf("done: %d\n", amontons_is_done(job));
  while (!amontons_is_done(job)) judge(amontons_advance(job), job);
  judge(amontons_finish(job), job);
  print_all(job);
  status = amontons_advance(job);
  printf("after the end: %d, %s\n", status, amontons_message(job));
  amontons_close(job);
  printf("heard: %d\n", n_heard);

  pthread_t threads[2];
  void *found[2];
  for (int i = 0; i < 2; i++)
    if (pthread_create(&threads[i], NULL, work, words[1])) return 9;
  for (int i = 0; i < 2; i++) pthread_join(threads[i], &found[i]);
  for (int i = 0; i < 2; i++) printf("thread %d: %016llX\n", i + 1, (unsigned long long)mixed(found[i], 3 * 66));
  free(found[0]), free(found[1]), free(text);
  return 0;
}
