// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace dyslam
{
/** Threads that share loops (TBB's). With one thread everything runs in the caller.
 *
 * Work is cut into chunks whose borders depend on the sizes alone, never on the number of threads,
 * so that a reduction which keeps one partial result per chunk and adds them in order gives the
 * same bytes for any thread count. Several callers may run loops at a time and share the threads;
 * loops must not be nested.
 */
class ThreadPool
{
 public:
  /** \param threads maximum number; 0: number of cores. More than the cores are never used. */
  explicit ThreadPool(int threads = 1);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /** Requested number of threads; the number of cores if 0 was requested. */
  [[nodiscard]] int size() const;

  /** Calls body(begin, end, chunk) for every chunk of [0, count), chunks numbered from 0. An
   * exception ends the loop and reaches the caller. */
  void forChunks(std::size_t count,
                 std::size_t chunk_size,
                 const std::function<void(std::size_t, std::size_t, std::size_t)>& body);

  /** Number of chunks that forChunks() makes. \param chunk_size above 0 */
  [[nodiscard]] static std::size_t chunkCount(std::size_t count, std::size_t chunk_size)
  {
    return (count + chunk_size - 1) / chunk_size;
  }

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};
}  // namespace dyslam
