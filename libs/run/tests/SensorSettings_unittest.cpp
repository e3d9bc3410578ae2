// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/SensorSettings.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr double degree = M_PI / 180;

RecordedSensor sensorWith(std::size_t rings, double spacing_deg)
{
  RecordedSensor sensor;
  sensor.pattern.returns = 20000;
  sensor.pattern.ring_spacing = spacing_deg * degree;
  sensor.pattern.lowest = -15 * degree;
  sensor.pattern.highest = 15 * degree;
  sensor.pattern.azimuth_extent = 2 * M_PI;
  sensor.pattern.max_range = 98;
  sensor.pattern.rings.resize(rings);
  sensor.period = 0.1;
  return sensor;
}

std::vector<std::string> automaticFor(const ScanPattern& pattern)
{
  std::vector<std::string> names;
  for (const std::string& path : sharedFiles("config_files", ".ini"))
  {
    SensorOptions options;
    load(options, Config::fromFile(path), "sensor");
    if (options.automatic && fits(options, pattern, 1))
    {
      names.push_back(std::filesystem::path(path).filename().string());
    }
  }
  return names;
}

TEST(SensorSettings, ExactlyOneShippedIniFitsEverySensor)
{
  for (double spacing = 0.05; spacing < 30; spacing *= 1.07)
  {
    EXPECT_EQ(1U, automaticFor(sensorWith(16, spacing).pattern).size()) << spacing;
  }
  const std::vector<std::string> without{"solid_state.ini"};
  EXPECT_EQ(without, automaticFor(sensorWith(0, 0).pattern));
  // A dense revolution without identifiable rings.
  ScanPattern dense = sensorWith(0, 0).pattern;
  dense.returns = 120000;
  EXPECT_EQ(std::vector<std::string>{"kitti64.ini"}, automaticFor(dense));
  dense.azimuth_extent = M_PI;
  EXPECT_EQ(without, automaticFor(dense));
}

TEST(SensorSettings, ThoseThatFitAreTakenAndNamed)
{
  EXPECT_EQ("kitti64.ini", settingsFor(sensorWith(64, 0.42), Config(), "").source);
  EXPECT_EQ("kitti64.ini", settingsFor(sensorWith(128, 0.18), Config(), "").source);
  EXPECT_EQ("vlp16.ini", settingsFor(sensorWith(16, 2.0), Config(), "").source);
  const auto chosen = settingsFor(sensorWith(16, 2.0), Config(), "");
  EXPECT_EQ("residual", chosen.config.text("dyseg", "method"));
}

TEST(SensorSettings, AnIniOfOneLineChangesThatOneThing)
{
  const Config one = Config::fromText("[dyseg]\nmethod = none\n", "my.ini");
  const RecordedSensor sensor = sensorWith(16, 2.0);
  const ChosenSettings with = settingsFor(sensor, one, "my.ini");
  EXPECT_EQ("vlp16.ini + my.ini", with.source);
  EXPECT_TRUE(with.warnings.empty());
  Config expected = settingsFor(sensor, Config(), "").config;
  EXPECT_NE(expected.toIni(), with.config.toIni());
  expected.set("dyseg.method=none");
  EXPECT_EQ(expected.toIni(), with.config.toIni());
}

TEST(SensorSettings, AnIniForOtherSensorsIsTakenWithAWarning)
{
  const std::string path = findGivenOrShared("kitti64.ini", "config_files", ".ini");
  const Config kitti = Config::fromFile(path);
  const ChosenSettings chosen = settingsFor(sensorWith(16, 2.0), kitti, "kitti64.ini");
  EXPECT_EQ(kitti.toIni(), chosen.config.toIni());
  ASSERT_EQ(1U, chosen.warnings.size());
  for (const char* part : {"kitti64.ini is for sensors with rings", "has 16 rings, 2.0 deg apart",
                           "omit -c to use vlp16.ini"})
  {
    EXPECT_NE(chosen.warnings[0].find(part), std::string::npos) << chosen.warnings[0];
  }
  EXPECT_TRUE(settingsFor(sensorWith(64, 0.42), kitti, "kitti64.ini").warnings.empty());
  EXPECT_EQ(1U, settingsFor(sensorWith(0, 0), kitti, "kitti64.ini").warnings.size());
}

