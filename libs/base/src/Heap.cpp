// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>

#ifdef __linux__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>  // defines __GLIBC__
#endif

namespace dyslam
{
#if defined(__linux__) && defined(__GLIBC__)
namespace
{
constexpr int mebibyte = 1 << 20;
constexpr int reserved = 1024 * mebibyte;  // address space, not memory

/** Grows the heap by the reserved address space and asks for huge pages there. */
void useHugePages()
{
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(sbrk(0)) + page - 1) / page * page;
  void* volatile block = std::malloc(16 * mebibyte);  // more than is left: grows by M_TOP_PAD
  std::free(block);
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0)) / page * page;
  if (end > begin)
  {
    // Where the system refuses, the program is only slower.
    (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  }
}
}  // namespace
#endif

void tuneHeap([[maybe_unused]] int arenas)
{
#if defined(__linux__) && defined(__GLIBC__)
  mallopt(M_MMAP_MAX, 0);  // large blocks come from the heap too
  mallopt(M_TRIM_THRESHOLD, 2047 * mebibyte);
  mallopt(M_TOP_PAD, reserved);
  mallopt(M_ARENA_MAX, arenas);
  useHugePages();
#endif
}
}  // namespace dyslam
