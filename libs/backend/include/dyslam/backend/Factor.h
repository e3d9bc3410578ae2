// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Key.h>
#include <dyslam/core/Pose.h>

#include <array>
#include <cstddef>
#include <vector>

namespace dyslam
{
struct FactorData;
struct FactorGraphOptions;
struct FactorLoss;
struct FactorType;

/** Values of the variables of a factor as contiguous blocks, in the order of its keys.
 *
 * A pose is translation, then quaternion x y z w (7 numbers); a velocity is a twist
 * [translation m/s, rotation rad/s] in the object's frame (6 numbers); a bias has six, too.
 */
using ValueBlocks = const double* const*;
constexpr int pose_block_size = 7;
constexpr int velocity_block_size = 6;

/** Derivatives of a residual by the tangents of the variables, one per key. */
constexpr std::size_t max_keys_per_factor = 3;
using FactorJacobians = std::array<Matrix6, max_keys_per_factor>;

/** A residual between one to three variables, whitened with its information matrix. A type of
 * factor is a class derived from this one, with its FactorType in the table of
 * src/factors/FactorTypes.cpp.
 *
 * A residual has six numbers; if the type's dimension is less, the last ones and their derivatives
 * are zero and not part of the problem that is solved.
 * Poses are perturbed on the right, T exp(x), x = [translation, rotation]; velocities by addition.
 * Factors are constant after construction.
 */
class Factor
{
 public:
  /** \param type row of the derived class; outlives the factor
   *  \param keys 1 to max_keys_per_factor
   *  \param information information matrix of the residual, inverse squares of its units; only its
   *  first rows and columns count if the type's dimension is below six
   *  \throws std::invalid_argument, naming the keys, unless it is finite, symmetric and positive
   *  definite and the keys differ, and for a wrong number of keys. */
  Factor(const FactorType& type, std::vector<Key> keys, const Matrix6& information);
  virtual ~Factor() = default;
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  [[nodiscard]] const FactorType& type() const { return type_; }
  /** Whether this is a factor of class T. */
  template <typename T>
  [[nodiscard]] bool is() const
  {
    return &type_ == &T::factor_type;
  }
  /** Residual before whitening. \param jacobians filled for the factor's keys unless null */
  [[nodiscard]] virtual Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const = 0;
  /** whitening() * residual(), in units of standard deviations. */
  [[nodiscard]] Vector6 whitenedResidual(ValueBlocks blocks) const;
  /** Measured pose, for export; the identity for factors without one. */
  [[nodiscard]] virtual Pose measurement() const { return Pose::Identity(); }
  /** Robust loss by the options of the graph; without override none. */
  [[nodiscard]] virtual FactorLoss loss(const FactorGraphOptions& options) const;
  /** All data of the factor, of which FactorType::make() makes it again. Without override: keys,
   * measurement and information. */
  [[nodiscard]] virtual FactorData data() const;

  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }
  /** Upper triangular W with information = W' W. */
  [[nodiscard]] const Matrix6& whitening() const { return whitening_; }
  /** Beyond the type's dimension: the identity. */
  [[nodiscard]] const Matrix6& information() const { return information_; }

 private:
  const FactorType& type_;
  std::vector<Key> keys_;
  Matrix6 information_;
  Matrix6 whitening_;
};

/** Converts a pose to its block of pose_block_size numbers, see ValueBlocks, and back. */
void packPose(const Pose& pose, double* block);
[[nodiscard]] Pose unpackPose(const double* block);
}  // namespace dyslam
