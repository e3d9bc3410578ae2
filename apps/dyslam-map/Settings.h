// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Arguments.h"

namespace dyslam
{
/** Reads the sections of dyslam-map from the ini; the ini of a run may have others. Without an ini,
 * `effective.ini` of the run, beside the trajectory (if it exists) or of the first merged run is
 * read. \throws UserError. */
void loadConfig(Arguments& a);
}  // namespace dyslam
