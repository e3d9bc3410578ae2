// SPDX-License-Identifier: BSD-3-Clause
// What settings a run has, and whether given ones are right, before the recording is at hand.
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/run/GivenSettings.h>

#include <string>
#include <vector>

namespace dyslam
{
/** All sections and keys of a run, as in effective.ini, with their defaults. Builds a run to find
 * them. */
[[nodiscard]] Config defaultSettings();
/** Names of the sections of defaultSettings(), sorted. */
[[nodiscard]] std::vector<std::string> sectionsOfRun();

/** Checks the names of settings, not their values.
 * \throws UserError for a section or key that no run has, as the constructor of SlamRun does; it
 * names the sections that have such a key */
void requireKnownNames(const Config& config);
/** Checks names and values of settings, also the files that they name. A value is accepted if a run
 * with any sensor would accept it.
 * \throws UserError as the constructor of SlamRun with these settings does */
void requireValidSettings(const GivenSettings& given);
}  // namespace dyslam
