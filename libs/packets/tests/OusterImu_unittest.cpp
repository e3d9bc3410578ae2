// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/OusterImu.h>
#include <dyslam/packets/OusterScans.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ReceivedPacket.h"
#include "SyntheticOuster.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::uint64_t sample_time = 100050000000;  // 0.05 s after the first column [ns]

/** A decoder that has the packets of two frames, the first of which begins at 1000 s. */
std::unique_ptr<OusterScans> decoderOf(const SyntheticOuster& lidar)
{
  auto decoder =
      std::make_unique<OusterScans>("x", parseOusterMetadata(lidar.metadata(), "x.json"), false);
  for (const std::string& packet : lidar.packetsOf(2))
  {
    decoder->add(received(packet, 1000));
  }
  return decoder;
}

/** The samples of a packet; none if it is not taken. */
std::vector<ImuSample> samplesOf(OusterScans& decoder, const std::string& packet)
{
  if (decoder.takesImu(received(packet)))
  {
    decoder.addImu(received(packet));
  }
  return decoder.takeImu();
}

std::string withFloat(std::string packet, std::size_t at, float value)
{
  std::string bytes;
  appendBytes(bytes, value);
  return packet.replace(at, bytes.size(), bytes);
}
}  // namespace

TEST(OusterImu, UnitsStampAndPoseOfALegacyPacket)
{
  for (const char* profile : {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "FUSA_RNG15_RFL8_NIR8_DUAL"})
  {
    SyntheticOuster lidar;
    lidar.profile = profile;
    const auto decoder = decoderOf(lidar);
    const std::string packet = SyntheticOuster::imuPacket(sample_time);
    EXPECT_FALSE(decoder->takes(received(packet))) << profile;
    const auto samples = samplesOf(*decoder, packet);
    ASSERT_EQ(1U, samples.size()) << profile;
    const ImuSample& sample = samples.front();
    EXPECT_NEAR(1000.05, sample.stamp, 1e-6);
    EXPECT_TRUE(sample.angular_velocity.isApprox(Eigen::Vector3d(M_PI_2, -M_PI_4, M_PI), 1e-6));
    ASSERT_TRUE(sample.acceleration);
    EXPECT_TRUE(sample.acceleration->isApprox(9.80665 * Eigen::Vector3d(0.5, -0.25, 1), 1e-6));
    EXPECT_TRUE(
        sample.T_vehicle_imu.translation().isApprox(Eigen::Vector3d(0.006, -0.012, 0.008), 1e-9));
    EXPECT_TRUE((sample.T_vehicle_imu.linear() * Eigen::Vector3d::UnitX())
                    .isApprox(Eigen::Vector3d::UnitY(), 1e-9));
    EXPECT_TRUE(decoder->takeImu().empty());
    EXPECT_TRUE(decoder->warnings().empty());
  }
}

TEST(OusterImu, SamplesOfANewPacket)
{
  for (const char* profile : {"RNG19_RFL8_SIG16_NIR16", "FUSA_RNG15_RFL8_NIR8_DUAL"})
  {
    SyntheticOuster lidar;
    lidar.profile = profile;
    const auto decoder = decoderOf(lidar);
    const auto samples = samplesOf(*decoder, lidar.newImuPacket(sample_time));
    ASSERT_EQ(7U, samples.size()) << "without the invalid one, " << profile;
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
      EXPECT_NEAR(1000.05 + 0.001 * static_cast<double>(i), samples[i].stamp, 1e-6);
      EXPECT_TRUE(samples[i].angular_velocity.isApprox(Eigen::Vector3d(0.5, -0.25, 0.125), 1e-9));
      ASSERT_TRUE(samples[i].acceleration);
      EXPECT_TRUE(samples[i].acceleration->isApprox(Eigen::Vector3d(1, -2, 9.75), 1e-9));
    }
    SyntheticOuster other = lidar;
    other.sensor = 42;
    EXPECT_TRUE(samplesOf(*decoder, other.newImuPacket(sample_time)).empty());
  }
}

