// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

namespace dyslam
{
/** Marks the points in the box of a moving object (vehicle frame) as moving by prediction, unless
 * the segmenter found most of them. */
void markMissed(const Box& box, Frame& frame);
}  // namespace dyslam
