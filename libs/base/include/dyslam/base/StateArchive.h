// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Fields.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

namespace state
{
template <typename T, typename = void>
struct HasOwn : std::false_type
{
};
template <typename T>
struct HasOwn<
    T,
    std::void_t<decltype(std::declval<T&>().exchangeState(std::declval<StateArchive&>()))>>
    : std::true_type
{
};

/** Types whose bytes are their value, without padding. */
template <typename T>
struct IsPlain
    : std::bool_constant<(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) || std::is_enum_v<T>>
{
};
template <typename Scalar, int Rows, int Cols, int Options, int MaxRows, int MaxCols>
struct IsPlain<Eigen::Matrix<Scalar, Rows, Cols, Options, MaxRows, MaxCols>>
    : std::bool_constant<Rows != Eigen::Dynamic && Cols != Eigen::Dynamic &&
                         sizeof(Eigen::Matrix<Scalar, Rows, Cols, Options, MaxRows, MaxCols>) ==
                             sizeof(Scalar) * static_cast<std::size_t>(Rows) *
                                 static_cast<std::size_t>(Cols)>
{
};
template <typename T, std::size_t N>
struct IsPlain<std::array<T, N>> : IsPlain<T>
{
};
}  // namespace state

/** Serialises the state of objects, so that a run can be resumed in another process.
 *
 * One function serves both directions: a class has `void exchangeState(StateArchive&)`, which
 * passes its members to the archive. Aggregates, containers, Eigen's types and numbers need none.
 * Options are not part of a state: the object that loads is constructed with the same options.
 * Numbers are stored in the byte order of this machine; StateFile guards the bytes against damage.
 */
class StateArchive
{
 public:
  /** Function that receives the saved bytes, piece by piece. */
  using Sink = std::function<void(std::string_view)>;
  /** Function that reads the next saved bytes; false if they cannot be read. */
  using Source = std::function<bool(void*, std::size_t)>;

  /** Saves to bytes(). */
  StateArchive() = default;
  /** Saves to a sink, with a small buffer; flush() passes on its rest. */
  explicit StateArchive(Sink sink) : sink_(std::move(sink)) {}
  /** Loads from bytes. \param bytes must outlive the archive. */
  explicit StateArchive(std::string_view bytes);
  /** Loads from a source. \param size number of bytes in the source */
  StateArchive(Source source, std::uint64_t size);

  [[nodiscard]] bool isLoading() const { return source_ != nullptr; }
  /** Saved bytes that were not passed to a sink yet. */
  [[nodiscard]] const std::string& bytes() const { return saved_; }
  void flush();

  /** Saves the values, or sets them to the saved ones. \throws UserError for bytes that end early
   * or are invalid; never allocates more elements than there are bytes. */
  template <typename... T>
  void operator()(T&... values)
  {
    (exchange(values), ...);
  }
  /** \throws UserError unless all bytes have been loaded. */
  void requireEnd() const;

  /** \throws UserError: the bytes are not those of a state. */
  [[noreturn]] static void fail();

 private:
  void raw(void* data, std::size_t size);
  /** Number of elements; when loading, not more than there are bytes for. */
  [[nodiscard]] std::size_t count(std::size_t size, std::size_t bytes_each);

  template <typename T>
  void exchange(T& value)
  {
    if constexpr (state::IsPlain<T>::value)
    {
      raw(&value, sizeof value);
    }
    else if constexpr (state::HasOwn<T>::value)
    {
      value.exchangeState(*this);
    }
    else
    {
      visitFields(value, [this](auto&... each) { (exchange(each), ...); });
    }
  }

  void exchange(bool& value);
  void exchange(std::string& value);
  void exchange(std::vector<bool>& values);
  template <typename Scalar, int Dim, int Mode, int Options>
  void exchange(Eigen::Transform<Scalar, Dim, Mode, Options>& value)
  {
    exchange(value.matrix());
  }
  template <typename Scalar, int Options>
  void exchange(Eigen::Quaternion<Scalar, Options>& value)
  {
    exchange(value.coeffs());
  }
  template <typename Scalar, int Rows, int Cols, int Options, int MaxRows, int MaxCols>
  void exchange(Eigen::Matrix<Scalar, Rows, Cols, Options, MaxRows, MaxCols>& value)
  {
    static_assert(Rows != Eigen::Dynamic && Cols != Eigen::Dynamic);
    raw(value.data(), sizeof(Scalar) * static_cast<std::size_t>(Rows * Cols));
  }
  template <typename T, std::size_t N>
  void exchange(std::array<T, N>& values)
  {
    if constexpr (state::IsPlain<T>::value)
    {
      raw(values.data(), sizeof(T) * N);
    }
    else
    {
      for (T& value : values)
      {
        exchange(value);
      }
    }
  }
  template <typename T>
  void exchange(std::vector<T>& values)
  {
    if constexpr (state::IsPlain<T>::value)
    {
      values.resize(count(values.size(), sizeof(T)));
      raw(values.data(), sizeof(T) * values.size());
    }
    else
    {
      exchangeEach(values);
    }
  }
  template <typename T>
  void exchange(std::deque<T>& values)
  {
    exchangeEach(values);
  }
  template <typename T>
  void exchange(std::optional<T>& value)
  {
    bool is_there = value.has_value();
    exchange(is_there);
    if (isLoading())
    {
      value.reset();
      if (is_there)
      {
        value.emplace();
      }
    }
    if (is_there)
    {
      exchange(*value);
    }
  }
  template <typename A, typename B>
  void exchange(std::pair<A, B>& value)
  {
    exchange(value.first);
    exchange(value.second);
  }
  template <typename Key, typename T, typename Less, typename Allocator>
  void exchange(std::map<Key, T, Less, Allocator>& values)
  {
    const std::size_t size = count(values.size(), 1);
    if (!isLoading())
    {
      for (auto& [key, value] : values)
      {
        auto copy = key;
        exchange(copy);
        exchange(value);
      }
      return;
    }
    values.clear();
    for (std::size_t i = 0; i < size; ++i)
    {
      Key key{};
      exchange(key);
      exchange(values[key]);
    }
  }
  template <typename T>
  void exchange(std::set<T>& values)
  {
    std::vector<T> all(values.begin(), values.end());
    exchange(all);
    values = std::set<T>(all.begin(), all.end());
  }

  template <typename Sequence>
  void exchangeEach(Sequence& values)
  {
    const std::size_t size = count(values.size(), 1);
    if (isLoading())
    {
      values.clear();
    }
    for (std::size_t i = 0; i < size; ++i)
    {
      if (isLoading())
      {
        values.emplace_back();
      }
      exchange(values[i]);
    }
  }

  Sink sink_;
  std::string saved_;
  Source source_;           //!< null: the archive saves
  std::uint64_t left_ = 0;  //!< number of bytes still to be loaded
};
}  // namespace dyslam
