// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

namespace dyslam
{
/** Sets torch's number of threads, which all networks of a program share: each network asks for its
 * own before it runs. Below 1 counts as 1. */
void useTorchThreads(int threads);

/** Calls body(begin, end) for parts of [0, count) on these threads; up to `grain` rows stay in one
 * part. Where parts end depends on the number of threads, so a body must treat each row by itself.
 */
void forRows(std::int64_t count,
             std::int64_t grain,
             const std::function<void(std::int64_t, std::int64_t)>& body);

/** Calls body(first, size) on these threads for each block of `block` rows in [0, count), the last
 * one shorter. Where blocks end depends on nothing else. */
void forBlocks(std::int64_t count,
               std::int64_t block,
               const std::function<void(std::int64_t, std::int64_t)>& body);
}  // namespace dyslam
