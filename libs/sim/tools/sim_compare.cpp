// SPDX-License-Identifier: BSD-3-Clause
// Compares simulated with real scans: images and statistics, for doc/simulator.md.
//   sim_compare --world urban --sensor HDL64E --scans 20 --real DIR_OF_BIN [--every N] -o PREFIX
// Writes PREFIX_range.png (real above simulated) and PREFIX_bev.png (real left) and prints one
// table of statistics for Markdown.
#include <dyslam/base/Error.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/sim/Simulator.h>

#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace
{
using dyslam::Scan;
constexpr double pi = 3.14159265358979;
constexpr int threads = 2;

/** The returns of a scan, intensity in [0, 1]. */
Scan readReturns(const std::string& path)
{
  const Scan scan = dyslam::readBin(path);
  Scan returns;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    if (dyslam::isReturn(scan.points[i]))
    {
      returns.points.push_back(scan.points[i]);
      returns.intensity.push_back(scan.intensity[i] > 1 ? scan.intensity[i] / 255
                                                        : scan.intensity[i]);
    }
  }
  return returns;
}

/** Row of the sensor's beam nearest in elevation, for real and simulated scans. */
class RowFinder
{
 public:
  explicit RowFinder(const dyslam::sim::SensorModel& sensor)
  {
    for (const auto& b : sensor.beams)
    {
      elevations_.push_back(b.elevation);
    }
  }
  int row(const Eigen::Vector3f& p) const
  {
    const double e =
        std::atan2(static_cast<double>(p.z()), static_cast<double>(p.head<2>().norm()));
    const auto above = std::lower_bound(elevations_.begin(), elevations_.end(), e);
    const auto i = static_cast<int>(above - elevations_.begin());
    if (i == 0 || (i < rows() && std::abs(elevations_[static_cast<std::size_t>(i)] - e) <
                                     std::abs(elevations_[static_cast<std::size_t>(i - 1)] - e)))
    {
      return std::min(i, rows() - 1);
    }
    return i - 1;
  }
  int rows() const { return static_cast<int>(elevations_.size()); }

 private:
  std::vector<double> elevations_;
};

cv::Mat rangeImage(const Scan& scan, const RowFinder& finder, int columns)
{
  cv::Mat image(finder.rows(), columns, CV_32F, cv::Scalar(0));
  for (const auto& p : scan.points)
  {
    const double a = std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()));
    const int c = std::clamp(static_cast<int>((pi - a) / (2 * pi) * columns), 0, columns - 1);
    float& cell = image.at<float>(finder.rows() - 1 - finder.row(p), c);
    const float r = p.norm();
    cell = cell == 0 || r < cell ? r : cell;
  }
  return image;
}

cv::Mat drawRangeImage(const cv::Mat& range, double max_range)
{
  cv::Mat shade(range.size(), CV_8U), mask = range == 0;
  for (int y = 0; y < range.rows; ++y)
  {
    for (int x = 0; x < range.cols; ++x)
    {
      const double f =
          std::sqrt(std::min(1.0, static_cast<double>(range.at<float>(y, x)) / max_range));
      shade.at<unsigned char>(y, x) = static_cast<unsigned char>(255 * (1 - f));
    }
  }
  cv::Mat colour, large;
  cv::applyColorMap(shade, colour, cv::COLORMAP_TURBO);
  colour.setTo(cv::Scalar(0, 0, 0), mask);
  cv::resize(colour, large, cv::Size(range.cols, range.rows * std::max(1, 256 / range.rows)), 0, 0,
             cv::INTER_NEAREST);
  return large;
}

cv::Mat drawBev(const Scan& scan, const std::vector<std::uint8_t>* moving, double half)
{
  const int size = 640;
  cv::Mat image(size, size, CV_8UC3, cv::Scalar(0, 0, 0));
  for (std::size_t i = 0; i < scan.points.size(); ++i)
  {
    const auto& p = scan.points[i];
    const int x = static_cast<int>((half - static_cast<double>(p.y())) / (2 * half) * size);
    const int y = static_cast<int>((half - static_cast<double>(p.x())) / (2 * half) * size);
    if (x < 0 || y < 0 || x >= size || y >= size)
    {
      continue;
    }
    const double h = std::clamp((static_cast<double>(p.z()) + 2.0) / 5.0, 0.0, 1.0);
    cv::Vec3b colour(static_cast<unsigned char>(255 * (1 - h)),
                     static_cast<unsigned char>(120 + 135 * h),
                     static_cast<unsigned char>(60 + 195 * h));
    if (moving != nullptr && (*moving)[i] != 0)
    {
      colour = cv::Vec3b(40, 40, 255);
    }
    image.at<cv::Vec3b>(y, x) = colour;
  }
  return image;
}

