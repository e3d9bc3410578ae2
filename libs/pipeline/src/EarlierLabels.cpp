// SPDX-License-Identifier: BSD-3-Clause
#include "EarlierLabels.h"

#include <dyslam/core/Error.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TextFile.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
constexpr float probability = 0.999F;  // that a point moves that was labelled so

/** \return empty for no folder \throws UserError for one without labels */
std::string requireLabels(const std::string& folder)
{
  const auto labels = labelFolderOf(folder);
  if (!labels && !folder.empty())
  {
    throw UserError(folder + ": has no labels (dyseg.labels); run dyslam --labels first");
  }
  return labels.value_or("");
}

/** Values of the points with the given indices; empty for no values. */
template <typename Values>
Values selected(const Values& values, const std::vector<std::size_t>& indices)
{
  Values result;
  if (!values.empty())
  {
    result.reserve(indices.size());
    for (const std::size_t i : indices)
    {
      result.push_back(values[i]);
    }
  }
  return result;
}

/** Makes values of some points values of all points. Leaves values as they are that the points do
 * not have. \param kept number of points so far \param index_of_point index of each point among
 * them; none for a new point, which gets `value` */
void spread(std::size_t kept,
            const std::vector<std::optional<std::size_t>>& index_of_point,
            float value,
            std::vector<float>& values)
{
  if (values.size() == kept)
  {
    std::vector<float> all;
    all.reserve(index_of_point.size());
    for (const std::optional<std::size_t>& index : index_of_point)
    {
      all.push_back(index ? values[*index] : value);
    }
    values = std::move(all);
  }
}
}  // namespace

EarlierLabels::EarlierLabels(const std::string& folder) : folder_(requireLabels(folder)) {}

Scan EarlierLabels::takeMoving(Frame& frame) const
{
  if (folder_.empty())
  {
    return {};
  }
  std::vector<Eigen::Vector3f>& points = frame.scan.points;
  const std::vector<Label> labels =
      readLabels(numberedPath(folder_, frame.index, ".label"), points.size());
  Scan taken = frame.scan;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    (isMovingLabel(labels[i]) ? points[i] : taken.points[i]).setZero();
  }
  return taken;
}

void putBackMoving(const Scan& moving,
                   const std::function<Cloud(const Scan&)>& prepare,
                   Frame& frame)
{
  for (std::size_t i = 0; i < moving.size(); ++i)
  {
    if (isReturn(moving.points[i]))
    {
      frame.scan.points[i] = moving.points[i];
    }
  }
  // The times of points that have none are known from the order of all points of the scan only.
  const Cloud all = prepare(frame.scan);
  std::vector<std::optional<std::size_t>> index_of_return(frame.scan.size());
  for (std::size_t k = 0; k < frame.cloud.size(); ++k)
  {
    index_of_return[frame.cloud.source[k]] = k;
  }
  std::vector<std::size_t> chosen;                         // points of `all`
  std::vector<std::optional<std::size_t>> index_of_point;  // in the cloud so far; none: moving
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const std::uint32_t source = all.source[i];
    const bool is_moving = isReturn(moving.points[source]);
    if (is_moving || index_of_return[source])
    {
      chosen.push_back(i);
      index_of_point.push_back(is_moving ? std::nullopt : index_of_return[source]);
    }
  }
  const std::size_t kept = frame.cloud.size();
  spread(kept, index_of_point, probability, frame.moving_probability);
  spread(kept, index_of_point, 1 - probability, frame.static_prior);
  spread(kept, index_of_point, 1 - probability, frame.static_confidence);
  frame.cloud.points = selected(all.points, chosen);
  frame.cloud.intensity = selected(all.intensity, chosen);
  frame.cloud.phase = selected(all.phase, chosen);
  frame.cloud.source = selected(all.source, chosen);
  frame.cloud.T_sweep = all.T_sweep;
  frame.cloud.phase_unit = all.phase_unit;
}
}  // namespace dyslam
