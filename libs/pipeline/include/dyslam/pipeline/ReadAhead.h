// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/pipeline/BoundedQueue.h>

#include <functional>
#include <optional>
#include <thread>

namespace dyslam
{
/** Gets frames in another thread, a few ahead of the consumer, in their order. The source may be
 * another ReadAhead, so that stages overlap. */
class ReadAhead
{
 public:
  /** \param next returns the next frame or nothing at the end; called only from that thread
   *  \param depth maximum number of frames that wait */
  explicit ReadAhead(std::function<std::optional<Frame>()> next, std::size_t depth = 2);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /** The next frame; nothing at the end. Throws the exception of `next` after all frames before it.
   */
  [[nodiscard]] std::optional<Frame> next() { return frames_.pop(); }

  /** The frame that next() will return, after waiting for it; null at the end. Valid until then. */
  [[nodiscard]] const Frame* peek() { return frames_.peek(); }

  [[nodiscard]] QueueWaits waits() { return frames_.waits(); }

 private:
  BoundedQueue<Frame> frames_;
  std::thread thread_;
};
}  // namespace dyslam
