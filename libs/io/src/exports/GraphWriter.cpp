// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/PendingFile.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/mrpt/Conversions.h>

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <string>

#include "RollYaw.h"

namespace dyslam
{
namespace
{
using Graph = mrpt::graphs::CNetworkOfPoses3DInf;
using mrpt::graphs::TNodeID;

/** Collects the text in memory and writes it at once; numbers keep all their digits. */
class TextWriter
{
 public:
  TextWriter& operator<<(double value)
  {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    text_.append(" ").append(buffer.data(), end);
    return *this;
  }
  TextWriter& operator<<(TNodeID id)
  {
    text_.append(" ").append(std::to_string(id));
    return *this;
  }
  TextWriter& operator<<(const char* word)
  {
    text_.append(word);
    return *this;
  }
  TextWriter& operator<<(const Matrix6& m)
  {
    for (Eigen::Index r = 0; r < 6; ++r)
    {
      for (Eigen::Index c = r; c < 6; ++c)
      {
        *this << m(r, c);
      }
    }
    return *this;
  }
  void save(const std::string& path) const { writeWhole(path, text_); }

 private:
  std::string text_;
};

void appendRollPitchYawPose(TextWriter& out, const mrpt::poses::CPose3D& pose)
{
  out << pose.x() << pose.y() << pose.z() << pose.roll() << pose.pitch() << pose.yaw();
}

void appendQuaternionPose(TextWriter& out, const mrpt::poses::CPose3D& pose)
{
  Eigen::Quaterniond q(toPose(pose).linear());
  if (q.w() < 0)
  {
    q.coeffs() = -q.coeffs();
  }
  out << pose.x() << pose.y() << pose.z() << q.x() << q.y() << q.z() << q.w();
}
}  // namespace

void writeGraph(const Graph& graph, const std::string& path)
{
  TextWriter out;
  for (const auto& [id, pose] : graph.nodes)
  {
    out << "VERTEX3" << id;
    appendRollPitchYawPose(out, pose);
    out << "\n";
    if (id == graph.root)
    {
      out << "FIX" << id << "\n";
    }
  }
  for (const auto& [ids, edge] : graph.edges)
  {
    out << "EDGE3" << ids.first << ids.second;
    appendRollPitchYawPose(out, edge.mean);
    out << swappedRollYaw(edge.cov_inv.asEigen()) << "\n";
  }
  out.save(path);
}

void writeG2o(const Graph& graph, const std::string& path)
{
  TextWriter out;
  for (const auto& [id, pose] : graph.nodes)
  {
    out << "VERTEX_SE3:QUAT" << id;
    appendQuaternionPose(out, pose);
    out << "\n";
    if (id == graph.root)
    {
      out << "FIX" << id << "\n";
    }
  }
  for (const auto& [ids, edge] : graph.edges)
  {
    out << "EDGE_SE3:QUAT" << ids.first << ids.second;
    appendQuaternionPose(out, edge.mean);
    const Matrix6 information = informationFromYpr(toPose(edge.mean), edge.cov_inv.asEigen());
    out << informationToQuaternion(information) << "\n";
  }
  out.save(path);
}
}  // namespace dyslam
