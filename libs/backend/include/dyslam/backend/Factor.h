// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Key.h>
#include <dyslam/core/Pose.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** The kinds of factor of the paper's Fig. 6, positions of a satellite receiver, gravity, and
 * localisation in a prior map. */
enum class FactorKind : std::uint8_t
{
  odometry,       //!< f, Eq. 6: motion between two keyframes
  loop,           //!< h, Eq. 7: motion between two keyframes at one place
  observation,    //!< z, Eq. 8: an object seen from a keyframe
  object_motion,  //!< m, Eq. 9: two poses of an object and its velocity in between
  smooth_motion,  //!< o, Eq. 10: two successive velocities of an object
  gnss,           //!< a position of the vehicle on the earth
  gravity,        //!< gravity measured at a keyframe
  localisation,   //!< a keyframe registered to the prior map
};
[[nodiscard]] std::string toString(FactorKind kind);

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

/** A residual of six numbers between two or three variables, whitened with its information matrix.
 *
 * Poses are perturbed on the right, T exp(x), x = [translation, rotation]; velocities by addition.
 * Factors are constant after construction.
 */
class Factor
{
 public:
  /** \param information information matrix of the residual, inverse squares of its units
   *  \throws std::invalid_argument, naming the keys, unless it is finite, symmetric and positive
   *  definite and the keys differ. */
  Factor(std::vector<Key> keys, const Matrix6& information);
  virtual ~Factor() = default;
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  [[nodiscard]] virtual FactorKind kind() const = 0;
  /** Residual before whitening. \param jacobians filled for the factor's keys unless null */
  [[nodiscard]] virtual Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const = 0;
  /** whitening() * residual(), in units of standard deviations. */
  [[nodiscard]] Vector6 whitenedResidual(ValueBlocks blocks) const;
  /** Measured pose, for export; the identity for factors without one. */
  [[nodiscard]] virtual Pose measurement() const { return Pose::Identity(); }

  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }
  /** Upper triangular W with information = W' W. */
  [[nodiscard]] const Matrix6& whitening() const { return whitening_; }
  [[nodiscard]] const Matrix6& information() const { return information_; }

 private:
  std::vector<Key> keys_;
  Matrix6 information_;
  Matrix6 whitening_;
};

/** Converts a pose to its block of pose_block_size numbers, see ValueBlocks, and back. */
void packPose(const Pose& pose, double* block);
[[nodiscard]] Pose unpackPose(const double* block);
}  // namespace dyslam
