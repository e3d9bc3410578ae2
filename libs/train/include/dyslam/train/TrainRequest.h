// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace dyslam
{
/** What a user asks of a training of either network, beside its config. */
struct TrainRequest
{
  /** Folder for the results: weights, checkpoint.safetensors, tables and effective.ini. */
  std::string output;
  bool resume = false;         //!< continue from checkpoint.safetensors in `output`
  std::string start;           //!< file of the initial weights; empty: none
  std::string device = "cpu";  //!< cpu or cuda
  /** Print the validation table of `start`, or if that is empty of the weights in `output`, and
   * write nothing. */
  bool validate_only = false;
  /** Polled before each step: true saves and ends the training; null for never. */
  std::function<bool()> stopped;
  std::function<void(const std::string&)> report;  //!< receives one line of progress at a time
};
}  // namespace dyslam
