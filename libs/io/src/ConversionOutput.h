// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/GroundTruth.h>
#include <dyslam/io/Converters.h>
#include <dyslam/io/RawlogWriter.h>

#include <memory>
#include <optional>
#include <string>

namespace dyslam
{
/** A rawlog and, once there is truth for it, its sidecar; counts what it writes. */
class ConversionOutput
{
 public:
  ConversionOutput(const std::string& path, bool external_storage, int compression_level);

  void write(const Scan& scan, const std::optional<Pose>& T_world_lidar);
  /** For the scan written last. */
  void addLabels(const std::vector<Label>& labels);
  void addBox(LabelledBox box);
  ConversionResult close();

  /** Number of the scan written last. */
  [[nodiscard]] std::size_t lastFrame() const { return result_.scans - 1; }

 private:
  GroundTruthWriter& truth();

  std::string folder_;
  RawlogWriter writer_;
  std::unique_ptr<GroundTruthWriter> truth_;
  ConversionResult result_;
};
}  // namespace dyslam
