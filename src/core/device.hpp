// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The only two macros that kernels may use.

#if defined(__CUDACC__)
#define NOLI_HD __host__ __device__
#else
#define NOLI_HD
#endif

#include <cassert>
#define NOLI_DCHECK(cond) assert(cond)
