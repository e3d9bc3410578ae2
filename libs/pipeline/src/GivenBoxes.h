// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Objects.h>
#include <dyslam/pipeline/GivenBoxesOptions.h>
#include <dyslam/tracking/DetectionNoise.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace dyslam
{
/** Boxes that another program detected in the scans, used instead of Detector. */
class GivenBoxes
{
 public:
  /** Reads a file as readTracks() does, with a calibration as readDetections() does, or a folder of
   * NNNNNN.txt in KITTI's object layout. Classes as classFromDetector(). Boxes without extent or of
   * things that cannot move are left out. \throws UserError for files that cannot be read, and if
   * there are no boxes. */
  GivenBoxes(const GivenBoxesOptions& options, const DetectionNoiseOptions& noise);

  /** Which boxes are left out because such things cannot move, and whether the boxes seem to be in
   * the frame of a camera, although no calibration was given. */
  [[nodiscard]] std::vector<std::string> warnings() const;

  /** Sets the detections of a frame to the boxes of its index. Reads cloud and T_vehicle_lidar. */
  void detect(Frame& frame) const;

  /** Marks the cloud points in the boxes of confirmed dynamic objects as moving. For runs without
   * labels with hindsight, which have the tracks as evidence. */
  static void markMoving(Frame& frame);

 private:
  std::map<std::size_t, std::vector<LabelledBox>> boxes_;  //!< by Frame::index, lidar frame
  std::size_t immobile_ = 0;              //!< number of boxes of things that cannot move
  std::set<std::string> immobile_names_;  //!< their classes, as in the file
  bool is_camera_frame_likely_ = false;   //!< but no calibration was given
  DetectionNoiseOptions noise_;
};
}  // namespace dyslam
