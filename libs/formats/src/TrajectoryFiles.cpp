// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <utility>

#include "PoseChecks.h"

namespace dyslam
{
namespace
{
constexpr int digits = 12;

Pose poseFromRow(const TextFile& file, const std::vector<double>& row)
{
  Pose pose = Pose::Identity();
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      pose.matrix()(i, j) = row[static_cast<std::size_t>(4 * i + j)];
    }
  }
  if (!isRotation(pose.linear()))
  {
    file.fail("columns 1-3, 5-7, 9-11 are not a rotation matrix");
  }
  requirePosition(file, pose.translation());
  return orthonormalised(pose);
}

/** The poses of the lines of a file. */
class TimedPoses
{
 public:
  [[nodiscard]] bool empty() const { return trajectory_.empty(); }
  [[nodiscard]] Trajectory take() { return std::move(trajectory_); }

  /** Appends the pose of the current line; a second one of the same time is left out. \throws
   * UserError for a line that does not fit. */
  void add(const TextFile& file,
           double stamp,
           const Eigen::Vector3d& position,
           const Eigen::Quaterniond& q)
  {
    if (std::abs(q.norm() - 1) > 0.02)
    {
      file.fail("the quaternion's length is not 1");
    }
    requirePosition(file, position);
    const double last = empty() ? stamp : trajectory_[trajectory_.size() - 1].stamp;
    if (stamp < last)
    {
      file.fail("the time is before that of the line before; sort the lines by time");
    }
    if (!empty() && stamp == last)
    {
      leaveOut(file);
      return;
    }
    Pose pose = Pose::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = position;
    trajectory_.push_back(stamp, pose);
    left_out_ = 0;
  }

 private:
  void leaveOut(const TextFile& file)
  {
    constexpr std::size_t most = 4;
    if (++left_out_ > most)
    {
      file.fail("is the " + std::to_string(left_out_ + 1) +
                "th line with the same time; write the times with more digits");
    }
  }

  Trajectory trajectory_;
  std::size_t left_out_ = 0;  //!< number of lines since the last pose, of the same time
};

/** The first line of EuRoC's csv, which names the columns: `#timestamp [ns]` or another time, three
 * of the position, then `q_RS_w []` or `qw`; empty if the first line is another. */
std::string eurocHeader(const std::string& path)
{
  std::ifstream file = openBinary(path);
  std::string line;
  std::getline(file, line);
  removeByteOrderMark(line);
  std::size_t begin = line.rfind("#time", 0);
  for (int column = 0; column < 4 && begin != std::string::npos; ++column)
  {
    begin = line.find(',', begin + 1);
  }
  begin = begin == std::string::npos ? begin : line.find_first_not_of(", ", begin);
  if (begin == std::string::npos)
  {
    return "";
  }
  const std::string name = line.substr(begin, line.find_first_of(" ,[(\r", begin) - begin);
  return !name.empty() && name.front() == 'q' && name.back() == 'w' ? line : "";
}

/** Poses of EuRoC's csv; columns behind the quaternion, such as velocity and biases, are skipped.
 */
Trajectory readEuroc(const std::string& path, const std::string& header)
{
  const bool in_nanoseconds = header.substr(0, header.find(',')).find("ns") != std::string::npos;
  TextFile file(path);
  TimedPoses poses;
  double unit = 1e-9;
  while (file.next())
  {
    std::array<double, 8> row{};
    if (file.fields().size() < row.size())
    {
      file.fail("has " + std::to_string(file.fields().size()) +
                " fields, needs 8 or more (t x y z qw qx qy qz, as EuRoC's header says)");
    }
    for (std::size_t i = 0; i < row.size(); ++i)
    {
      row[i] = file.number(i);
    }
    if (poses.empty() && !in_nanoseconds)
    {
      unit = unitOfDate(row[0]);
    }
    poses.add(file, unit * row[0], Eigen::Vector3d(row[1], row[2], row[3]),
              Eigen::Quaterniond(row[4], row[5], row[6], row[7]));
  }
  return poses.take();
}

