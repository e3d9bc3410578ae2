// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/io/Levelling.h>

#include <memory>
#include <string>

namespace dyslam
{
struct LiveTopicsOptions
{
  std::string vehicle_frame = "base_link";  //!< name of the vehicle frame of the recording
  bool transforms = true;                   //!< also `/tf`
};

/** Publishes what a run knows after each scan, by ROS 2: `/tf` from `map` to the vehicle, and
 * `/dyslam/odometry`, `/dyslam/points_static` and `/dyslam/objects`, as "Publish to ROS 2" in
 * doc/live.md has them. The types are those of exportBag(). One thread at a time. */
class LiveTopics
{
 public:
  /** Joins the domain that the environment states (Ros2DomainOptions).
   * \throws UserError if that is not possible. */
  explicit LiveTopics(const LiveTopicsOptions& options);
  ~LiveTopics();
  LiveTopics(const LiveTopics&) = delete;
  LiveTopics& operator=(const LiveTopics&) = delete;

  /** Replaces LiveTopicsOptions::vehicle_frame, before the first frame. */
  void setVehicleFrame(const std::string& name);
  /** The levelling of the frames that follow: what is published is of the recording's vehicle. */
  void setLevelling(const Levelling& levelling);
  /** \param frame of the causal pipeline, after its last stage \throws UserError for a stamp that
   * no message holds. */
  void publish(const Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
