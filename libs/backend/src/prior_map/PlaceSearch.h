// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
/** A place in a map that looks like given points, seen from above. */
struct SimilarPlace
{
  double x = 0;        //!< position of the points' origin in the map [m]
  double y = 0;        //!< [m]
  double heading = 0;  //!< of the points' frame in the map [rad]
  double score = 0;    //!< fraction of the upright structure that coincides, 0 to 1
};

/** Where in a map a place is searched for: in a square about a position, frame of the map. */
struct SearchArea
{
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  //!< [m]
  double radius = 0;                                 //!< half the side of the square [m]
};

/** Finds the places of a map that points may have been measured at, without any initial guess.
 *
 * Map and points are reduced to the cells of a horizontal grid that have upright structure (walls,
 * trunks, poles). The number of coinciding cells is maximised over all positions and headings by
 * branch and bound on grids of maxima (W. Hess et al.: Real-Time Loop Closure in 2D LIDAR SLAM,
 * ICRA 2016), best first. Deterministic.
 */
class PlaceSearch
{
 public:
  /** \param map frame of the map, z about vertical [m] */
  explicit PlaceSearch(const std::vector<Eigen::Vector3f>& map);

  /** The most similar places, best first, each some metres or degrees from the others.
   * \param points z about vertical [m] \param area none: the whole map, about as far as it has
   * points */
  [[nodiscard]] std::vector<SimilarPlace> find(const std::vector<Eigen::Vector3f>& points,
                                               const std::optional<SearchArea>& area = {}) const;

 private:
  static constexpr int levels = 6;
  using Cells = std::vector<Eigen::Vector2i>;
  /** Positions of the origin in [x, x + 2^level) and [y, y + 2^level), in cells. */
  struct Node
  {
    int score = 0;  //!< upper bound for these positions
    int level = 0;
    int heading = 0;
    int x = 0;
    int y = 0;
    /** Order of the search: by score, then leaves, then a fixed order. */
    [[nodiscard]] bool operator<(const Node& other) const;
  };

  /** Cells of the positions that are searched, without those of `end`. */
  struct Range
  {
    Eigen::Vector2i begin;
    Eigen::Vector2i end;
  };

  /** Fills the grids of all levels. \param occupied cells of the map with upright structure */
  void drawStructure(const Cells& occupied);
  [[nodiscard]] Range rangeOf(const std::optional<SearchArea>& area) const;
  /** The most similar positions and headings. \param turned the points' cells at each heading */
  [[nodiscard]] std::vector<Node> bestLeaves(const std::vector<Cells>& turned,
                                             const Range& range) const;
  /** Upper bound of the score of a Node's positions; at level 0 the score. \param cells the points'
   * at the node's heading, from their origin */
  [[nodiscard]] int bound(const Cells& cells, int level, int x, int y) const;
  /** Value of a grid, beyond its borders, too. */
  [[nodiscard]] std::uint8_t at(int level, int x, int y) const;
  /** \param leaf of level 0 \param cells number of cells of the points */
  [[nodiscard]] SimilarPlace placeOf(const Node& leaf, std::size_t cells) const;

  double cell_size_ = 1;                              //!< [m]
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  //!< corner of cell (0, 0), map frame [m]
  int width_ = 0;
  int height_ = 0;
  /** Per level, the maximum of the cells [x, x + 2^level) and [y, y + 2^level): 2 structure, 1
   * beside it. */
  std::array<std::vector<std::uint8_t>, levels> grids_;
};
}  // namespace dyslam
