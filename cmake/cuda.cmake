# SPDX-License-Identifier: Apache-2.0
# The CUDA engine, as one more source of the room sim. Programs link without a driver and without a
# GPU: the runtime is linked statically and looks for the driver when it is first called.

# CMake reads CUDACXX itself: it may hold options.
if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  set(CMAKE_CUDA_COMPILER ${noli_nvcc})
endif()
enable_language(CUDA)
# What ptxas says of registers and spills stays beside the object files: tools/check_ptxas.py.
set(CMAKE_CUDA_COMPILER_LAUNCHER ${PROJECT_SOURCE_DIR}/tools/ptxas_launcher.sh)
# CMake 3.25's module ends with an error where a toolkit of CUDA 12.9 or newer lacks a library that those no
# longer have (nvToolsExt), but only in projects that ask for CMake 3.25.
set(noli_minimum_cmake ${CMAKE_MINIMUM_REQUIRED_VERSION})
set(CMAKE_MINIMUM_REQUIRED_VERSION 3.24)
find_package(CUDAToolkit REQUIRED)
set(CMAKE_MINIMUM_REQUIRED_VERSION ${noli_minimum_cmake})

set_target_properties(noli_sim PROPERTIES CUDA_COMPILER_LAUNCHER ${CMAKE_CUDA_COMPILER_LAUNCHER})
target_sources(noli_sim PRIVATE ${PROJECT_SOURCE_DIR}/src/sim/engine_cuda.cu)
target_compile_definitions(noli_sim PRIVATE NOLI_HAVE_CUDA)
list(APPEND NOLI_ROOM_LIBS_sim CUDA::cudart_static)

# CMake 3.25 does not know the CUDA20 dialect of nvcc 13, so the flag is spelled out. Host code gets
# the same floating-point flags as the .cpp files: both may hold a copy of an inline function.
# --threads: one per architecture.
target_compile_options(noli_sim PRIVATE
  $<$<COMPILE_LANGUAGE:CUDA>:-std=c++20;--extended-lambda;--expt-relaxed-constexpr;-fmad=false;-Xptxas=-v;--threads=2>
  $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-ffp-contract=off,-fno-math-errno,-fno-trapping-math,-Wall>
  $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${NOLI_WERROR}>>:-Werror=all-warnings>)
