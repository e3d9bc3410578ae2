// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "Arguments.h"

namespace dyslam
{
/** Writes every requested output, each with its progress.
 * \return points in the cloud that was written last, or in the map. \throws UserError. */
std::size_t writeOutputs(MapBuilder& builder, const Arguments& a);
}  // namespace dyslam
