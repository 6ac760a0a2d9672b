/* Interface of the supernodal Cholesky factorisation to suitesparse_shim.c.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef AMONTONS_SUPERNODES_SHIM_H
#define AMONTONS_SUPERNODES_SHIM_H
#include <cholmod.h>

typedef struct supernode_plan supernode_plan;

supernode_plan *amontons_plan_new(const cholmod_factor *l, int n_parts);
void amontons_plan_free(supernode_plan *plan);
int amontons_plan_parts(const supernode_plan *plan);
int amontons_plan_factorise(const supernode_plan *plan, const cholmod_sparse *a, cholmod_factor *l);
int amontons_plan_forward(const supernode_plan *plan, const cholmod_factor *l, int limit, double *x);
int amontons_plan_backward(const supernode_plan *plan, const cholmod_factor *l, int limit, double *x);
int amontons_plan_forward_single(const supernode_plan *plan, const cholmod_factor *l, int limit, float *x);
int amontons_plan_backward_single(const supernode_plan *plan, const cholmod_factor *l, int limit, float *x);

#endif
