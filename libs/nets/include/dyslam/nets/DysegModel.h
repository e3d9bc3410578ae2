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
/** What an earlier scan observed at a point's position, after ego-motion compensation. */
enum class PastVisibility : std::uint8_t
{
  unknown,   //!< occluded or not observed
  free,      //!< observed free: rays passed through
  occupied,  //!< a return within the range tolerance
};

/** Segmentation of a scan by comparison with an earlier one. */
struct DysegResult
{
  /** Moving probability of each input point. 0 for ground, for points outside the grid and for
   * points that are too high or too low. */
  std::vector<float> moving_probability;
  /** Visibility of each input point in the past scan; unknown where the probability is 0. */
  std::vector<PastVisibility> past_visibility;
  /** Planar ego-motion (static flow), current to past scan, from the two scans alone. */
  RigidFlowFit static_flow;
  /** Occupied cells at 1/4 of the grid's resolution: centres, scene flow from current to past, and
   * moving probability. */
  std::vector<Eigen::Vector2f> cell_centre;  //!< [m]
  std::vector<Eigen::Vector2f> cell_flow;    //!< [m]
  std::vector<float> cell_moving_probability;
};

/** A trained DySeg network; free of torch headers. Its const functions may run in several threads
 * at a time. */
class DysegModel
{
 public:
  /** Loads weights written by saveDyseg(). \param threads of the CPU; 0: one per core \param device
   * cpu or cuda \throws UserError if the file is missing, damaged or not a DySeg network, or
   * without CUDA. */
  explicit DysegModel(const std::string& file, int threads = 1, const std::string& device = "cpu");
  /** Untrained network with random weights from a seed, for tests and timing. */
  DysegModel(const DysegNetworkOptions& network,
             const BevOptions& grid,
             std::uint64_t seed,
             int threads = 1);
  ~DysegModel();
  DysegModel(DysegModel&&) noexcept;
  DysegModel& operator=(DysegModel&&) noexcept;

  /** A scan and its encoding, computed once and compared with any other. */
  class Encoded;
  /** \param points sensor frame, z up [m]; invalid ones are ignored. */
  [[nodiscard]] std::shared_ptr<const Encoded> encode(
      const std::vector<Eigen::Vector3f>& points) const;

  /** Planar ego-motion (static flow), current to past. \param guess null for a search over all
   * motions in the correlation window. */
  [[nodiscard]] RigidFlowFit match(const Encoded& current,
                                   const Encoded& past,
                                   const PlanarPrior* guess = nullptr) const;

  /** Moving points of `current` by comparison with `past`, given the ego-motion between them.
   * \param iterations flow updates, at least 1. */
  [[nodiscard]] DysegResult segment(const Encoded& current,
                                    const Encoded& past,
                                    const RigidFlowFit& static_flow,
                                    int iterations = 2) const;

  /** Appearance prior: probability that each input point belongs to a static class (walls, trees)
   * rather than to vehicles, from this scan alone. 1 for points outside the network's input. */
  [[nodiscard]] std::vector<float> appearancePrior(const Encoded& scan) const;

  /** match() and segment(). */
  [[nodiscard]] DysegResult compare(const Encoded& current,
                                    const Encoded& past,
                                    int iterations = 2) const;

  [[nodiscard]] const BevOptions& grid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
