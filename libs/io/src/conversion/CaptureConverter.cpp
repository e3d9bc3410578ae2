// SPDX-License-Identifier: BSD-3-Clause
#include "CaptureConverter.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/OptionError.h>
#include <dyslam/packets/PcapSource.h>
#include <dyslam/packets/VelodyneModels.h>

#include <optional>
#include <utility>

namespace dyslam
{
namespace
{
/** Passes the IMU in the lidar to the sink, if the options ask for it. */
class CaptureImu
{
 public:
  /** \throws UserError if the options ask for an IMU whose packets are not read. */
  CaptureImu(PacketSource& source, const ScanConverterOptions& options, ScanSink& sink)
      : source_(source), is_wanted_(options.imu), sink_(sink)
  {
    if (is_wanted_ && !source.readsImu())
    {
      throw UserError(source.name() + ": --imu reads the IMU of an Ouster, and this is a " +
                      source.sensor() + "; leave it out");
    }
  }

  /** Passes on the samples up to the latest scan, before that. */
  void passOn()
  {
    for (ImuSample& sample : source_.takeImu())
    {
      sample.T_vehicle_imu = sink_.T_vehicle_lidar() * sample.T_vehicle_imu;
      sink_.add(sample);
    }
  }

  void report() const
  {
    const MotionSampleWriter::Written& written = sink_.motion().imu();
    if (!is_wanted_ && source_.imuPackets() > 0)
    {
      sink_.note("--imu adds the gyroscope of the " + source_.sensor());
    }
    if (written.samples > 0)
    {
      sink_.note("IMU: that of the " + source_.sensor() + ", " +
                 counted(written.samples, "sample") + "; mounted as its metadata state");
    }
    if (is_wanted_ && written.scans == 0)
    {
      sink_.warn(source_.name() + ": --imu: has no sample of the IMU at the times of the scans" +
                 (source_.imuPackets() == 0 ? whyNoPackets() : ""));
    }
  }

 private:
  [[nodiscard]] std::string whyNoPackets() const
  {
    return isNetworkInput(source_.name())
               ? ": its packets were not received; name the ports of both: udp:7502,7503"
               : ": its packets (UDP port 7503) were not captured";
  }

  PacketSource& source_;
  bool is_wanted_;
  ScanSink& sink_;
};
}  // namespace

PacketSourceOptions packetSourceOptions(const ScanConverterOptions& options)
{
  PacketSourceOptions source_options;
  source_options.model = givenVelodyneModel(options.sensor);
  source_options.calibration_file = options.calibration;
  source_options.keep_partial = options.keep_partial;
  source_options.imu = options.imu;
  return source_options;
}

void convertCapture(const std::string& input, ScanSink& sink, const ScanConverterOptions& options)
{
  PcapSource source(input, packetSourceOptions(options));
  convertPackets(source, sink, options);
}

void convertPackets(PacketSource& source, ScanSink& sink, const ScanConverterOptions& options)
{
  for (const std::string& note : source.notes())
  {
    sink.note(note);
  }
  CaptureImu imu(source, options, sink);
  while (auto scan = source.next())
  {
    imu.passOn();
    if (!sink.put(std::move(*scan), true, std::nullopt, source.progress()))
    {
      break;
    }
  }
  if (sink.written() == 0)
  {
    if (sink.seen() == 0)
    {
      throw OptionError(source.name() + ": holds no whole revolution; try --keep-partial",
                        "--keep-partial");
    }
    throw UserError(source.name() + ": " + emptyRange(options));
  }
  imu.report();
  for (const std::string& warning : source.warnings())
  {
    sink.warn(warning);
  }
}
}  // namespace dyslam
