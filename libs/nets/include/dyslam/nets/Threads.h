// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>

#include <cstddef>
#include <cstdint>
#include <functional>

namespace dyslam
{
/** Sets torch's number of threads, which is global: each training sets its own, and networks on a
 * pool (LoopsOnPool) set 1. Values below 1 are taken as 1. */
void useTorchThreads(int threads);

/** While an object of this class lives, the loops of its thread run on its pool, and torch's own
 * operations in that thread alone: results do not depend on the number of threads. Without it, as
 * in training, the loops run on torch's threads.
 */
class LoopsOnPool
{
 public:
  /** \param pool outlives this object */
  explicit LoopsOnPool(ThreadPool& pool);
  ~LoopsOnPool();
  LoopsOnPool(const LoopsOnPool&) = delete;
  LoopsOnPool& operator=(const LoopsOnPool&) = delete;

 private:
  ThreadPool* before_;
};

/** Calls body(begin, end) for parts of [0, count) in parallel; `grain` is the least size of a part.
 * The parts may depend on the number of threads, so a body must treat each row independently.
 */
void forRows(std::int64_t count,
             std::int64_t grain,
             const std::function<void(std::int64_t, std::int64_t)>& body);

/** Calls body(row) for each row of [0, count) in parallel, `grain` or more rows at a time. */
template <typename Body>
void forEachRow(std::size_t count, std::int64_t grain, const Body& body)
{
  forRows(static_cast<std::int64_t>(count), grain,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t row = begin; row < end; ++row)
            {
              body(static_cast<std::size_t>(row));
            }
          });
}

/** Calls body(first, size) in parallel for each block of `block` rows in [0, count), the last one
 * shorter. The blocks do not depend on the number of threads. */
void forBlocks(std::int64_t count,
               std::int64_t block,
               const std::function<void(std::int64_t, std::int64_t)>& body);

/** Calls both functions, in parallel. */
void inParallel(const std::function<void()>& one, const std::function<void()>& other);
}  // namespace dyslam
