// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/CloudFiles.h>
#include <dyslam/io/Converters.h>
#include <dyslam/io/PcapSource.h>

#include <array>
#include <filesystem>

#include "ConversionOutput.h"
#include "IntensityScaler.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double default_dt = 0.1;  //!< [s]

/** Skips, limits and re-times scans on their way into the rawlog. */
class ScanSink
{
 public:
  ScanSink(const std::string& output, const ScanConverterOptions& options)
      : options_(options), out_(output, options.external_storage, options.compression_level)
  {
  }

  /** False once enough scans were written. */
  bool put(Scan scan, bool has_stamp, const std::optional<Pose>& pose)
  {
    const std::size_t number = seen_++;
    if (number < static_cast<std::size_t>(options_.skip_first_n))
    {
      return true;
    }
    scaler_(scan);
    if (options_.dt > 0 || !has_stamp)
    {
      const double dt = options_.dt > 0 ? options_.dt : default_dt;
      scan.stamp = static_cast<double>(written_) * dt;
    }
    if (scan.sensor_label.empty())
    {
      scan.sensor_label = options_.sensor.empty() ? "lidar" : options_.sensor;
    }
    out_.write(scan, pose);
    ++written_;
    return options_.only_first_n == 0 || written_ < static_cast<std::size_t>(options_.only_first_n);
  }

  [[nodiscard]] std::size_t written() const { return written_; }
  ConversionResult close() { return out_.close(); }

 private:
  const ScanConverterOptions& options_;
  ConversionOutput out_;
  IntensityScaler scaler_;
  std::size_t seen_ = 0;
  std::size_t written_ = 0;
};

std::vector<Pose> readPosesFor(const std::string& path, std::size_t scans)
{
  std::vector<Pose> poses;
  if (path.empty())
  {
    return poses;
  }
  for (const StampedPose& pose : readTrajectory(path).trajectory)
  {
    poses.push_back(pose.pose);
  }
  if (poses.size() < scans)
  {
    throw UserError(path + ": has " + std::to_string(poses.size()) + " poses, but there are " +
                    std::to_string(scans) + " scans");
  }
  return poses;
}

void convertFolder(const std::string& input,
                   ScanSink& sink,
                   const std::vector<std::string>& files,
                   const std::vector<Pose>& poses,
                   const ConversionProgress& progress)
{
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    Scan scan = readCloud(files[i]);
    const bool has_stamp = scan.stamp != 0;
    const bool more = sink.put(std::move(scan), has_stamp,
                               i < poses.size() ? std::optional<Pose>(poses[i]) : std::nullopt);
    if (progress)
    {
      progress(static_cast<double>(i + 1) / static_cast<double>(files.size()), sink.written());
    }
    if (!more)
    {
      break;
    }
  }
  if (sink.written() == 0)
  {
    throw UserError(input + ": --skip-first-n leaves none of the " + std::to_string(files.size()) +
                    " scans");
  }
}

VelodyneModel modelOf(const std::string& sensor)
{
  struct Named
  {
    const char* name;
    VelodyneModel model;
  };
  constexpr std::array<Named, 8> names{{{"", VelodyneModel::automatic},
                                        {"auto", VelodyneModel::automatic},
                                        {"VLP16", VelodyneModel::vlp16},
                                        {"VLP-16", VelodyneModel::vlp16},
                                        {"HDL32E", VelodyneModel::hdl32e},
                                        {"HDL-32E", VelodyneModel::hdl32e},
                                        {"HDL64E", VelodyneModel::hdl64e},
                                        {"HDL-64E", VelodyneModel::hdl64e}}};
  for (const Named& named : names)
  {
    if (sensor == named.name)
    {
      return named.model;
    }
  }
  throw UserError("--sensor " + sensor + ": captures of this lidar cannot be read; use VLP16, " +
                  "HDL32E or HDL64E");
}

std::vector<std::string> convertPcap(const std::string& input,
                                     ScanSink& sink,
                                     const ScanConverterOptions& options,
                                     const ConversionProgress& progress)
{
  if (!options.poses.empty())
  {
    throw UserError("--poses works with folders of scans only");
  }
  PcapSourceOptions source_options;
  source_options.model = modelOf(options.sensor);
  source_options.calibration_file = options.calibration;
  source_options.keep_partial = options.keep_partial;
  PcapSource source(input, source_options);
  while (auto scan = source.next())
  {
    const bool more = sink.put(std::move(*scan), true, std::nullopt);
    if (progress)
    {
      progress(source.progress(), sink.written());
    }
    if (!more)
    {
      break;
    }
  }
  if (sink.written() == 0)
  {
    throw UserError(input + ": holds no whole revolution; try --keep-partial");
  }
  return source.warnings();
}
}  // namespace

void ScanConverterOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("sensor", sensor, "VLP16, HDL32E, HDL64E for a pcap; else the scans' label");
  visitor.text("calibration", calibration, "Velodyne XML or YAML for a pcap");
  visitor.text("poses", poses, "TUM or KITTI poses of the lidar, a line for each scan");
  visitor.real("dt", dt, 0, 3600, "seconds between scans; 0: the scans' own times, else 0.1");
  visitor.flag("keep_partial", keep_partial, "broken first and last revolutions, too");
  visitor.integer("skip_first_n", skip_first_n, 0, 1000000000, "scans to skip");
  visitor.integer("only_first_n", only_first_n, 0, 1000000000, "scans to convert; 0: all");
  visitor.flag("external_storage", external_storage, "clouds in files of their own");
  visitor.integer("compression_level", compression_level, 0, 9, "of gzip");
}

ConversionResult convertScans(const std::string& input,
                              const std::string& output,
                              const ScanConverterOptions& options,
                              const ConversionProgress& progress)
{
  validate(options, "scans2rawlog");
  if (!fs::exists(input))
  {
    throw UserError(input + ": no such file or folder");
  }
  const bool folder = fs::is_directory(input);
  const auto files = folder ? listCloudFiles(input) : std::vector<std::string>{};
  const auto poses = folder ? readPosesFor(options.poses, files.size()) : std::vector<Pose>{};
  if (!folder && isCloudFile(input))
  {
    throw UserError(input + ": is a single scan; give the folder of the scans");
  }
  // Made last: bad input must not touch an earlier output.
  ScanSink sink(output, options);
  std::vector<std::string> warnings;
  if (folder)
  {
    convertFolder(input, sink, files, poses, progress);
  }
  else
  {
    warnings = convertPcap(input, sink, options, progress);
  }
  ConversionResult result = sink.close();
  result.warnings = warnings;
  return result;
}
}  // namespace dyslam
