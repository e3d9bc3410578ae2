// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/BoxDetections.h>

#include "PointsInBox.h"

namespace dyslam
{
std::vector<Detection> detectionsOf(const std::vector<LabelledBox>& boxes,
                                    const Frame& frame,
                                    const DetectionNoiseOptions& noise)
{
  const Pose& T_vehicle_lidar = frame.scan.T_vehicle_lidar;
  const Eigen::Vector2d sensor = T_vehicle_lidar.translation().head<2>();
  std::vector<Detection> detections;
  for (const LabelledBox& given : boxes)
  {
    Detection detection;
    detection.box = transformedBack(given.box, T_vehicle_lidar.inverse());
    detection.object_class = given.object_class;
    detection.score = given.score;
    detection.covariance = detectionCovariance(detection.box, given.object_class, noise, sensor);
    detection.points = pointsInside(detection.box, frame.cloud.points);
    detection.external = true;
    detections.push_back(std::move(detection));
  }
  return detections;
}
}  // namespace dyslam
