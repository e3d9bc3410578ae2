// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <functional>
#include <random>

namespace dyslam
{
namespace
{
/** A street with a car that drives ahead, from a sensor that drives 0.5 m per scan. */
Frame streetScan(std::size_t index)
{
  constexpr float height = 1.8F;
  std::mt19937 random(static_cast<unsigned>(index));
  std::normal_distribution<float> noise(0, 0.01F);
  const float driven = 0.5F * static_cast<float>(index);
  Frame frame;
  frame.index = index;
  frame.scan.stamp = 0.1 * static_cast<double>(index);
  frame.scan.T_vehicle_lidar.translation().z() = static_cast<double>(height);
  const auto put = [&](float x, float y, float z)
  {
    frame.scan.points.emplace_back(x - driven + noise(random), y + noise(random),
                                   z - height + noise(random));
  };
  for (float x = driven - 25; x < driven + 25; x += 0.2F)
  {
    for (float y = -7.5F; y < 7.6F; y += 0.3F)
    {
      put(x, y, 0);
    }
    for (float z = 0.2F; z < 4; z += 0.2F)
    {
      put(x, 8, z);
      put(x, -8, z);
    }
  }
  for (float x = -20; x < 60; x += 9)  // posts: the walls do not show the motion along them
  {
    for (float z = 0.2F; z < 4; z += 0.1F)
    {
      put(x, 7, z);
      put(x, -7, z);
      put(x + 0.1F, 7.2F, z);
      put(x + 0.1F, -7.2F, z);
    }
  }
  const float car = 8 + 2.2F * driven;
  for (float z = 0.2F; z < 1.5F; z += 0.05F)
  {
    for (float w = 0; w < 1.8F; w += 0.05F)
    {
      put(car, 2.5F + w, z);
      put(car + 2 * w, 2.5F, z);
    }
  }
  return frame;
}

/** A front end with DySeg, and what it makes of a street with a missing scan. */
class FrontEndWithNetwork : public testing::Test
{
 protected:
  static constexpr std::size_t missing = 13;

  static void SetUpTestSuite()
  {
    for (std::size_t i = 0; i < 17; ++i)
    {
      if (i != missing)
      {
        scans.push_back(streetScan(i));
      }
    }
  }
  static void TearDownTestSuite() { scans.clear(); }

  static std::unique_ptr<FrontEnd> make(int threads)
  {
    const Config config = Config::fromText(
        "[dyseg]\nmethod = network\n[dyseg_network]\nencode_ahead = true\n[preprocess]\ndeskew = "
        "azimuth\n",
        "test");
    ConfigLoader loader(config);
    static mrpt::system::CTimeLogger times(false);
    return std::make_unique<FrontEnd>(threads, loader, times);
  }
  static std::vector<Frame> run(FrontEnd& front_end, bool with_next, std::size_t first = 0)
  {
    std::vector<Frame> done;
    for (std::size_t i = first; i < scans.size(); ++i)
    {
      done.push_back(scans[i]);
      front_end.process(done.back(), with_next && i + 1 < scans.size() ? &scans[i + 1] : nullptr);
    }
    return done;
  }
  static void expectSame(const std::vector<Frame>& a, const std::vector<Frame>& b)
  {
    ASSERT_LE(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
    {
      const Frame& x = a[a.size() - 1 - i];
      const Frame& y = b[b.size() - 1 - i];
      ASSERT_EQ(x.index, y.index);
      EXPECT_EQ(x.T_odom_vehicle.matrix(), y.T_odom_vehicle.matrix()) << x.index;
      EXPECT_EQ(x.cloud.points, y.cloud.points) << x.index;
      EXPECT_EQ(x.moving_probability, y.moving_probability) << x.index;
    }
  }

  static std::vector<Frame> scans;
};
std::vector<Frame> FrontEndWithNetwork::scans;

TEST_F(FrontEndWithNetwork, GivesTheSameWithAndWithoutTheNextScan)
{
  const auto alone = make(1);
  const auto ahead = make(2);
  const std::vector<Frame> expected = run(*alone, false);
  expectSame(run(*ahead, true), expected);
  const Frame& last = expected.back();
  EXPECT_GT(std::count(last.moving.begin(), last.moving.end(), true), 500) << "the car";
  EXPECT_NEAR(last.T_odom_vehicle.translation().x(), 8, 0.2);
}

TEST_F(FrontEndWithNetwork, GoesOnFromItsState)
{
  constexpr std::size_t saved_after = 12;
  const auto whole = make(2);
  std::vector<Frame> expected;
  StateArchive archive;
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    expected.push_back(scans[i]);
    whole->process(expected.back(), i + 1 < scans.size() ? &scans[i + 1] : nullptr);
    if (i + 1 == saved_after)
    {
      archive(*whole);
    }
  }
  const auto loaded = make(1);
  StateArchive saved(archive.bytes());
  saved(*loaded);
  expectSame(run(*loaded, true, saved_after), expected);
}

TEST_F(FrontEndWithNetwork, EndsTheWorkOnTheNextScanBeforeItReturns)
{
  const auto front_end = make(2);
  for (std::size_t i = 0; i + 1 < missing; ++i)
  {
    Frame frame = scans[i];
    Frame next = scans[i + 1];
    front_end->process(frame, &next);
    next = Frame();  // with AddressSanitizer: nobody reads it any more
  }
  Frame last = scans[missing - 1];
  front_end->process(last);
  EXPECT_FALSE(last.moving_probability.empty());
}
}  // namespace
}  // namespace dyslam