/** An HDL-64E whose rings cannot be told apart is no sensor without rings. */
TEST(SensorSettings, RingsThatAreTooCloseAreRings)
{
  RecordedSensor dense = sensorWith(0, 0);
  dense.pattern.returns = 120000;
  EXPECT_EQ(
      "rings not separable (no ring numbers), 120000 points a scan, -15.0 to 15.0 deg, to 98 m, "
      "10.0 Hz",
      dense.summary());
  const auto warningFor = [&](const RecordedSensor& sensor, const std::string& ini)
  {
    const Config given = Config::fromFile(findGivenOrShared(ini, "config_files", ".ini"));
    const auto warnings = settingsFor(sensor, given, ini).warnings;
    return warnings.empty() ? "" : warnings.front();
  };
  EXPECT_EQ("", warningFor(dense, "kitti64.ini"));
  EXPECT_EQ(
      "solid_state.ini is for sensors without rings; this recording has rings not separable "
      "(no ring numbers), 120000 points a scan; omit -c to use kitti64.ini",
      warningFor(dense, "solid_state.ini"));
  EXPECT_EQ("", warningFor(dense, "handheld.ini"));
  RecordedSensor solid = dense;
  solid.pattern.azimuth_extent = 70 * degree;
  EXPECT_EQ("", warningFor(solid, "solid_state.ini"));
  EXPECT_EQ(
      "kitti64.ini is for sensors with rings up to 0.8 deg apart; this recording has no "
      "rings, 120000 points a scan; omit -c to use solid_state.ini",
      warningFor(solid, "kitti64.ini"));
}

TEST(SensorSettings, SummaryAndMissingTimes)
{
  RecordedSensor sensor = sensorWith(16, 2.0);
  EXPECT_EQ("16 rings, 2.0 deg apart, -15.0 to 15.0 deg, to 98 m, 10.0 Hz", sensor.summary());
  sensor.pattern.rings.clear();
  sensor.pattern.azimuth_extent = 70 * degree;
  EXPECT_EQ("no rings, 20000 points a scan, -15.0 to 15.0 deg, 70 deg wide, to 98 m, 10.0 Hz",
            sensor.summary());
  EXPECT_NE(sensor.missingTimes("auto").find("deskewed by azimuth"), std::string::npos);
  EXPECT_NE(sensor.missingTimes("auto").find("preprocess.deskew=none"), std::string::npos);
  EXPECT_NE(sensor.missingTimes("time").find("not deskewed"), std::string::npos);
  EXPECT_EQ(sensor.missingTimes("time").find("azimuth"), std::string::npos) << "70 deg wide";
  EXPECT_NE(sensorWith(16, 2.0).missingTimes("time").find("preprocess.deskew=azimuth"),
            std::string::npos);
  sensor.has_times = true;
  EXPECT_EQ("", sensor.missingTimes("auto"));
}

