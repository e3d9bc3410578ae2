// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace dyslam
{
namespace fields
{
/** Converts to any type, to count the initialisers that an aggregate accepts. */
struct Anything
{
  template <typename T>
  operator T() const;  // never called
};

template <typename T, std::size_t... I>
auto madeFrom(std::index_sequence<I...>)
    -> decltype(T{(static_cast<void>(I), Anything{})...}, std::true_type{});
template <typename T, typename Indices>
constexpr auto isMadeFrom(int) -> decltype(madeFrom<T>(Indices{}))
{
  return {};
}
template <typename T, typename Indices>
constexpr std::false_type isMadeFrom(...)
{
  return {};
}

/** Number of fields of an aggregate. */
template <typename T, std::size_t N = 0>
constexpr std::size_t count()
{
  if constexpr (decltype(isMadeFrom<T, std::make_index_sequence<N + 1>>(0))::value)
  {
    return count<T, N + 1>();
  }
  else
  {
    return N;
  }
}
}  // namespace fields

/** Calls `visit` with all fields of an aggregate in their order: none can be forgotten. A type with
 * more than 16 fields, a base or a C array does not compile. */
template <typename T, typename Visit>
void visitFields(T& value, const Visit& visit)
{
  static_assert(std::is_aggregate_v<T>, "give the class a function exchangeState(StateArchive&)");
  constexpr std::size_t count = fields::count<T>();
  static_assert(count > 0, "nothing to visit, or a field of a kind that cannot be counted");
  static_assert(count <= 16, "list the fields in a function exchangeState(StateArchive&)");
#define DYSLAM_VISIT_FIELDS(number, ...) \
  if constexpr (count == (number))       \
  {                                      \
    auto& [__VA_ARGS__] = value;         \
    visit(__VA_ARGS__);                  \
  }
  DYSLAM_VISIT_FIELDS(1, a);
  DYSLAM_VISIT_FIELDS(2, a, b);
  DYSLAM_VISIT_FIELDS(3, a, b, c);
  DYSLAM_VISIT_FIELDS(4, a, b, c, d);
  DYSLAM_VISIT_FIELDS(5, a, b, c, d, e);
  DYSLAM_VISIT_FIELDS(6, a, b, c, d, e, f);
  DYSLAM_VISIT_FIELDS(7, a, b, c, d, e, f, g);
  DYSLAM_VISIT_FIELDS(8, a, b, c, d, e, f, g, h);
  DYSLAM_VISIT_FIELDS(9, a, b, c, d, e, f, g, h, i);
  DYSLAM_VISIT_FIELDS(10, a, b, c, d, e, f, g, h, i, j);
  DYSLAM_VISIT_FIELDS(11, a, b, c, d, e, f, g, h, i, j, k);
  DYSLAM_VISIT_FIELDS(12, a, b, c, d, e, f, g, h, i, j, k, l);
  DYSLAM_VISIT_FIELDS(13, a, b, c, d, e, f, g, h, i, j, k, l, m);
  DYSLAM_VISIT_FIELDS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  DYSLAM_VISIT_FIELDS(15, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  DYSLAM_VISIT_FIELDS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
#undef DYSLAM_VISIT_FIELDS
}
}  // namespace dyslam
