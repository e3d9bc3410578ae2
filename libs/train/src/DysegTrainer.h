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

/** A training of DySeg's network, or the validation of its weights: the steps of trainDyseg(). */
class DysegTrainer
{
 public:
  /** \throws UserError for options out of range, a device that there is not, or if validation
   * frames are training frames. Frames of another split are refused where they are read. */
  DysegTrainer(const DysegTrainerSetup& setup, std::string folder);
  ~DysegTrainer();

  /** Makes sure that no training is overwritten. \throws UserError if the folder holds a training.
   */
  void requireFreshFolder() const;
  /** Resumes from the folder's checkpoint. \throws UserError if there is none or it does not fit.
   */
  void resume();
  /** Starts from the weights of a file. \throws UserError, also if they were trained for another
   * grid; only the number of cells may differ. */
  void startFrom(const std::string& weights);
  /** Reads the data of training and validation; run() does it otherwise. Writes nothing.
   * \throws UserError if some are missing or of another split. */
  void loadData();
  /** \param report is called with a line of progress from time to time \param stopped is polled
   * before each step: true saves and ends; null for never. \throws UserError as loadData(). */
  void run(const std::function<void(const std::string&)>& report,
           const std::function<bool()>& stopped = nullptr);
  /** The validation table of a file of weights, empty for the folder's dyseg.safetensors, with the
   * grid and network that they were trained for. Writes nothing. \param given must be those of the
   * weights \throws UserError if there are no weights, or of another grid or network. */
  void validateOnly(const std::string& weights,
                    const GivenDysegShape& given,
                    const std::function<void(const std::string&)>& report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
