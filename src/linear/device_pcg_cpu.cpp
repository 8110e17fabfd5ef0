// SPDX-License-Identifier: Apache-2.0
/// The text of device_pcg.hpp on the CPU, compiled apart: together with the engine it
/// would take g++ past the growth up to which it inlines, and the engine's own loops
/// would pay.
#include "exec/cpu.hpp"
#include "linear/device_pcg.hpp"

namespace noli {

template class DevicePcg<CpuExec>;

}  // namespace noli
