// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace dyslam
{
/** Takes a note for the user about the files that are read: one sentence, without a full stop or an
 * end of line. */
using NoteSink = std::function<void(const std::string& note)>;
}  // namespace dyslam