/** Poses of a file with a time since 1970 and KITTI's twelve numbers in each line. */
Trajectory readStampedMatrices(const std::string& path)
{
  constexpr double first_date = 1e8;  // [s], in 1973
  TextFile file(path);
  TimedPoses poses;
  double unit = 1;
  while (file.next())
  {
    file.requireFields(13, "a time, then a 3x4 matrix row by row");
    const double stamp = file.number(0);
    if (poses.empty())
    {
      unit = unitOfDate(stamp);
      if (stamp < first_date)
      {
        file.fail(
            "has 13 fields, of which the first is no time since 1970; without it the poses are "
            "KITTI's, which are paired line by line; with a frame number they are KITTI-360's, "
            "which kitti2rawlog --kind 360 reads");
      }
    }
    const Pose pose = poseFromRow(file, file.numbers(1));
    poses.add(file, unit * stamp, pose.translation(), Eigen::Quaterniond(pose.linear()));
  }
  return poses.take();
}

/** Poses at 0, 1, 2, ... */
Trajectory numbered(const std::vector<Pose>& poses)
{
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    trajectory.push_back(static_cast<double>(i), poses[i]);
  }
  return trajectory;
}
}  // namespace

Trajectory readTum(const std::string& path)
{
  TextFile file(path);
  TimedPoses poses;
  double unit = 1;
  while (file.next())
  {
    file.requireFields(8, "t x y z qx qy qz qw");
    const auto row = file.numbers();
    if (poses.empty())
    {
      unit = unitOfDate(row[0]);
    }
    poses.add(file, unit * row[0], Eigen::Vector3d(row[1], row[2], row[3]),
              Eigen::Quaterniond(row[7], row[4], row[5], row[6]));
  }
  return poses.take();
}

std::string tumLine(double stamp, const Pose& pose)
{
  std::string line;
  appendFixed(line, stamp, 9);
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0)
  {
    q.coeffs() = -q.coeffs();
  }
  const Eigen::Vector3d t = pose.translation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
  {
    line += ' ';
    appendNumber(line, value, digits);
  }
  return line + '\n';
}

void writeTum(const std::string& path, const Trajectory& trajectory)
{
  std::string text;
  for (const auto& [stamp, pose] : trajectory)
  {
    text += tumLine(stamp, pose);
  }
  writeWhole(path, text);
}

std::vector<Pose> readKittiPoses(const std::string& path)
{
  TextFile file(path);
  std::vector<Pose> poses;
  while (file.next())
  {
    file.requireFields(12, "a 3x4 matrix row by row");
    poses.push_back(poseFromRow(file, file.numbers()));
  }
  return poses;
}

void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses)
{
  std::string text;
  for (const Pose& pose : poses)
  {
    for (int i = 0; i < 12; ++i)
    {
      appendNumber(text, pose.matrix()(i / 4, i % 4), digits);
      text += i < 11 ? ' ' : '\n';
    }
  }
  writeWhole(path, text);
}

void writeKittiPoses(const std::string& path, const Trajectory& trajectory)
{
  std::vector<Pose> poses;
  for (const StampedPose& pose : trajectory)
  {
    poses.push_back(pose.pose);
  }
  writeKittiPoses(path, poses);
}

std::vector<double> readTimes(const std::string& path)
{
  TextFile file(path);
  std::vector<double> times;
  while (file.next())
  {
    file.requireFields(1, "a time in seconds; of a table, cut -d, -f2 takes the second column");
    times.push_back(file.number(0));
    if (times.size() > 1 && !(times.back() > times[times.size() - 2]))
    {
      file.fail("the time does not come after that of the line before");
    }
  }
  return times;
}

TrajectoryFile readTrajectory(const std::string& path)
{
  TextFile file(path);
  if (!file.next())
  {
    throw UserError(path + ": holds no poses");
  }
  if (const std::string header = eurocHeader(path); !header.empty())
  {
    return {readEuroc(path, header), TrajectoryFormat::tum};
  }
  if (file.fields().size() == 8)
  {
    return {readTum(path), TrajectoryFormat::tum};
  }
  if (file.fields().size() == 12)
  {
    return {numbered(readKittiPoses(path)), TrajectoryFormat::kitti};
  }
  if (file.fields().size() == 13)
  {
    return {readStampedMatrices(path), TrajectoryFormat::tum};
  }
  file.fail("has " + std::to_string(file.fields().size()) +
            " fields; a trajectory has 8 (TUM: t x y z qx qy qz qw), 12 (KITTI), or EuRoC's header "
            "(#timestamp, ..., q_RS_w, ...)" +
            (isPositionFile(path) ? ". Positions alone are read by dyslam-eval trajectory "
                                    "--reference"
                                  : ""));
}

Pose cameraAxes()
{
  Pose T_cam_velo = Pose::Identity();
  T_cam_velo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return T_cam_velo;
}
}  // namespace dyslam
