// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionOutput.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/ExternalFiles.h>
#include <dyslam/io/OptionError.h>

#include <filesystem>
#include <optional>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Makes the folder of a file. */
void makeFolderOf(const std::string& path)
{
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
  {
    makeFolder(folder.string(), "choose another --output for " + nameOfFile(path));
  }
}

RawlogWriterOptions writerOptions(const ConversionOptions& options)
{
  RawlogWriterOptions of_writer;
  of_writer.external_storage = options.external_storage;
  of_writer.compression_level = options.compression_level;
  of_writer.growing = options.growing;
  return of_writer;
}
}  // namespace

std::optional<Pose> truePoseAt(const Trajectory& truth, double stamp)
{
  constexpr double same_pose_time = 1e-6;  // [s]
  if (const auto same = truth.nearest(stamp, same_pose_time))
  {
    return truth[*same].pose;
  }
  return truth.at(stamp, truth_max_gap);
}

std::string emptyRange(const ScanRange& range)
{
  return range.start > 0 || range.end > 0 ? "--skip-first-n, --start and --end leave none"
                                          : "--skip-first-n leaves none";
}

void requireNoInput(const std::string& output, const std::vector<std::string>& inputs)
{
  for (const std::string& input : inputs)
  {
    if (!input.empty() &&
        (isSamePath(input, output) || isWithin(input, groundTruthFolder(output)) ||
         isWithin(input, externalStorageFolder(output))))
    {
      throw UserError(input + ": would be replaced by what is written to " + output +
                      "; choose another --output");
    }
  }
}

ConversionOutput::ConversionOutput(const std::string& path,
                                   const ConversionOptions& options,
                                   const PoseOrigin& origin)
    : path_(path),
      folder_(groundTruthFolder(path)),
      pending_(folder_ + ".tmp"),
      writer_options_(writerOptions(options)),
      origin_(origin)
{
  makeFolderOf(path);
  requireNoLinks(folder_);
  fs::remove_all(pending_);  // of a killed program
  if (!writer_options_.growing)
  {
    (void)writer();
  }
}

ConversionOutput::~ConversionOutput()
{
  try
  {
    (void)keepAfterError();
  }
  catch (const std::exception&)
  {
    // Errors are reported by close().
  }
  std::error_code ignored;
  fs::remove_all(pending_, ignored);
}

RawlogWriter& ConversionOutput::writer()
{
  if (!writer_)
  {
    writer_.emplace(path_, writer_options_);
    if (writer_options_.growing)
    {
      removeGroundTruth(folder_);  // of the recording that was replaced
    }
  }
  return *writer_;
}

/** Ends the output after an error, as said at the class; does nothing if it is closed. \return end
 * of the error's message, empty if no recording is kept. */
std::string ConversionOutput::keepAfterError()
{
  if (closed_)
  {
    return "";
  }
  for (const std::string& earlier : {path_, folder_})
  {
    std::error_code ignored;
    if (result_.scans > 0 && !writer_options_.growing && fs::exists(earlier, ignored))
    {
      abandon();
      return "; the earlier " + earlier + " stays";
    }
  }
  if (result_.scans == 0)
  {
    abandon();
    return "";
  }
  close();
  return "; the scans before it are in " + path_;
}

void ConversionOutput::abandon()
{
  closed_ = true;
  if (writer_)
  {
    writer_->abandon();
  }
}

GroundTruthWriter& ConversionOutput::truth()
{
  if (!truth_)
  {
    truth_ = std::make_unique<GroundTruthWriter>(pending_);
    truth_->setPoseOrigin(origin_);
  }
  return *truth_;
}

void ConversionOutput::reportProgress(const ConversionProgress& progress, double fraction)
{
  if (!progress)
  {
    return;
  }
  try
  {
    progress(fraction, result_.scans);
  }
  catch (...)
  {
    abandon();
    throw;
  }
}

void ConversionOutput::write(const Scan& scan, const std::optional<Pose>& T_world_lidar)
{
  std::optional<Pose> T_world_vehicle;
  if (T_world_lidar)
  {
    T_world_vehicle = *T_world_lidar * scan.T_vehicle_lidar.inverse();
  }
  writer().write(scan, T_world_vehicle);
  if (writer_options_.growing)
  {
    writer_->flush();
  }
  ++result_.scans;
  result_.points += scan.size();
  if (T_world_vehicle)
  {
    truth().addPose(scan.stamp, *T_world_vehicle);
    ++result_.poses;
  }
}

void ConversionOutput::writeFurther(const Scan& scan)
{
  writer().write(scan);
  result_.points += scan.size();
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
  closed_ = true;
  // Both are complete before either gets its name: after an error an earlier recording keeps its
  // truth. The writer is first, as an unfinished one would get its name when it is destroyed.
  writer().finish();
  if (truth_)
  {
    truth_->close();
  }
  removeGroundTruth(folder_);
  writer_->close();
  if (truth_)
  {
    installGroundTruth(pending_, folder_);
    const bool any = result_.poses + result_.label_files + result_.boxes > 0;
    result_.ground_truth = any ? folder_ : "";
  }
  return result_;
}

ConversionResult ConversionOutput::fill(const std::function<ConversionResult()>& work)
{
  try
  {
    return work();
  }
  catch (const OptionError& error)
  {
    throw OptionError(error.what() + keepAfterError(), error.flag());
  }
  catch (const UserError& error)
  {
    throw UserError(error.what() + keepAfterError());
  }
}
}  // namespace dyslam
