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

constexpr std::size_t most = 27;

/** Number of fields of an aggregate, at most `most`. */
template <typename T, std::size_t N = most>
constexpr std::size_t count()
{
  if constexpr (N == 0 || decltype(isMadeFrom<T, std::make_index_sequence<N>>(0))::value)
  {
    return N;
  }
  else
  {
    return count<T, N - 1>();
  }
}
}  // namespace fields

/** Calls `visit` once with all fields of an aggregate, in the order of their declaration. A type
 * with more than 27 fields, a base class or a C array does not compile. */
template <typename T, typename Visit>
void visitFields(T& value, const Visit& visit)
{
  static_assert(std::is_aggregate_v<T>, "give the class a function exchangeState(StateArchive&)");
  constexpr std::size_t count = fields::count<T>();
  static_assert(count > 0, "nothing to visit, or a field of a kind that cannot be counted");
  if constexpr (count == 1)
  {
    auto& [f1] = value;
    visit(f1);
  }
  else if constexpr (count == 2)
  {
    auto& [f1, f2] = value;
    visit(f1, f2);
  }
  else if constexpr (count == 3)
  {
    auto& [f1, f2, f3] = value;
    visit(f1, f2, f3);
  }
  else if constexpr (count == 4)
  {
    auto& [f1, f2, f3, f4] = value;
    visit(f1, f2, f3, f4);
  }
  else if constexpr (count == 5)
  {
    auto& [f1, f2, f3, f4, f5] = value;
    visit(f1, f2, f3, f4, f5);
  }
  else if constexpr (count == 6)
  {
    auto& [f1, f2, f3, f4, f5, f6] = value;
    visit(f1, f2, f3, f4, f5, f6);
  }
  else if constexpr (count == 7)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7] = value;
    visit(f1, f2, f3, f4, f5, f6, f7);
  }
  else if constexpr (count == 8)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8);
  }
  else if constexpr (count == 9)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9);
  }
  else if constexpr (count == 10)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10);
  }
  else if constexpr (count == 11)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11);
  }
  else if constexpr (count == 12)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12);
  }
  else if constexpr (count == 13)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13);
  }
  else if constexpr (count == 14)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14);
  }
  else if constexpr (count == 15)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15);
  }
  else if constexpr (count == 16)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16);
  }
  else if constexpr (count == 17)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17);
  }
  else if constexpr (count == 18)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18);
  }
  else if constexpr (count == 19)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19] =
        value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19);
  }
  else if constexpr (count == 20)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
          f20);
  }
  else if constexpr (count == 21)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21);
  }
  else if constexpr (count == 22)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22);
  }
  else if constexpr (count == 23)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22, f23] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22, f23);
  }
  else if constexpr (count == 24)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22, f23, f24] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22, f23, f24);
  }
  else if constexpr (count == 25)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22, f23, f24, f25] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22, f23, f24, f25);
  }
  else if constexpr (count == 26)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22, f23, f24, f25, f26] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22, f23, f24, f25, f26);
  }
  else if constexpr (count == 27)
  {
    auto& [f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19,
           f20, f21, f22, f23, f24, f25, f26, f27] = value;
    visit(f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17, f18, f19, f20,
          f21, f22, f23, f24, f25, f26, f27);
  }
}
}  // namespace dyslam
