// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <variant>

namespace noli {

/// What went wrong, where the user can fix it, and what would fix it.
struct Error {
    enum class Code {
        InvalidScene,     ///< a scene file says something impossible
        FileNotReadable,  ///< missing, unreadable, truncated or not of its format
        FileNotWritable,  ///< output: no permission, disk full
        BadMesh,          ///< a mesh that cannot be simulated
        InitialContact,   ///< bodies intersect or touch before the first step
        NoDevice,         ///< a device was asked for that is not there
        BadCheckpoint,    ///< a checkpoint that does not fit the scene or is damaged
        Unsupported,      ///< a feature that this build or version does not have
        RunDirectory,     ///< an output directory that holds something else
    };
    Code code;
    std::string where;    ///< "scenes/drop.json:/bodies/2/mesh" or a file:line
    std::string message;  ///< one sentence: what was found, what was expected, a cure
};

/// A value or an Error; std::expected's shape until the tree moves to C++23.
template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::move(value)) {}      // NOLINT: implicit on purpose
    Result(Error error) : state_(std::move(error)) {}  // NOLINT: implicit on purpose

    explicit operator bool() const { return state_.index() == 0; }
    T& value() { return std::get<0>(state_); }
    [[nodiscard]] const T& value() const { return std::get<0>(state_); }
    [[nodiscard]] const Error& error() const { return std::get<1>(state_); }

  private:
    std::variant<T, Error> state_;
};

/// A Result without a value.
struct Done {};
using Status = Result<Done>;

}  // namespace noli
