// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/train/TrainRequest.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Settings of a training that goes on which differ from those that it began with, and change its
 * result: "[train] learning_rate = 0.01 (before: 0.0015)". Not among them are number of steps,
 * threads, and how often it is validated and saved.
 * \param earlier_ini effective.ini of the training; without such a file there are none
 * \throws UserError if it cannot be read. */
[[nodiscard]] std::vector<std::string> changedSettings(const std::string& earlier_ini,
                                                       const Config& effective);

/** One line of these settings for the console; empty without. */
[[nodiscard]] std::string changedSettingsNote(const std::string& earlier_ini,
                                              const Config& effective);

/** Writes the effective.ini of a training into the folder of its results, which is made if it does
 * not exist. One that is resumed with other settings reports them. \throws UserError. */
void writeSettings(const Config& effective, const TrainRequest& request);
}  // namespace dyslam
