// SPDX-License-Identifier: BSD-3-Clause
#include "BagReader.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RosPackets.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "conversion/ConversionOutput.h"

namespace dyslam
{
namespace
{
PacketOptions optionsOfFirst(const ScanConverterOptions& options)
{
  PacketOptions of_first;
  of_first.sensor = options.sensor;
  of_first.calibration = options.calibration;
  of_first.keep_partial = options.keep_partial;
  return of_first;
}

/** Options for the packets of a further lidar; clouds are never partial. */
PacketOptions optionsOfFurther(const BagTopic& topic, const std::string& calibration, bool partial)
{
  PacketOptions of_further;
  of_further.calibration = calibration;
  of_further.calibration_flag = "--further-topic " + topic.name + "=FILE";
  of_further.keep_partial = partial && packetMakerOf(topic);
  return of_further;
}

void scaleBy(double scale, Scan& scan)
{
  if (scale != 1)
  {
    for (Eigen::Vector3f& point : scan.points)
    {
      point = (scale * point.cast<double>()).cast<float>();
    }
  }
}
}  // namespace

BagReader::BagReader(const BagContent& content, const ScanConverterOptions& options, ScanSink& sink)
    : content_(content),
      bag_(content.bag),
      reader_(makeBagScans(content.input, bag_, content.scans, optionsOfFirst(options))),
      sink_(sink),
      motion_(content.input, bag_, *reader_, content.frames, options, sink),
      held_(sink, motion_, options.growing),
      scale_(options.scale)
{
  std::vector<std::size_t> topics = motion_.topicsWith(content.scans);
  for (const FurtherTopic& lidar : content.further)
  {
    const PacketOptions of_further =
        optionsOfFurther(bag_.topics()[lidar.topic], lidar.calibration, options.keep_partial);
    FurtherReader reader;
    reader.topic = lidar;
    reader.number = further_.size() + 1;
    reader.reader = makeBagScans(content.input, bag_, lidar.topic, of_further);
    further_.push_back(std::move(reader));
    topics.push_back(lidar.topic);
  }
  bag_.selectLast(topics);
}

void BagReader::read()
{
  while (takeNext() && held_.passOn(message_.recorded))
  {
  }
  finish();
}

void BagReader::report(const std::string& truth_topic)
{
  motion_.report();
  if (!content_.truth.empty() && held_.withoutPose() > 0)
  {
    std::ostringstream text;
    text << truth_topic << ": has no pose within " << truth_max_gap << " s of "
         << counted(held_.withoutPose(), "scan");
    sink_.warn(text.str());
  }
  if (held_.sorted() > 0)
  {
    sink_.note(counted(held_.sorted(), "scan") +
               " out of order in the bag; sorted by their stamps");
  }
  report(*reader_, clouds_, "");
  for (const FurtherReader& lidar : further_)
  {
    report(*lidar.reader, lidar.clouds, bag_.topics()[lidar.topic.topic].name + ": ");
    if (lidar.scans == 0)
    {
      sink_.warn(bag_.topics()[lidar.topic.topic].name + ": no scan of this further lidar");
    }
  }
  reportClocks();
}

void BagReader::report(const BagScans& reader, const CloudCheck& clouds, const std::string& prefix)
{
  for (const std::string& note : reader.notes())
  {
    sink_.note(prefix + note);
  }
  for (const std::string& warning : reader.warnings())
  {
    const bool has_name = warning.rfind(prefix, 0) == 0;
    sink_.warn(has_name ? warning : prefix + warning);
  }
  for (const std::string& warning : clouds.warnings(scale_))
  {
    sink_.warn(prefix + warning);
  }
}

void BagReader::reportClocks()
{
  constexpr double largest = 0.5;  // [s]; drivers take less
  for (std::size_t i = 0; i < bag_.topics().size(); ++i)
  {
    const double offset = clocks_.offset(i, content_.scans).value_or(0);
    if (std::abs(offset) > largest)
    {
      sink_.warn(
          formatted("%s: its stamps are about %.2g s %s than those of %s, compared by the times of "
                    "recording; synchronise the clocks when recording",
                    bag_.topics()[i].name.c_str(), std::abs(offset),
                    offset > 0 ? "later" : "earlier", bag_.topics()[content_.scans].name.c_str()));
    }
  }
}

/** Passes on what was held back. */
void BagReader::finish()
{
  hold(reader_->finish());
  for (FurtherReader& lidar : further_)
  {
    hold(lidar, lidar.reader->finish());
  }
  held_.passOnAll();
}

/** \return false at the end of the bag. */
bool BagReader::takeNext()
{
  try
  {
    if (!bag_.next(message_))
    {
      return false;
    }
    takeMessage();
    return true;
  }
  catch (const UserError&)
  {
    finish();
    throw;
  }
}

void BagReader::takeMessage()
{
  const BagTopic& topic = bag_.topics()[message_.topic];
  if (!packetMakerOf(topic))  // those of an Ouster have no header
  {
    if (const auto stamp = headerStampOf(topic, message_))
    {
      clocks_.add(message_.topic, *stamp, message_.recorded);
    }
  }
  const auto lidar =
      std::find_if(further_.begin(), further_.end(),
                   [&](const FurtherReader& other) { return other.topic.topic == message_.topic; });
  if (lidar != further_.end())
  {
    hold(*lidar, lidar->reader->add(message_));
  }
  else if (message_.topic == content_.scans)
  {
    hold(reader_->add(message_));
  }
  else
  {
    motion_.add(message_);
  }
}

void BagReader::hold(FurtherReader& lidar, std::vector<Scan> scans)
{
  for (Scan& scan : scans)
  {
    scaleBy(scale_, scan);
    lidar.clouds.add(scan);
    HeldScans::Entry entry;
    entry.scan = std::move(scan);
    entry.scan.sensor_label = lidar.topic.label;
    entry.scan.T_vehicle_lidar = lidar.topic.T_vehicle_lidar;
    entry.lidar = lidar.number;
    entry.recorded = message_.recorded;
    held_.hold(std::move(entry));
    ++lidar.scans;
  }
}

void BagReader::hold(std::vector<Scan> scans)
{
  for (Scan& scan : scans)
  {
    requireOtherLabel(scan);
    scaleBy(scale_, scan);
    clouds_.add(scan);
    HeldScans::Entry entry;
    entry.scan = std::move(scan);
    if (const auto T_world_vehicle = truePoseAt(content_.truth, entry.scan.stamp))
    {
      entry.T_world_lidar = *T_world_vehicle * sink_.T_vehicle_lidar();
    }
    entry.recorded = message_.recorded;
    entry.progress = bag_.progress();
    held_.hold(std::move(entry));
  }
}

/** \throws UserError if the scans' own label is that of a further lidar. */
void BagReader::requireOtherLabel(const Scan& scan) const
{
  for (const FurtherReader& lidar : further_)
  {
    if (lidar.topic.label == scan.sensor_label)
    {
      throw UserError(bag_.topics()[lidar.topic.topic].name + ": its label in the rawlog, " +
                      lidar.topic.label + ", is that of the first lidar; convert one lidar");
    }
  }
}
}  // namespace dyslam