TEST(OusterImu, OddPacketsGiveNoSample)
{
  const SyntheticOuster lidar;
  const auto decoder = decoderOf(lidar);
  const std::string legacy = SyntheticOuster::imuPacket(sample_time);
  const std::string recent = lidar.newImuPacket(sample_time);
  EXPECT_EQ(1U, samplesOf(*decoder, legacy + '\0').size()) << "as early drivers recorded them";
  for (const std::string& packet :
       {std::string(), legacy.substr(0, 47), recent.substr(0, recent.size() - 1),
        recent.substr(0, 20), '\1' + recent.substr(1), lidar.packet(0, 0)})
  {
    EXPECT_FALSE(decoder->takesImu(received(packet))) << packet.size();
  }
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(samplesOf(*decoder, withFloat(legacy, 36, nan)).empty());
  const auto without = samplesOf(*decoder, withFloat(legacy, 24, nan));
  ASSERT_EQ(1U, without.size());
  EXPECT_FALSE(without.front().acceleration);
  EXPECT_TRUE(decoder->warnings().empty());
  EXPECT_TRUE(samplesOf(*decoder, SyntheticOuster::imuPacket(7)).empty());
  ASSERT_EQ(1U, decoder->warnings().size());
  EXPECT_TRUE(contains(decoder->warnings()[0], "x: 1 sample of the IMU left out"));
}

TEST(OusterImu, WithoutAPacketOfTheLidarThereIsNoTime)
{
  const SyntheticOuster lidar;
  OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), false);
  EXPECT_TRUE(samplesOf(decoder, SyntheticOuster::imuPacket(sample_time)).empty());
  EXPECT_TRUE(decoder.warnings().empty());
}

TEST(PcapSource, TheImuInAnOuster)
{
  const SyntheticOuster lidar;
  std::vector<std::string> packets;
  std::vector<std::string> twice;  // as captured on two interfaces
  for (const std::string& packet : lidar.packetsOf(3))
  {
    const auto n = packets.size() / 2;
    packets.push_back(packet);
    packets.push_back(SyntheticOuster::imuPacket(sample_time + 25000000 * n));
    twice.insert(twice.end(), {packets[2 * n], packets[2 * n], packets.back(), packets.back()});
  }
  const TestFolder folder;
  folder.write("a.json", lidar.metadata());
  const std::string capture = folder.write("a.pcap", SyntheticOuster::capture(packets));
  PcapSourceOptions options;
  options.imu = true;
  PcapSource source(capture, options);
  EXPECT_TRUE(source.readsImu());
  std::size_t samples = 0;
  while (const auto scan = source.next())
  {
    for (const ImuSample& sample : source.takeImu())
    {
      EXPECT_NEAR(1000.05 + 0.025 * static_cast<double>(samples), sample.stamp, 1e-6);
      ++samples;
    }
  }
  EXPECT_EQ(packets.size() / 2, samples + source.takeImu().size());
  EXPECT_EQ(packets.size() / 2, source.imuPackets());
  EXPECT_TRUE(source.warnings().empty());
  PcapSource unasked(capture);
  while (unasked.next())
  {
  }
  EXPECT_EQ(packets.size() / 2, unasked.imuPackets());
  EXPECT_TRUE(unasked.takeImu().empty());
  PcapSource of_two(folder.write("twice.pcap", SyntheticOuster::capture(twice)), options);
  samples = 0;
  while (of_two.next())
  {
    samples += of_two.takeImu().size();
  }
  EXPECT_EQ(packets.size() / 2, samples + of_two.takeImu().size());
  PcapSource other(folder.write("b.pcap", captured(300)));
  EXPECT_FALSE(other.readsImu());
  EXPECT_TRUE(other.takeImu().empty());
}
}  // namespace dyslam