void caption(cv::Mat& image, const char* text)
{
  cv::putText(image, text, cv::Point(10, 24), cv::FONT_HERSHEY_SIMPLEX, 0.7, cv::Scalar(0, 0, 0), 4,
              cv::LINE_AA);
  cv::putText(image, text, cv::Point(10, 24), cv::FONT_HERSHEY_SIMPLEX, 0.7,
              cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
}

/** Joins two pictures, the first above or left of the second, with a line between. */
void saveJoined(cv::Mat first, cv::Mat second, bool beside, const std::string& path)
{
  caption(first, "real");
  caption(second, "simulated");
  const cv::Mat line(beside ? cv::Size(6, first.rows) : cv::Size(first.cols, 6), CV_8UC3,
                     cv::Scalar(255, 255, 255));
  cv::Mat joined;
  const std::vector<cv::Mat> parts{first, line, second};
  beside ? cv::hconcat(parts, joined) : cv::vconcat(parts, joined);
  cv::imwrite(path, joined, {cv::IMWRITE_PNG_COMPRESSION, 9});
}

/** Statistics of scans, as means over the scans. */
struct Statistics
{
  int scans = 0;
  double points = 0, filled = 0, ground = 0, ground_roughness = 0, plane_roughness = 0,
         isolated = 0, intensity = 0;
  std::array<double, 9> range{};  // shares up to 5, 10, 15, 20, 30, 40, 60, 80 m and beyond
  std::vector<double> ring;

  void add(const Scan& scan, const RowFinder& finder, int columns);

 private:
  void addRoughness(const Scan& scan);
  void addGaps(const cv::Mat& image);
};

constexpr std::array<double, 8> range_edges{{5, 10, 15, 20, 30, 40, 60, 80}};

/** RMS distance of the points in a cell from their best plane. */
double planeSpread(const std::vector<Eigen::Vector3d>& points, Eigen::Vector3d& normal)
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points)
  {
    mean += p;
  }
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points)
  {
    covariance += (p - mean) * (p - mean).transpose();
  }
  covariance /= static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  normal = solver.eigenvectors().col(0);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

double median(std::vector<double>& v)
{
  return v.empty() ? 0 : dyslam::upperMedian(v);
}

/** Number of the cube of side s around a point. */
long cubeOf(double x, double y, double z, double s)
{
  return (std::lround(std::floor(x / s)) + 4096) | (std::lround(std::floor(y / s)) + 4096) << 16 |
         (std::lround(std::floor(z / s)) + 4096) << 32;
}

/** Number of points that are negative in z and near the lowest of their square of 1 m. */
double groundPoints(const Scan& scan)
{
  const auto squareOf = [](const Eigen::Vector3f& p)
  { return cubeOf(static_cast<double>(p.x()), static_cast<double>(p.y()), 0, 1.0); };
  std::unordered_map<long, float> lowest;
  for (const auto& p : scan.points)
  {
    const auto entry = lowest.emplace(squareOf(p), p.z()).first;
    entry->second = std::min(entry->second, p.z());
  }
  double count = 0;
  for (const auto& p : scan.points)
  {
    const auto low = static_cast<double>(lowest[squareOf(p)]);
    count += static_cast<double>(p.z()) < low + 0.15 && p.z() < 0 ? 1 : 0;
  }
  return count;
}

void Statistics::add(const Scan& scan, const RowFinder& finder, int columns)
{
  ++scans;
  ring.resize(static_cast<std::size_t>(finder.rows()));
  const auto n = static_cast<double>(scan.points.size());
  points += n;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
  {
    const double r = scan.points[i].cast<double>().norm();
    ++ring[static_cast<std::size_t>(finder.row(scan.points[i]))];
    const auto bin =
        std::upper_bound(range_edges.begin(), range_edges.end(), r) - range_edges.begin();
    range[static_cast<std::size_t>(bin)] += 1 / n;
    intensity += static_cast<double>(scan.intensity.empty() ? 0.0F : scan.intensity[i]) / n;
  }
  ground += groundPoints(scan) / n;
  addRoughness(scan);
  addGaps(rangeImage(scan, finder, columns));
}

