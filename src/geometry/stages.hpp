// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is done where doubles do not suffice.
///
/// An exact stage takes every register and kilobytes of stack, and next to no pair needs
/// one. Called from the middle of a computation it makes the compiler save what lives
/// across the call, for every pair. So a loop's body is computed in doubles as a whole
/// (InDoubles), which only notes that they did not suffice; then the whole body is done
/// again with exact stages (Exactly): at once, out of line, or by another loop. Where
/// doubles suffice both give the same bits.

#include "core/device.hpp"

#include <cstdint>
#include <type_traits>

namespace noli {

/// Exact stages are computed.
struct Exactly {
    /// What was computed holds.
    [[nodiscard]] NOLI_HD static constexpr bool enough() { return true; }

    /// What is right where `rough` may not be.
    template <class T, class F>
    [[nodiscard]] NOLI_HD T refined(const T& /*rough*/, F exact) const {
        return exact();
    }
};

/// Exact stages are left out: from the first one on nothing that is computed holds.
class InDoubles {
  public:
    [[nodiscard]] NOLI_HD bool enough() const { return enough_; }

    template <class T, class F>
    [[nodiscard]] NOLI_HD T refined(const T& rough, F /*exact*/) {
        enough_ = false;
        return rough;
    }

  private:
    bool enough_ = true;
};

/// How a loop treats the pairs for which doubles do not suffice.
///
/// First  each at once, exactly.
/// Only   not: the body leaves a mark, and who finds one repeats the loop with First. A
///        GPU then runs a kernel that is free of exact stages, with far fewer registers
///        and a tenth of the stack.
enum class Doubles : std::uint8_t { First, Only };

namespace detail {

/// Out of line, and by value: as a reference `body` would live in memory for every pair.
template <class Body>
[[gnu::noinline]] NOLI_HD auto exactly(Body body) {
    Exactly stage;
    return body(stage);
}

}  // namespace detail

/// body(stage), in doubles; where they do not suffice, what `How` says. What the first
/// run writes must be what a second one overwrites.
template <Doubles How, class Body>
NOLI_HD inline auto evaluate(const Body& body) {
    InDoubles stage;
    if constexpr (How == Doubles::Only) {
        return body(stage);
    } else if constexpr (std::is_void_v<decltype(body(stage))>) {
        body(stage);
        if (!stage.enough()) detail::exactly(body);
    } else {
        const auto result = body(stage);
        return stage.enough() ? result : detail::exactly(body);
    }
}

/// f(how) with `how` a constant. Only a device has loops of its own for Only.
template <class Exec, class F>
auto with_constant(Doubles how, F f) {
    using First = std::integral_constant<Doubles, Doubles::First>;
    using Only = std::integral_constant<Doubles, Doubles::Only>;
    if constexpr (Exec::kIsDevice)
        if (how == Doubles::Only) return f(Only{});
    return f(First{});
}

}  // namespace noli
