// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
enum class PointLabel : std::uint8_t
{
  unknown,
  still,
  moving
};

/** Two scans of one drive with their true relative pose. */
struct TrainingPair
{
  std::vector<Eigen::Vector3f> points1;  //!< the later scan, sensor at the origin [m]
  std::vector<Eigen::Vector3f> points2;  //!< the earlier scan, sensor at the origin [m]
  std::vector<PointLabel> labels1;       //!< one per point of the later scan
  Pose T_2_1 = Pose::Identity();  //!< takes points of the later scan to the earlier scan's frame
};

/** Endless training pairs by number. pair(i) depends on the source and i alone, so that a resumed
 * training continues with exactly the same data. Threads may draw pairs at the same time. */
class PairSource
{
 public:
  virtual ~PairSource() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual TrainingPair pair(std::uint64_t index) const = 0;
};

/** Several sources, drawn by weight. */
class MixedPairSource : public PairSource
{
 public:
  explicit MixedPairSource(std::uint64_t seed) : seed_(seed) {}
  /** \param weight share of pairs; 0 leaves the source out. */
  void add(std::unique_ptr<PairSource> source, double weight);
  [[nodiscard]] bool empty() const { return sources_.empty(); }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] TrainingPair pair(std::uint64_t index) const override;

 private:
  std::uint64_t seed_;
  std::vector<std::unique_ptr<PairSource>> sources_;
  std::vector<double> weights_;
};
}  // namespace dyslam
