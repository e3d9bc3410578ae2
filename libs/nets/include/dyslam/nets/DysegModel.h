// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/nets/RigidFlow.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** What an earlier scan saw at a place, the static world's motion undone. */
enum class SeenBefore : std::uint8_t
{
  unknown,   //!< hidden, or no ray went there
  free,      //!< rays went on through it
  occupied,  //!< a return came from there
};

/** What DySeg found by comparing a scan with an earlier one. */
struct DysegResult
{
  /** One per input point: probability that it moves. 0 for ground, for points outside the grid and
   * for points too high or too low. */
  std::vector<float> moving_probability;
  /** One per input point; unknown where the probability is 0. */
  std::vector<SeenBefore> seen_before;
  /** Current scan to past scan in the plane: the motion of the static world, from the two scans
   * alone. */
  RigidFlowFit static_flow;
  /** Flow per occupied cell at a quarter of the grid's resolution, current to past. */
  std::vector<Eigen::Vector2f> cell_centre;  //!< [m]
  std::vector<Eigen::Vector2f> cell_flow;    //!< [m]
  std::vector<float> cell_moving_probability;
};

/** A trained DySeg network, without torch in sight. Not thread-safe. */
class DysegModel
{
 public:
  /** Reads weights written by save(). \throws UserError if the file is missing, is not one of
   * DySeg's, or fits another shape of network. */
  explicit DysegModel(const std::string& file, int threads = 1);
  /** Untrained, with random weights from a seed: for tests and timing. */
  DysegModel(const DysegNetworkOptions& network,
             const BevOptions& grid,
             std::uint64_t seed,
             int threads = 1);
  ~DysegModel();
  DysegModel(DysegModel&&) noexcept;
  DysegModel& operator=(DysegModel&&) noexcept;

  /** A scan and its encoding: make once, compare with any other. */
  class Encoded;
  /** \param points sensor at the origin, z up [m]; invalid ones allowed. */
  [[nodiscard]] std::shared_ptr<const Encoded> encode(
      const std::vector<Eigen::Vector3f>& points) const;

  /** The motion of the static world, current to past, in the plane. \param guess null if there is
   * none. */
  [[nodiscard]] RigidFlowFit match(const Encoded& current,
                                   const Encoded& past,
                                   const MotionGuess* guess = nullptr) const;

  /** What moves in `current`, seen from `past`, given the static motion between them.
   * \param iterations flow updates, at least 1. */
  [[nodiscard]] DysegResult judge(const Encoded& current,
                                  const Encoded& past,
                                  const RigidFlowFit& static_flow,
                                  int iterations = 2) const;

  /** How surely each input point lies on something that stays where it is, judged by its looks in
   * this scan alone: walls and trees rather than vehicles. 1 for points that are not looked at. */
  [[nodiscard]] std::vector<float> anchors(const Encoded& scan) const;

  /** match() and judge(). */
  [[nodiscard]] DysegResult compare(const Encoded& current,
                                    const Encoded& past,
                                    int iterations = 2) const;

  [[nodiscard]] const BevOptions& grid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
