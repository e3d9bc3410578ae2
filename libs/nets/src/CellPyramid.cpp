// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/CellPyramid.h>

namespace dyslam
{
namespace
{
std::size_t index(std::int32_t i)
{
  return static_cast<std::size_t>(i);
}

/** Occupied cells at full resolution, from the points sorted by cell. */
CellLevel finestLevel(const BevScan& scan)
{
  CellLevel level;
  level.width = scan.cells;
  level.row_of_cell.assign(index(level.width) * index(level.width), -1);
  level.row_of_point.reserve(scan.size());
  for (const auto c : scan.cell)
  {
    if (level.number.empty() || level.number.back() != c)
    {
      level.row_of_cell[index(c)] = static_cast<std::int32_t>(level.number.size());
      level.number.push_back(c);
    }
    level.row_of_point.push_back(level.row_of_cell[index(c)]);
  }
  return level;
}

/** Occupied cells at half the resolution of `fine`. */
CellLevel coarsened(const CellLevel& fine)
{
  CellLevel level;
  level.width = fine.width / 2;
  level.row_of_cell.assign(index(level.width) * index(level.width), -1);
  const auto parent = [&](std::int32_t n)
  { return n / fine.width / 2 * level.width + n % fine.width / 2; };
  for (const auto n : fine.number)
  {
    level.row_of_cell[index(parent(n))] = 0;
  }
  for (std::size_t c = 0; c < level.row_of_cell.size(); ++c)
  {
    if (level.row_of_cell[c] == 0)
    {
      level.row_of_cell[c] = static_cast<std::int32_t>(level.number.size());
      level.number.push_back(static_cast<std::int32_t>(c));
    }
  }
  level.row_of_point.reserve(fine.row_of_point.size());
  for (const auto r : fine.row_of_point)
  {
    level.row_of_point.push_back(level.row_of_cell[index(parent(fine.number[index(r)]))]);
  }
  return level;
}

/** Rows of the cells of `in` from (first, first) to (last, last) around each cell of `out`. */
std::vector<std::int32_t> rowsAround(const CellLevel& in, const CellLevel& out, int first, int last)
{
  const int stride = in.width / out.width;
  std::vector<std::int32_t> rows;
  rows.reserve(out.size() * index((last - first + 1) * (last - first + 1)));
  for (const auto n : out.number)
  {
    const int cx = n % out.width * stride;
    const int cy = n / out.width * stride;
    for (int y = cy + first; y <= cy + last; ++y)
    {
      for (int x = cx + first; x <= cx + last; ++x)
      {
        const bool inside = x >= 0 && y >= 0 && x < in.width && y < in.width;
        rows.push_back(inside ? in.row_of_cell[index(y * in.width + x)] : -1);
      }
    }
  }
  return rows;
}
}  // namespace

CellPyramid::CellPyramid(const BevScan& scan)
    : full(finestLevel(scan)),
      half(coarsened(full)),
      quarter(coarsened(half)),
      eighth(coarsened(quarter))
{
}

std::vector<std::int32_t> convolutionRows(const CellLevel& in, const CellLevel& out)
{
  return rowsAround(in, out, -1, 1);
}

std::vector<std::int32_t> childRows(const CellLevel& in, const CellLevel& out)
{
  return rowsAround(in, out, 0, 1);
}

std::vector<std::int32_t> parentRows(const CellLevel& in, const CellLevel& out)
{
  std::vector<std::int32_t> rows;
  rows.reserve(in.size());
  for (const auto n : in.number)
  {
    const int x = n % in.width / 2;
    const int y = n / in.width / 2;
    rows.push_back(out.row_of_cell[index(y * out.width + x)]);
  }
  return rows;
}

std::vector<Eigen::Vector2f> cellCentres(const CellLevel& level, const BevScan& scan)
{
  const float size = scan.cell_size * static_cast<float>(scan.cells / level.width);
  std::vector<Eigen::Vector2f> centres;
  centres.reserve(level.size());
  for (const auto n : level.number)
  {
    const Eigen::Vector2f cell(static_cast<float>(n % level.width),
                               static_cast<float>(n / level.width));
    centres.push_back(scan.corner + size * (cell + Eigen::Vector2f::Constant(0.5F)));
  }
  return centres;
}
}  // namespace dyslam
