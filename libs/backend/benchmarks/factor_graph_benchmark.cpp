// SPDX-License-Identifier: BSD-3-Clause
// Cost of the backend's factor graph per keyframe: a long drive with five objects in view all the
// time, three of them parked, two driving ahead. Times are processor time.
//   factor_graph_benchmark [--keyframes N] [--mode full|segmot] [--csv FILE]
#include <dyslam/backend/Backend.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace
{
using namespace dyslam;

constexpr double scan_period = 0.1;        // time between scans [s]
constexpr double keyframe_distance = 1.5;  // distance driven in one scan [m]
constexpr double parked_spacing = 12;      // distance of parked cars along the road [m]
constexpr std::size_t lead_scans = 200;    // number of scans for which a car drives ahead
constexpr double position_sigma = 0.1;     // sigma of observed positions [m]
constexpr double heading_sigma = 0.03;     // sigma of observed headings [rad]
constexpr std::size_t block_size = 500;    // keyframes per row of the table

/** Processor time of this program alone [s]. */
double processorSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double residentMebibytes()
{
  std::ifstream file("/proc/self/statm");
  double size = 0;
  double resident = 0;
  file >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/** Results of odometry and tracker for a drive along a road of gentle bends. */
class Traffic
{
 public:
  explicit Traffic(std::size_t scans)
  {
    Pose pose = Pose::Identity();
    // The road continues beyond the drive, for the cars ahead.
    for (std::size_t i = 0; i < scans + 40; ++i)
    {
      road_.push_back(pose);
      pose = pose * poseFromYpr(keyframe_distance, 0, 0,
                                0.01 * std::sin(0.01 * static_cast<double>(i)), 0, 0);
    }
  }

  Frame frame(std::size_t scan)
  {
    Frame frame;
    frame.index = scan;
    frame.scan.stamp = scan_period * static_cast<double>(scan);
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = 1e5 * Matrix6::Identity();
    if (scan > 0)
    {
      T_odom_vehicle_ =
          T_odom_vehicle_ * noisy(road_[scan - 1].inverse() * road_[scan], 0.01, 5e-4);
    }
    frame.T_odom_vehicle = T_odom_vehicle_;
    // Three parked cars, just passed or next ahead, each on its side of the road.
    const auto next =
        static_cast<std::size_t>(static_cast<double>(scan) * keyframe_distance / parked_spacing);
    for (std::size_t i = next; i < next + 3; ++i)
    {
      const auto place =
          static_cast<std::size_t>(static_cast<double>(i) * parked_spacing / keyframe_distance);
      observe(frame, static_cast<int>(i),
              road_[place] * poseFromYpr(0, i % 2 == 0 ? 4 : -4, 0, 0, 0, 0));
    }
    for (std::size_t i = 0; i < 2; ++i)
    {
      const std::size_t car = 2 * ((scan + i * lead_scans / 2) / lead_scans) + i;
      observe(frame, 1000000 + static_cast<int>(car), road_[scan + 8 + 8 * i]);
    }
    return frame;
  }

 private:
  Pose noisy(const Pose& pose, double sigma, double rotation_sigma)
  {
    Vector6 x = Vector6::NullaryExpr([this] { return normal_(rng_); });
    x.head<3>() *= sigma;
    x.tail<3>() *= rotation_sigma;
    return orthonormalised(pose * expSE3(x));
  }

  void observe(Frame& frame, int id, const Pose& T_map_object)
  {
    const Pose T_vehicle_object = road_[frame.index].inverse() * T_map_object;
    const Pose seen = frame.T_odom_vehicle * T_vehicle_object;
    TrackedObject object;
    object.id = id;
    object.object_class = ObjectClass::car;
    object.confirmed = true;
    object.observed = true;
    object.observation.centre = seen.translation();
    for (int i = 0; i < 3; ++i)
    {
      object.observation.centre[i] += position_sigma * normal_(rng_);
    }
    object.observation.yaw = std::atan2(seen(1, 0), seen(0, 0)) + heading_sigma * normal_(rng_);
    object.observation_covariance.setIdentity();
    object.observation_covariance *= position_sigma * position_sigma;
    object.observation_covariance(3, 3) = heading_sigma * heading_sigma;
    frame.objects.push_back(object);
  }

  std::mt19937 rng_{1};
  std::normal_distribution<double> normal_;
  std::vector<Pose> road_;
  Pose T_odom_vehicle_ = Pose::Identity();
};

struct Arguments
{
  std::size_t keyframes = 10000;
  BackendMode mode = BackendMode::full;
  std::string csv;
};

bool parse(int argc, char** argv, Arguments& a)
{
  for (int i = 1; i + 1 < argc; i += 2)
  {
    const std::string name = argv[i];
    const std::string value = argv[i + 1];
    if (name == "--keyframes")
    {
      a.keyframes = static_cast<std::size_t>(std::max(1, std::atoi(value.c_str())));
    }
    else if (name == "--mode" && (value == "full" || value == "segmot"))
    {
      a.mode = value == "full" ? BackendMode::full : BackendMode::segmot;
    }
    else if (name == "--csv")
    {
      a.csv = value;
    }
    else
    {
      return false;
    }
  }
  return argc % 2 == 1;
}

void run(const Arguments& a)
{
  Traffic traffic(a.keyframes);
  BackendConfig config;
  config.backend.mode = a.mode;
  config.backend.keyframe_distance = 0.9 * keyframe_distance;
  KeyframeStore keyframes;
  Backend backend(config, keyframes);
  std::string table = "keyframes,ms_per_keyframe,ms_worst,resident_mib,variables,factors\n";
  double spent = 0;
  double worst = 0;
  for (std::size_t scan = 0; scan < a.keyframes; ++scan)
  {
    Frame frame = traffic.frame(scan);
    const double start = processorSeconds();
    backend.addOdometry(frame);
    (void)backend.optimise(frame);
    const double seconds = processorSeconds() - start;
    spent += seconds;
    worst = std::max(worst, seconds);
    if ((scan + 1) % block_size == 0)
    {
      char row[160];
      std::snprintf(row, sizeof row, "%zu,%.3f,%.3f,%.1f,%zu,%zu\n", keyframes.size(),
                    1e3 * spent / block_size, 1e3 * worst, residentMebibytes(),
                    backend.factorGraph().variables().size(), backend.factorGraph().factorCount());
      table += row;
      std::printf("%s", row);
      std::fflush(stdout);
      spent = worst = 0;
    }
  }
  const double start = processorSeconds();
  backend.finish();
  const double finish_seconds = processorSeconds() - start;
  const OptimisationResult& result = backend.lastOptimisation();
  std::printf("finish: %.2f s, %d iterations, chi2 %.6g -> %.6g, resident %.1f MiB\n",
              finish_seconds, result.iterations, result.initial_chi2, result.final_chi2,
              residentMebibytes());
  std::map<std::string, int> kinds;
  for (const auto id : backend.factorGraph().factorIds())
  {
    ++kinds[backend.factorGraph().factor(id).type().name];
  }
  for (const auto& [kind, count] : kinds)
  {
    std::printf("%s %d\n", kind.c_str(), count);
  }
  for (const std::string& warning : backend.warnings())
  {
    std::printf("warning: %s\n", warning.c_str());
  }
  if (!a.csv.empty())
  {
    std::ofstream(a.csv) << table;
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments a;
  if (!parse(argc, argv, a))
  {
    std::fprintf(stderr,
                 "factor_graph_benchmark [--keyframes N] [--mode full|segmot] [--csv FILE]\n");
    return 1;
  }
  run(a);
  return 0;
}
