// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The only macros that kernels may use.

#if defined(__CUDACC__)
#define NOLI_HD __host__ __device__
#else
#define NOLI_HD
#endif

/// Before a loop that a GPU is not to unroll: for rare code, whose copies would take the
/// registers of what is not rare.
#if defined(__CUDA_ARCH__)
#define NOLI_ROLLED _Pragma("unroll 1")
#else
#define NOLI_ROLLED
#endif

#include <cassert>
#define NOLI_DCHECK(cond) assert(cond)
