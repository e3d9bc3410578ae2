// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FreedMemory.h>

#include <cstdlib>  // defines __GLIBC__

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace dyslam
{
void keepFreedMemory()
{
#ifdef __GLIBC__
  constexpr int mebibyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);  // the most that glibc allows
  mallopt(M_TRIM_THRESHOLD, 1024 * mebibyte);
  mallopt(M_TOP_PAD, 64 * mebibyte);
  mallopt(M_ARENA_MAX, 1);  // what one thread frees, another one takes
#endif
}
}  // namespace dyslam
