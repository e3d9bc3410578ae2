// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Least number of points for the estimate of a motion. */
constexpr std::size_t min_scan_points = 30;

/** Reason why the frame's cloud cannot be used; empty if it can. */
[[nodiscard]] std::string reasonUnusable(const Frame& frame);
/** Sets reason and cause of a motion by reasonUnusable(); the reason is empty if the cloud can be
 * used. */
void setReasonUnusable(const Frame& frame, MotionEstimate& motion);
}  // namespace dyslam
