// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/Augmentation.h>
#include <dyslam/train/Recordings.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Pairs of scans up to `max_gap` steps apart, either way round, from recordings with poses. */
class RecordingPairSource : public PairSource
{
 public:
  /** \throws UserError if there is no recording, or one of fewer than two scans. */
  RecordingPairSource(std::vector<Recording> recordings,
                      std::vector<Body> bodies,
                      const AugmentationOptions& augmentation,
                      int max_gap,
                      std::uint64_t seed);
  [[nodiscard]] std::string name() const override { return "recordings"; }
  [[nodiscard]] TrainingPair pair(std::uint64_t index) const override;

 private:
  std::vector<Recording> recordings_;
  std::vector<Body> bodies_;
  AugmentationOptions augmentation_;
  int max_gap_;
  std::uint64_t seed_;
};

/** Pairs made from one scan: its points are split into two scans, one of which is moved by a random
 * motion. They add variety of places, not accuracy: both halves show the same rings. */
class SingleScanSource : public PairSource
{
 public:
  /** \throws UserError if there is no scan. */
  SingleScanSource(std::vector<std::vector<Eigen::Vector3f>> scans,
                   std::vector<Body> bodies,
                   const AugmentationOptions& augmentation,
                   std::uint64_t seed);
  [[nodiscard]] std::string name() const override { return "single scans"; }
  [[nodiscard]] TrainingPair pair(std::uint64_t index) const override;

 private:
  std::vector<std::vector<Eigen::Vector3f>> scans_;
  std::vector<Body> bodies_;
  AugmentationOptions augmentation_;
  std::uint64_t seed_;
};
}  // namespace dyslam