/** A scan of 16 rings, 2 deg apart. */
Frame frameOfRings(double stamp,
                   double lowest_deg = -15,
                   int rings = 16,
                   double spacing_deg = 2,
                   int columns = 360)
{
  Frame frame;
  frame.scan.stamp = stamp;
  for (int ring = 0; ring < rings; ++ring)
  {
    const double elevation = (spacing_deg * ring + lowest_deg) * degree;
    for (int column = 0; column < columns; ++column)
    {
      const double azimuth = column * degree;
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      frame.scan.points.push_back((20 * ray).cast<float>());
      frame.scan.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return frame;
}

TEST(SensorSettings, OfSeveralLidarsTheFirstIsRecognised)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (int i = 0; i < 6; ++i)
    {
      Scan left = frameOfRings(100 + 0.1 * i, -20, 40, 1).scan;
      left.sensor_label = "lidar_left";
      left.T_vehicle_lidar = poseFromYpr(1, 1, 1, 0, 0, 0);
      writer.write(left);
      Scan roof = frameOfRings(100.01 + 0.1 * i).scan;
      roof.sensor_label = "lidar_roof";
      writer.write(roof);
    }
    writer.close();
  }
  RawlogSourceOptions input;
  input.further_lidars = "lidar_left";
  const RecordedSensor sensor = recogniseSensor(folder.file("a.rawlog"), input);
  EXPECT_EQ(16U, sensor.pattern.rings.size());
  EXPECT_NEAR(2 * degree, sensor.pattern.ring_spacing, 0.01 * degree);
}

TEST(SensorSettings, IsRecognisedFromTheFirstScans)
{
  const RecordedSensor one = recogniseSensor(std::vector<Frame>{frameOfRings(7)});
  EXPECT_EQ(16U, one.pattern.rings.size());
  EXPECT_EQ(0, one.period);
  EXPECT_FALSE(one.has_times);
  std::vector<Frame> frames;
  for (int i = 0; i < 8; ++i)
  {
    frames.push_back(i < 5 ? frameOfRings(0.1 * i) : Frame());  // five are enough
  }
  frames[1].scan.time.assign(frames[1].scan.size(), 0);
  const RecordedSensor sensor = recogniseSensor(frames);
  EXPECT_NEAR(2 * degree, sensor.pattern.ring_spacing, 0.01 * degree);
  EXPECT_NEAR(0.1, sensor.period, 1e-9);
  EXPECT_TRUE(sensor.has_times);
  EXPECT_EQ(5U, sensor.scans);
  EXPECT_EQ("vlp16.ini", settingsFor(sensor, Config(), "").source);
  EXPECT_THROW((void)recogniseSensor(std::vector<Frame>()), std::invalid_argument);
}

TEST(SensorSettings, OfSeveralLidarsTheFirstIsMeasured)
{
  Scan further = frameOfRings(0, -60, 64, 0.5).scan;
  further.T_vehicle_lidar = poseFromYpr(-1, 0, 0.5, M_PI, 0, 0);
  std::vector<Frame> alone;
  std::vector<Frame> both;
  for (int i = 0; i < 5; ++i)
  {
    alone.push_back(frameOfRings(0.1 * i));
    both.push_back(alone.back());
    further.stamp = 0.1 * i;
    appendScan(further, 1, both.back().scan);
  }
  const RecordedSensor expected = recogniseSensor(alone);
  const RecordedSensor sensor = recogniseSensor(both);
  EXPECT_EQ(expected.pattern.rings, sensor.pattern.rings);
  EXPECT_EQ(expected.pattern.returns, sensor.pattern.returns);
  EXPECT_EQ(expected.share_above, sensor.share_above);
  EXPECT_EQ("vlp16.ini", settingsFor(sensor, Config(), "").source);
}

/** Empty scans of a sensor that starts, and a part of a revolution that shows more rings. */
TEST(SensorSettings, ScansWithFewReturnsDoNotCount)
{
  std::vector<Frame> frames;
  for (int i = 0; i < 12; ++i)
  {
    Frame empty;
    empty.scan.stamp = 0.1 * i;
    frames.push_back(i < 6 ? empty : frameOfRings(0.1 * i));
  }
  frames.insert(frames.begin() + 6, frameOfRings(0.55, -15, 112, 0.25, 20));
  ASSERT_EQ(112U, recogniseSensor(std::vector<Frame>{frames[6]}).pattern.rings.size());
  const RecordedSensor sensor = recogniseSensor(frames);
  EXPECT_EQ(16U, sensor.pattern.rings.size());
  EXPECT_EQ(12U, sensor.scans) << "until five are full";
  EXPECT_EQ(2 * M_PI, sensor.pattern.azimuth_extent);
  const ChosenSettings chosen = settingsFor(sensor, Config(), "");
  EXPECT_EQ("vlp16.ini", chosen.source);
  EXPECT_TRUE(chosen.warnings.empty());
}

