// SPDX-License-Identifier: BSD-3-Clause
#include "BagScans.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/OusterScans.h>
#include <dyslam/packets/VelodyneModels.h>
#include <dyslam/packets/VelodyneScans.h>

#include <optional>
#include <utility>

#include "recording/LateStamps.h"

namespace dyslam
{
namespace
{
class BagClouds : public BagScans
{
 public:
  BagClouds(const BagTopic& topic, bool begins_at_zero) : topic_(topic), decoder_(begins_at_zero) {}

  [[nodiscard]] std::vector<Scan> add(const BagMessage& message) override
  {
    std::vector<Scan> scans;
    Scan scan = decoder_.decode(topic_, message);
    if (!scan.points.empty() || scan.stamp != 0)  // some drivers begin with blank messages
    {
      late_stamps_(scan);
      scans.push_back(std::move(scan));
    }
    return scans;
  }
  [[nodiscard]] std::vector<std::string> notes() const override
  {
    std::vector<std::string> lines = decoder_.notes();
    const std::vector<std::string> of_stamps = late_stamps_.notes();
    lines.insert(lines.end(), of_stamps.begin(), of_stamps.end());
    return lines;
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return decoder_.warnings(); }

 private:
  const BagTopic& topic_;
  RosScanDecoder decoder_;
  LateStamps late_stamps_;
};

class BagPackets : public BagScans
{
 public:
  BagPackets(const BagTopic& topic, std::unique_ptr<PacketScans> scans, std::string note)
      : topic_(topic), scans_(std::move(scans)), note_(std::move(note))
  {
  }

  [[nodiscard]] std::vector<Scan> add(const BagMessage& message) override
  {
    for (const RosPacket& received : decodeRosPackets(topic_, message))
    {
      packet_.bytes.assign(received.bytes.begin(), received.bytes.end());
      packet_.captured = received.received;
      if (scans_->takes(packet_))
      {
        scans_->add(packet_);
      }
      else
      {
        ++left_out_;
        not_decoded_ = not_decoded_ ? not_decoded_ : whyNoHesaiScans(packet_);
      }
    }
    return complete();
  }

  [[nodiscard]] std::vector<ImuSample> addImu(const BagTopic& topic,
                                              const BagMessage& message) override
  {
    for (const RosPacket& received : decodeRosPackets(topic, message))
    {
      packet_.bytes.assign(received.bytes.begin(), received.bytes.end());
      if (scans_->takesImu(packet_))
      {
        scans_->addImu(packet_);
      }
    }
    return scans_->takeImu();
  }

  [[nodiscard]] std::vector<Scan> finish() override
  {
    scans_->finish();
    return complete();
  }

  [[nodiscard]] std::vector<std::string> notes() const override
  {
    std::vector<std::string> lines{"packets of a " + scans_->sensor()};
    if (!note_.empty())
    {
      lines.push_back(note_);
    }
    return lines;
  }

  [[nodiscard]] std::vector<std::string> warnings() const override
  {
    auto lines = scans_->warnings();
    if (left_out_ > 0)
    {
      lines.push_back(topic_.name + ": left out " + counted(left_out_, "packet") + " " +
                      not_decoded_.value_or("not of a " + scans_->sensor()));
    }
    return lines;
  }

 private:
  [[nodiscard]] std::vector<Scan> complete()
  {
    std::vector<Scan> scans;
    while (auto scan = scans_->take())
    {
      scans.push_back(std::move(*scan));
    }
    return scans;
  }

  const BagTopic& topic_;
  std::unique_ptr<PacketScans> scans_;
  std::string note_;
  LidarPacket packet_;
  std::size_t left_out_ = 0;
  std::optional<std::string> not_decoded_;  //!< what to say of packets that are known only
};

std::unique_ptr<BagScans> velodynePackets(const std::string& place,
                                          const BagTopic& topic,
                                          const PacketOptions& options)
{
  VelodyneScansOptions of_velodyne;
  of_velodyne.model = givenVelodyneModel(options.sensor);
  of_velodyne.calibration_file = options.calibration;
  of_velodyne.calibration_flag = options.calibration_flag;
  of_velodyne.keep_partial = options.keep_partial;
  return std::make_unique<BagPackets>(topic, std::make_unique<VelodyneScans>(place, of_velodyne),
                                      "");
}

std::unique_ptr<BagScans> hesaiPackets(const std::string& place,
                                       const BagTopic& topic,
                                       const PacketOptions& options)
{
  HesaiScansOptions of_hesai;
  of_hesai.angle_file = options.calibration;
  of_hesai.calibration_flag = options.calibration_flag;
  of_hesai.keep_partial = options.keep_partial;
  return std::make_unique<BagPackets>(topic, std::make_unique<HesaiScans>(place, of_hesai), "");
}

std::unique_ptr<BagScans> ousterPackets(const std::string& place,
                                        Bag& bag,
                                        const BagTopic& topic,
                                        const PacketOptions& options)
{
  RosMetadata metadata;
  if (!options.calibration.empty())
  {
    metadata = {options.calibration, readWhole(options.calibration)};
  }
  else if (auto published = ousterMetadataIn(bag, topic.name))
  {
    metadata = *published;
  }
  else
  {
    throw UserError(place + ": the bag has no metadata of this Ouster lidar; name its .json with " +
                    options.calibration_flag);
  }
  const OusterMetadata parsed = parseOusterMetadata(metadata.text, metadata.topic);
  return std::make_unique<BagPackets>(
      topic, std::make_unique<OusterScans>(place, parsed, options.keep_partial),
      "metadata of the lidar: " + metadata.topic);
}
}  // namespace

std::unique_ptr<BagScans> makeBagScans(const std::string& input,
                                       Bag& bag,
                                       std::size_t topic_at,
                                       const PacketOptions& options)
{
  const BagTopic& topic = bag.topics()[topic_at];
  const std::string place = input + ": " + topic.name;
  const auto maker = packetMakerOf(topic);
  if (!maker)
  {
    if (!options.calibration.empty() || options.keep_partial)
    {
      throw UserError(place + ": " +
                      (options.keep_partial ? "--keep-partial" : options.calibration_flag) +
                      " works with packets only, and these are clouds");
    }
    return std::make_unique<BagClouds>(topic, clockBeginsAtZero(bag, topic_at));
  }
  switch (*maker)
  {
    case PacketMaker::velodyne:
      return velodynePackets(place, topic, options);
    case PacketMaker::hesai:
      return hesaiPackets(place, topic, options);
    default:
      return ousterPackets(place, bag, topic, options);
  }
}
}  // namespace dyslam
