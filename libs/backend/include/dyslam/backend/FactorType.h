// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>
#include <dyslam/backend/FactorGraphOptions.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Robust loss of a factor. */
struct FactorLoss
{
  RobustLoss loss = RobustLoss::none;
  double width = 0;  //!< as a whitened residual
  /** Whether the factor has the loss of loops, which is narrowed step by step to its width, since
   * its place may only look alike. */
  bool is_place = false;
};

/** A factor of any type as plain data, for files and checkpoints; no factor if it has no keys. */
struct FactorData
{
  std::vector<Key> keys;
  Pose measurement = Pose::Identity();
  /** Numbers that are not in `measurement`, at positions that the type chooses once, since
   * checkpoints contain them. */
  std::array<double, 7> further{};
  Matrix6 information = Matrix6::Zero();
};

/** The fields of a factor's line in factor_graph.txt, one after the other. One function serves both
 * directions: when the line is written, the values are; when it is read, they are set. */
class FactorFields
{
 public:
  virtual ~FactorFields() = default;
  virtual void object(std::int64_t& id) = 0;
  /** Index of a keyframe or scan, 0 or more. */
  virtual void index(std::int64_t& index) = 0;
  virtual void key(Key& key) = 0;
  virtual void number(double& value) = 0;
  /** A 3x4 matrix by rows. */
  virtual void pose(Pose& pose) = 0;
  /** Three numbers. */
  void vector(double* values);
};

/** What distinguishes one type of factor from the others, besides its class: one row of the table
 * of types. */
struct FactorType
{
  const char* name;           //!< in messages and figures
  const char* line;           //!< first word of its line in factor_graph.txt
  const char* left_out_line;  //!< the same if it is left out; null: it cannot be left out
  int dimension;              //!< numbers of the residual, 1 to 6
  /** Writes or reads the fields between the first word and the information. Keys that are read may
   * be incomplete: `make` completes them. */
  void (*exchangeFields)(FactorData& data, FactorFields& fields);
  /** \throws std::logic_error for data that are no such factor. */
  std::unique_ptr<const Factor> (*make)(const FactorData& data);
};

/** The types of factor that a graph knows. Constant after construction. */
class FactorTypes
{
 public:
  /** The types of DySLAM, then further ones. \param further must outlive the graphs that use them
   * \throws std::invalid_argument for a word of a line that is taken, or a dimension out of range.
   */
  explicit FactorTypes(const std::vector<const FactorType*>& further = {});

  /** Type of a line that starts with this word; null if there is none. */
  [[nodiscard]] const FactorType* find(std::string_view line) const;
  [[nodiscard]] bool contains(const FactorType& type) const;
  /** Number of a type in checkpoints. \throws std::invalid_argument for an unknown type. */
  [[nodiscard]] std::uint8_t numberOf(const FactorType& type) const;
  /** Factor of a type and its data; null for data without keys.
   * \throws UserError for an unknown number and for data that are no such factor. */
  [[nodiscard]] std::unique_ptr<const Factor> make(std::uint8_t number,
                                                   const FactorData& data) const;

 private:
  std::vector<const FactorType*> rows_;
};
}  // namespace dyslam
