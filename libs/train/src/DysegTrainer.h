// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "DysegTrainerOptions.h"

namespace dyslam
{
/** What the user states about weights that are validated; nothing where the weights decide. */
struct GivenDysegShape
{
  std::optional<BevOptions> grid;
  std::optional<DysegNetworkOptions> network;
};

/** A training of DySeg's network, ready to run: settings are checked, weights and data are loaded.
 */
class DysegTrainer
{
 public:
  /** A new training; writes nothing. \param weights file to start from, trained for the same grid,
   * of which only the number of cells may differ; empty: random weights
   * \throws UserError for options out of range, a device that there is not, a folder that holds a
   * training, weights that do not fit, data that are missing or of another split, and if validation
   * frames are training frames. */
  [[nodiscard]] static DysegTrainer begin(const DysegTrainerSetup& setup,
                                          std::string folder,
                                          const std::string& weights = "");
  /** A training that goes on from the folder's checkpoint; writes nothing. \throws UserError as
   * begin(), and if there is no checkpoint or it does not fit. */
  [[nodiscard]] static DysegTrainer resume(const DysegTrainerSetup& setup, std::string folder);
  ~DysegTrainer();
  DysegTrainer(const DysegTrainer&) = delete;
  DysegTrainer& operator=(const DysegTrainer&) = delete;

  /** Trains to the last step; called once. \param report is called with a line of progress from
   * time to time \param stopped is polled before each step: true saves and ends; null for never.
   * \throws UserError if a file cannot be written. */
  void run(const std::function<void(const std::string&)>& report,
           const std::function<bool()>& stopped = nullptr);

 private:
  struct Impl;
  explicit DysegTrainer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/** Reports the validation table of a file of weights, with the grid and network that they were
 * trained for. Writes nothing.
 * \param weights empty: dyseg.safetensors in `folder` \param given must be those of the weights
 * \throws UserError for options out of range, a device that there is not, data that are missing or
 * of another split, and if there are no weights, or of another grid or network. */
void validateDyseg(const DysegTrainerSetup& setup,
                   const std::string& folder,
                   const std::string& weights,
                   const GivenDysegShape& given,
                   const std::function<void(const std::string&)>& report);
}  // namespace dyslam
