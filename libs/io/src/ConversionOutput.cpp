// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionOutput.h"

#include <filesystem>

namespace dyslam
{
namespace
{
RawlogWriterOptions writerOptions(bool external_storage, int compression_level)
{
  RawlogWriterOptions options;
  options.external_storage = external_storage;
  options.compression_level = compression_level;
  return options;
}
}  // namespace

ConversionOutput::ConversionOutput(const std::string& path,
                                   bool external_storage,
                                   int compression_level)
    : folder_(groundTruthFolder(path)),
      writer_(path, writerOptions(external_storage, compression_level))
{
  // The truth of an earlier file of this name must not be taken for this one's.
  if (std::filesystem::is_directory(folder_))
  {
    truth();
  }
}

GroundTruthWriter& ConversionOutput::truth()
{
  if (!truth_)
  {
    truth_ = std::make_unique<GroundTruthWriter>(folder_);
  }
  return *truth_;
}

void ConversionOutput::write(const Scan& scan, const std::optional<Pose>& T_world_lidar)
{
  std::optional<Pose> T_world_vehicle;
  if (T_world_lidar)
  {
    T_world_vehicle = *T_world_lidar * scan.T_vehicle_lidar.inverse();
  }
  writer_.write(scan, T_world_vehicle);
  ++result_.scans;
  result_.points += scan.size();
  if (T_world_vehicle)
  {
    truth().addPose(scan.stamp, *T_world_vehicle);
    ++result_.poses;
  }
}

void ConversionOutput::addLabels(const std::vector<Label>& labels)
{
  truth().addLabels(lastFrame(), labels);
  ++result_.label_files;
}

void ConversionOutput::addBox(LabelledBox box)
{
  box.frame = static_cast<int>(lastFrame());
  truth().addBox(box);
  ++result_.boxes;
}

ConversionResult ConversionOutput::close()
{
  writer_.close();
  if (truth_)
  {
    truth_->close();
    const bool any = result_.poses + result_.label_files + result_.boxes > 0;
    result_.ground_truth = any ? folder_ : "";
  }
  return result_;
}
}  // namespace dyslam