/** Roughness of cells of 0.5 m within 30 m. */
void Statistics::addRoughness(const Scan& scan)
{
  std::unordered_map<long, std::vector<Eigen::Vector3d>> cells;
  for (const auto& q : scan.points)
  {
    const Eigen::Vector3d p = q.cast<double>();
    if (p.norm() < 30)
    {
      cells[cubeOf(p.x(), p.y(), p.z(), 0.5)].push_back(p);
    }
  }
  std::vector<double> level, upright;
  for (const auto& [unused, cell] : cells)
  {
    Eigen::Vector3d normal;
    if (cell.size() >= 12)
    {
      const double spread = planeSpread(cell, normal);
      (std::abs(normal.z()) > 0.9 ? level : upright).push_back(spread);
    }
  }
  ground_roughness += median(level);
  plane_roughness += median(upright);
}

/** Holes: empty cells whose left and right neighbours have similar ranges. Isolated points: cells
 * between two surfaces. */
void Statistics::addGaps(const cv::Mat& image)
{
  double full = 0, holes = 0, lonely = 0;
  for (int y = 0; y < image.rows; ++y)
  {
    for (int x = 1; x + 1 < image.cols; ++x)
    {
      const float here = image.at<float>(y, x), left = image.at<float>(y, x - 1),
                  right = image.at<float>(y, x + 1);
      full += here > 0 ? 1 : 0;
      holes += here == 0 && left > 0 && right > 0 && std::abs(left - right) < 0.5F ? 1 : 0;
      lonely += here > 0 && left > 0 && right > 0 && std::abs(here - left) > 0.3F &&
                        std::abs(here - right) > 0.3F && std::abs(left - right) > 0.3F
                    ? 1
                    : 0;
    }
  }
  filled += 1 - holes / (full + holes);
  isolated += lonely / full;
}

void printTable(const Statistics& real, const Statistics& simulated)
{
  const auto row = [](const std::string& name, double a, double b, int digits)
  { std::printf("| %s | %.*f | %.*f |\n", name.c_str(), digits, a, digits, b); };
  const double k = 1.0 / std::max(1, real.scans), l = 1.0 / std::max(1, simulated.scans);
  std::printf("| | real (%d scans) | simulated (%d scans) |\n|---|---|---|\n", real.scans,
              simulated.scans);
  row("points per scan", real.points * k, simulated.points * l, 0);
  row("dropouts: holes between neighbours of similar range", 1 - real.filled * k,
      1 - simulated.filled * l, 3);
  row("points between two surfaces (mixed pixels)", real.isolated * k, simulated.isolated * l, 3);
  row("fraction of ground points", real.ground * k, simulated.ground * l, 3);
  row("mean intensity", real.intensity * k, simulated.intensity * l, 3);
  row("roughness of level 0.5 m cells [m]", real.ground_roughness * k,
      simulated.ground_roughness * l, 4);
  row("roughness of upright 0.5 m cells [m]", real.plane_roughness * k,
      simulated.plane_roughness * l, 4);
  for (std::size_t i = 0; i < real.range.size(); ++i)
  {
    const auto edge = [](std::size_t e)
    { return std::to_string(static_cast<int>(range_edges[e])); };
    row("fraction of ranges " +
            (i == 0                    ? "below " + edge(0)
             : i == range_edges.size() ? "above " + edge(i - 1)
                                       : edge(i - 1) + "-" + edge(i)) +
            " m",
        real.range[i] * k, simulated.range[i] * l, 3);
  }
  const std::size_t group = simulated.ring.size() > 32 ? 8 : 2;
  for (std::size_t i = 0; i < simulated.ring.size(); i += group)
  {
    double a = 0, b = 0;
    for (std::size_t j = i; j < std::min(i + group, simulated.ring.size()); ++j)
    {
      a += real.ring.empty() ? 0.0 : real.ring[j] * k / static_cast<double>(group);
      b += simulated.ring[j] * l / static_cast<double>(group);
    }
    row("points on a ring, rings " + std::to_string(i) + "-" + std::to_string(i + group - 1), a, b,
        0);
  }
}
/** What is compared, and where the pictures go. */
struct Arguments
{
  std::string world = "urban";
  std::string sensor = "HDL64E";
  std::string ego = "automatic";
  std::string real;
  std::string output;
  int scans = 10;
  int every = 5;
  int seed = 1;
  int worlds = 1;
  int picture = 0;
  int picture_real = 0;
  int columns = 1024;
  double traffic = 0.4;
  double half = 50;
  double loop = 400;
  double speed = 0;

  void declare(CLI::App& app);
  [[nodiscard]] dyslam::sim::SimulatorOptions simulator() const;
};