TEST(SensorSettings, RingsThatOneScanAloneShowsAreNone)
{
  std::vector<Frame> frames;
  for (int i = 0; i < 5; ++i)
  {
    frames.push_back(i == 0 ? frameOfRings(0, -15, 112, 0.25, 60) : frameOfRings(0.1 * i));
  }
  EXPECT_EQ(16U, recogniseSensor(frames).pattern.rings.size());
}

TEST(SensorSettings, ScansWithoutReturnsAreSaid)
{
  const std::vector<Frame> frames(60);
  const RecordedSensor sensor = recogniseSensor(frames);
  EXPECT_EQ(50U, sensor.scans);
  const auto warnings = settingsFor(sensor, Config(), "").warnings;
  ASSERT_EQ(1U, warnings.size());
  EXPECT_EQ(0U, warnings[0].find("no point of the first 50 scans is a return")) << warnings[0];
  const Config kitti = Config::fromFile(findGivenOrShared("kitti64", "config_files", ".ini"));
  EXPECT_EQ(warnings, settingsFor(sensor, kitti, "kitti64.ini").warnings);
}

TEST(SensorSettings, ALidarThatIsUpsideDownIsAWarning)
{
  std::vector<Frame> frames{frameOfRings(0, -5)};
  const auto warningsNow = [&]
  { return settingsFor(recogniseSensor(frames), Config(), "").warnings; };
  ASSERT_EQ(1U, warningsNow().size());
  EXPECT_NE(warningsNow()[0].find("with --sensor-pose '0 0 0 0 0 180'"), std::string::npos)
      << warningsNow()[0];
  frames[0].scan.T_vehicle_lidar = poseFromYpr(1, 0, 2, 0.3, 0, M_PI);
  EXPECT_TRUE(warningsNow().empty()) << "its pose is known";
  frames[0].scan.T_vehicle_lidar = Pose::Identity();
  frames[0].scan.points = frameOfRings(0, -25).scan.points;
  EXPECT_TRUE(warningsNow().empty());
}

/** A scan of 16 rings over level ground, 1.7 m below, that ends at a round wall at 20 m.
 * \param share_of_sky of the rays above the horizon that return from the wall */
Frame frameOverGround(double roll_deg, double pitch_deg, double share_of_sky = 1)
{
  const Eigen::Matrix3f R_level_lidar =
      poseFromYpr(0, 0, 0, 0, pitch_deg * degree, roll_deg * degree).linear().cast<float>();
  Frame frame = frameOfRings(0);
  for (Eigen::Vector3f& p : frame.scan.points)
  {
    const Eigen::Vector3f ray = R_level_lidar * p / 20;
    p *= ray.z() < 0 ? std::min(1.0F, 1.7F / (20 * -ray.z())) : 1.0F;
  }
  // Of the rays that go up, some return nothing.
  std::size_t up = 0;
  for (Eigen::Vector3f& p : frame.scan.points)
  {
    const bool is_up = (R_level_lidar * p).z() > 0;
    up += is_up ? 1U : 0U;
    if (is_up && std::fmod(static_cast<double>(up), 10) >= 10 * share_of_sky)
    {
      p.setZero();
    }
  }
  return frame;
}

