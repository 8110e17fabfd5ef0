// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Checkpoints: the complete state of a simulation at one step, as opaque bytes in a
/// container that proves itself whole. Layout, little-endian, no padding:
///
///     offset  bytes  what
///          0      8  magic "NOLICKPT"
///          8      4  version of this container (1)
///         12      4  zero
///         16      8  fingerprint of the scene
///         24      8  state hash
///         32      8  step (signed)
///         40      8  time, s (double)
///         48      8  n, size of the payload
///         56      n  payload
///     56 + n      8  XXH3-64 of everything before

#include "noli/result.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace noli {

struct Checkpoint {
    std::uint64_t fingerprint = 0;  ///< of the scene
    std::uint64_t state_hash = 0;
    int step = 0;
    double time = 0.0;  ///< s
    std::vector<std::byte> payload;
};

/// How many checkpoints stay in a run directory: one may turn out damaged.
inline constexpr int kCheckpointsKept = 3;

/// "step_000000012.ckpt"
std::string checkpoint_file_name(int step);

/// Bytes of the container.
std::string encode_checkpoint(const Checkpoint& checkpoint);

/// Reads a container back; BadCheckpoint with the reason when it is not whole. `where` is
/// its path.
Result<Checkpoint> decode_checkpoint(const std::string& bytes, const std::string& where);

/// Writes a checkpoint into `folder`, pushes it to the disk, then removes all but the
/// newest kCheckpointsKept that are not newer than this one.
Status write_checkpoint(const std::string& folder, const Checkpoint& checkpoint);

/// What was found in a folder of checkpoints.
struct FoundCheckpoint {
    bool found = false;
    Checkpoint checkpoint;
    std::string path;
    std::vector<std::string> skipped;  ///< one sentence per damaged file that is newer
};

/// The newest whole checkpoint with `fingerprint`.
FoundCheckpoint load_newest_checkpoint(const std::string& folder,
                                       std::uint64_t fingerprint);

/// Removes checkpoints of steps after `step`: what follows it will be computed anew.
void remove_checkpoints_after(const std::string& folder, int step);

}  // namespace noli