void Arguments::declare(CLI::App& app)
{
  app.add_option("--world", world);
  app.add_option("--sensor", sensor);
  app.add_option("--traffic", traffic);
  app.add_option("--seed", seed);
  app.add_option("--loop", loop);
  app.add_option("--speed", speed);
  app.add_option("--ego", ego);
  app.add_option("--scans", scans)->check(CLI::PositiveNumber);
  app.add_option("--every", every, "stride of the evaluated simulated scans");
  app.add_option("--picture", picture,
                 "index of the drawn simulated scan among the evaluated ones");
  app.add_option("--worlds", worlds, "drives that the simulated scans are taken from, seed by seed")
      ->check(CLI::PositiveNumber);
  app.add_option("--picture-real", picture_real,
                 "index of the drawn real scan among the evaluated ones");
  app.add_option("--half", half, "half extent of the bird's-eye view [m]");
  app.add_option("--columns", columns, "columns of the range image");
  app.add_option("--real", real, "folder of .bin scans")->required();
  app.add_option("-o", output, "prefix of the image files")->required();
}

dyslam::sim::SimulatorOptions Arguments::simulator() const
{
  dyslam::sim::SimulatorOptions options;
  options.world = dyslam::sim::worldKindFromString(world);
  options.sensor = dyslam::sim::sensorKindFromString(sensor);
  options.traffic = traffic;
  options.seed = seed;
  options.loop_length = loop;
  options.ego_speed = speed;
  options.ego = dyslam::sim::egoKindFromString(ego);
  return options;
}

/** Statistics of real or simulated scans, and pictures of one of them. */
struct Evaluated
{
  Statistics statistics;
  cv::Mat range;  //!< range image; empty without the scan to draw
  cv::Mat bev;    //!< bird's-eye view

  void draw(const Scan& scan,
            const std::vector<std::uint8_t>* moving,
            const RowFinder& finder,
            const Arguments& a)
  {
    range = drawRangeImage(rangeImage(scan, finder, a.columns), 60);
    bev = drawBev(scan, moving, a.half);
  }
};

Evaluated evaluateSimulated(const Arguments& a,
                            dyslam::sim::Simulator simulator,
                            const RowFinder& finder)
{
  Evaluated result;
  dyslam::sim::SimulatorOptions options = a.simulator();
  for (int i = 0; i < a.scans; ++i)
  {
    const int drive = i * a.worlds / a.scans;
    if (drive + a.seed != options.seed)
    {
      options.seed = drive + a.seed;
      simulator = dyslam::sim::Simulator(options, threads);
    }
    const dyslam::sim::SimulatedScan scan = simulator.next();
    for (int k = 1; k < a.every; ++k)
    {
      (void)simulator.next();
    }
    result.statistics.add(scan.scan, finder, a.columns);
    if (i == a.picture)
    {
      result.draw(scan.scan, &scan.moving, finder, a);
    }
  }
  return result;
}

Evaluated evaluateReal(const Arguments& a, const RowFinder& finder)
{
  Evaluated result;
  const std::vector<std::string> files = dyslam::listBinFiles(a.real);
  const std::size_t step =
      std::max<std::size_t>(1, files.size() / static_cast<std::size_t>(a.scans));
  for (std::size_t i = 0; i < files.size(); i += step)
  {
    const Scan scan = readReturns(files[i]);
    result.statistics.add(scan, finder, a.columns);
    if (i / step == static_cast<std::size_t>(a.picture_real) || result.range.empty())
    {
      result.draw(scan, nullptr, finder, a);
    }
  }
  return result;
}

void compare(const Arguments& a)
{
  dyslam::sim::Simulator simulator(a.simulator(), threads);
  const RowFinder finder(simulator.sensor());
  const Evaluated simulated = evaluateSimulated(a, std::move(simulator), finder);
  const Evaluated real = evaluateReal(a, finder);
  if (real.range.empty() || simulated.range.empty())
  {
    throw dyslam::UserError("--real: no .bin scan in " + a.real + ", or --picture beyond --scans");
  }
  saveJoined(real.range, simulated.range, false, a.output + "_range.png");
  saveJoined(real.bev, simulated.bev, true, a.output + "_bev.png");
  printTable(real.statistics, simulated.statistics);
}
}  // namespace

int main(int argc, char** argv)
{
  CLI::App app("Compares simulated with real scans: images and statistics");
  Arguments a;
  a.declare(app);
  CLI11_PARSE(app, argc, argv);
  try
  {
    compare(a);
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