TEST(SensorSettings, AVehicleFrameOverInclinedGroundIsLevelled)
{
  const std::vector<Frame> frames{frameOverGround(-6, 20)};
  const RecordedSensor sensor = recogniseSensor(frames);
  ASSERT_TRUE(sensor.ground);
  const ChosenSettings chosen = settingsFor(sensor, Config(), "");
  EXPECT_TRUE(chosen.warnings.empty());
  EXPECT_NE(chosen.levelling_note.find("(roll -6.0 deg, pitch 20.0 deg): levelled"),
            std::string::npos)
      << chosen.levelling_note;
  RawlogSourceOptions input;
  load(input, chosen.config, "input");
  EXPECT_NEAR(-6 * degree, input.roll, 0.1 * degree);
  EXPECT_NEAR(20 * degree, input.pitch, 0.1 * degree);
  EXPECT_TRUE(chosen.levelling.T_level_recorded().isApprox(input.levelling().T_level_recorded()));
  Frame frame = frames[0];
  frame.imu.emplace_back();
  chosen.level(frame);
  const Pose T = chosen.levelling.T_level_recorded();
  EXPECT_TRUE(frame.scan.T_vehicle_lidar.isApprox(T));
  EXPECT_TRUE(frame.imu[0].T_vehicle_imu.isApprox(T));
  const auto now = recogniseSensor(std::vector<Frame>{frame});
  ASSERT_TRUE(now.ground);
  EXPECT_LT(now.ground->inclination(), 0.1 * degree);
  EXPECT_EQ("", settingsFor(now, chosen.config, "effective.ini").levelling_note);

  // As the user wants it.
  const ChosenSettings kept = settingsFor(sensor, Config(), "", {"input.level=false"});
  EXPECT_EQ("", kept.levelling_note);
  EXPECT_TRUE(kept.levelling.isNone());
  ASSERT_EQ(1U, kept.warnings.size());
  EXPECT_NE(kept.warnings[0].find("the ground is inclined by 20."), std::string::npos);
}

TEST(SensorSettings, AnglesOfTheUserReplaceLevelling)
{
  const RecordedSensor sensor = recogniseSensor(std::vector<Frame>{frameOverGround(0, 20)});
  const ChosenSettings own =
      settingsFor(sensor, Config(), "", {"input.level=false", "input.pitch_deg=19"});
  EXPECT_TRUE(own.warnings.empty()) << own.warnings[0];
  EXPECT_TRUE(own.levelling.T_level_recorded().isApprox(poseFromYpr(0, 0, 0, 0, 19 * degree, 0)));
  EXPECT_THROW((void)settingsFor(sensor, Config(), "", {"input.pitch_deg = 19"}), UserError);
  const Config ini = Config::fromText("[input]\npitch_deg = 19\n", "my.ini");
  EXPECT_THROW((void)settingsFor(sensor, ini, "my.ini"), UserError);
  EXPECT_EQ("", settingsFor(sensor, ini, "my.ini", {"input.level=false"}).levelling_note);
  const ChosenSettings less =
      settingsFor(sensor, Config(), "", {"input.level=false", "input.pitch_deg=12"});
  ASSERT_EQ(1U, less.warnings.size());
  EXPECT_NE(less.warnings[0].find("pitch 20.0 deg); after input.roll_deg and input.pitch_deg still "
                                  "by 8.0 deg"),
            std::string::npos)
      << less.warnings[0];
}

TEST(SensorSettings, ACeilingIsNoGround)
{
  Frame frame = frameOverGround(180, 0);  // of a lidar that looks upwards
  const auto looksUp = [](const Eigen::Vector3f& p) { return p.z() < -0.1F * p.norm(); };
  for (Eigen::Vector3f& p : frame.scan.points)
  {
    p = looksUp(p) ? Eigen::Vector3f::Zero().eval() : p;
  }
  const RecordedSensor sensor = recogniseSensor(std::vector<Frame>{frame});
  EXPECT_FALSE(sensor.ground);
  EXPECT_EQ("", settingsFor(sensor, Config(), "").levelling_note);
}

