// SPDX-License-Identifier: Apache-2.0
#include "sim/state_bytes.hpp"

#include <cstdint>
#include <cstring>
#include <fmt/format.h>

namespace noli {

namespace {

constexpr std::uint64_t kLayout = 1;  // raise when the order below changes

struct Header {
    std::uint64_t layout, num_vertices, num_conditions, steps;
    double kappa;
};

void append(std::vector<std::byte>& out, const void* data, std::size_t bytes) {
    const std::size_t at = out.size();
    out.resize(at + bytes);
    if (bytes > 0) std::memcpy(out.data() + at, data, bytes);
}

void append(std::vector<std::byte>& out, const std::vector<Vec3d>& items) {
    append(out, items.data(), items.size() * sizeof(Vec3d));
}

void take(std::span<const std::byte>& from, void* to, std::size_t bytes) {
    std::memcpy(to, from.data(), bytes);
    from = from.subspan(bytes);
}

}  // namespace

std::vector<std::byte> encode_state(const StepState& state) {
    const Header header{kLayout,
                        state.x.size(),
                        state.ended.size(),
                        static_cast<std::uint64_t>(state.steps),
                        state.kappa};
    std::vector<std::byte> out;
    append(out, &header, sizeof header);
    for (const auto* items : {&state.x, &state.v, &state.a, &state.x_prev, &state.v_prev})
        append(out, *items);
    append(out, state.ended.data(), state.ended.size());
    return out;
}

Result<StepState> decode_state(std::span<const std::byte> bytes,
                               int num_vertices,
                               int num_conditions) {
    const auto bad = [](const std::string& what) {
        return Error{Error::Code::BadCheckpoint,
                     "checkpoint",
                     what + "; it belongs to another scene or version"};
    };
    Header header{};
    if (bytes.size() < sizeof header) return bad("the state is shorter than its header");
    take(bytes, &header, sizeof header);
    if (header.layout != kLayout)
        return bad(
            fmt::format("state layout {} found, {} expected", header.layout, kLayout));
    if (header.num_vertices != static_cast<std::uint64_t>(num_vertices)
        || header.num_conditions != static_cast<std::uint64_t>(num_conditions))
        return bad(fmt::format("{} vertices and {} conditions found, {} and {} expected",
                               header.num_vertices,
                               header.num_conditions,
                               num_vertices,
                               num_conditions));
    const std::size_t n = static_cast<std::size_t>(num_vertices);
    const std::size_t conditions = static_cast<std::size_t>(num_conditions);
    if (bytes.size() != 5 * n * sizeof(Vec3d) + conditions)
        return bad("the state has the wrong length");
    StepState state;
    state.steps = static_cast<int>(header.steps);
    state.kappa = header.kappa;
    for (auto* items : {&state.x, &state.v, &state.a, &state.x_prev, &state.v_prev}) {
        items->resize(n);
        take(bytes, items->data(), n * sizeof(Vec3d));
    }
    state.ended.resize(conditions);
    take(bytes, state.ended.data(), conditions);
    return state;
}

}  // namespace noli