TEST(SensorSettings, ALidarThatHangsUpsideDownIsTurned)
{
  const RecordedSensor sensor =
      recogniseSensor(std::vector<Frame>(3, frameOverGround(180, 0, 0.5)));
  const ChosenSettings chosen = settingsFor(sensor, Config(), "");
  EXPECT_NE("", chosen.levelling_note);
  EXPECT_NEAR(-1, chosen.levelling.T_level_recorded().linear()(2, 2), 1e-3);
}

TEST(SensorSettings, StartUpScansDoNotCount)
{
  std::vector<Frame> frames;
  for (int i = 0; i < 9; ++i)
  {
    frames.push_back(frameOverGround(0, 20));
    auto& points = frames.back().scan.points;
    const std::size_t kept = i < 4 ? points.size() * static_cast<std::size_t>(2 * i + 1) / 20 : 0;
    std::fill(points.begin() + static_cast<std::ptrdiff_t>(kept),
              i < 4 ? points.end() : points.begin(), Eigen::Vector3f::Zero());
  }
  EXPECT_NE("", settingsFor(recogniseSensor(frames), Config(), "").levelling_note);
}

TEST(SensorSettings, LevelGroundAndScansThatDisagreeChangeNothing)
{
  const auto of = [](const std::vector<Frame>& frames)
  { return settingsFor(recogniseSensor(frames), Config(), ""); };
  const ChosenSettings level = of({frameOverGround(1, 3)});
  EXPECT_FALSE(level.config.has("input", "pitch_deg"));
  EXPECT_TRUE(level.warnings.empty() && level.levelling_note.empty());
  const ChosenSettings swinging = of({frameOverGround(0, 20), frameOverGround(0, 10)});
  EXPECT_FALSE(swinging.config.has("input", "pitch_deg"));
  const ChosenSettings bump =
      of({frameOverGround(0, 20), frameOverGround(0, 10), frameOverGround(0, 21)});
  EXPECT_NEAR(20.5 * degree,
              bump.config.has("input", "pitch_deg")
                  ? std::stod(bump.config.text("input", "pitch_deg").value()) * degree
                  : 0,
              0.1 * degree);
}

TEST(SensorSettings, EqualTimesAreSaid)
{
  std::vector<Frame> frames{frameOfRings(0), frameOfRings(0.1)};
  for (Frame& frame : frames)
  {
    frame.scan.time.assign(frame.scan.size(), 0);
  }
  const RecordedSensor equal = recogniseSensor(frames);
  EXPECT_TRUE(equal.has_times && equal.equal_times);
  for (const char* deskew : {"auto", "time"})
  {
    const std::string text = equal.missingTimes(deskew);
    EXPECT_NE(text.find("the scans count as deskewed"), std::string::npos) << text;
    EXPECT_NE(text.find("preprocess.deskew=azimuth"), std::string::npos) << text;
  }
  EXPECT_EQ("", equal.missingTimes("none"));
  EXPECT_EQ("", equal.missingTimes("azimuth"));
  frames[1].scan.time.back() = 0.1F;
  const RecordedSensor timed = recogniseSensor(frames);
  EXPECT_TRUE(timed.has_times && !timed.equal_times);
  EXPECT_EQ("", timed.missingTimes("auto"));
}

TEST(SensorSettings, MissingTimesAreByTheConfig)
{
  const RecordedSensor sensor = sensorWith(16, 2.0);
  EXPECT_EQ(sensor.missingTimes("auto"), sensor.missingTimes(Config()));
  const Config none = Config::fromText("[preprocess]\ndeskew = none\n", "test");
  EXPECT_EQ(sensor.missingTimes("none"), sensor.missingTimes(none));
}

TEST(SensorSettings, ARecordingThatIsMissingIsNamed)
{
  EXPECT_THROW((void)recogniseSensor("none.rawlog", RawlogSourceOptions()), UserError);
}
}  // namespace
}  // namespace dyslam
