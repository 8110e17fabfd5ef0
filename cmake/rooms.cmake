# SPDX-License-Identifier: Apache-2.0
# One object library per folder of src/ ("room"); noli is all of them together.

# noli_room(NAME [DEPS room...] [LIBS target...]): header-only rooms have no object library.
function(noli_room name)
  cmake_parse_arguments(arg "" "" "DEPS;LIBS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  set(closure ${name})
  foreach(dep ${arg_DEPS})
    list(APPEND closure ${NOLI_ROOM_CLOSURE_${dep}})
  endforeach()
  list(REMOVE_DUPLICATES closure)
  set(NOLI_ROOM_CLOSURE_${name} ${closure} PARENT_SCOPE)
  set(NOLI_ROOM_LIBS_${name} ${arg_LIBS} PARENT_SCOPE)
  if(sources)
    add_library(noli_${name} OBJECT ${sources})
    target_include_directories(noli_${name} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(noli_${name} PRIVATE noli_flags TBB::tbb ${arg_LIBS})
    set_target_properties(noli_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
endfunction()

# noli_link_rooms(TARGET room...): adds the objects and libraries of the rooms and of all that they depend on.
function(noli_link_rooms target)
  set(closure)
  foreach(room ${ARGN})
    list(APPEND closure ${NOLI_ROOM_CLOSURE_${room}})
  endforeach()
  list(REMOVE_DUPLICATES closure)
  foreach(room ${closure})
    if(TARGET noli_${room})
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:noli_${room}>)
    endif()
    target_link_libraries(${target} PRIVATE ${NOLI_ROOM_LIBS_${room}})
  endforeach()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
  # Flags and header-only libraries are no business of who uses an installed noli.
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:noli_flags> TBB::tbb)
endfunction()

# XXH3 is a header; only its include folder is needed.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
add_library(noli_xxhash INTERFACE)
target_include_directories(noli_xxhash SYSTEM INTERFACE ${XXHASH_INCLUDE_DIR})

noli_room(core)
noli_room(exec DEPS core)
noli_room(geometry DEPS core)
noli_room(energy DEPS core geometry)
noli_room(mesh DEPS core LIBS fmt::fmt)
noli_room(scene DEPS core mesh LIBS fmt::fmt $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 warns of impossible overlaps inside std::string.
  target_compile_options(noli_scene PRIVATE -Wno-restrict)
endif()
noli_room(model DEPS core exec mesh energy LIBS fmt::fmt)
noli_room(contact DEPS core exec geometry)
# CHOLMOD is optional: without it linear/cholmod_solver says that it is not available.
set(noli_linear_libs)
if(NOLI_CHOLMOD)
  find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
  find_library(CHOLMOD_LIBRARY cholmod)
  if(CHOLMOD_INCLUDE_DIR AND CHOLMOD_LIBRARY)
    add_library(noli_cholmod INTERFACE)
    target_include_directories(noli_cholmod SYSTEM INTERFACE $<BUILD_INTERFACE:${CHOLMOD_INCLUDE_DIR}>)
    target_link_libraries(noli_cholmod INTERFACE $<BUILD_INTERFACE:${CHOLMOD_LIBRARY}> $<INSTALL_INTERFACE:cholmod>)
    target_compile_definitions(noli_cholmod INTERFACE $<BUILD_INTERFACE:NOLI_HAVE_CHOLMOD>)
    set(noli_linear_libs noli_cholmod)
  endif()
endif()
noli_room(linear DEPS core exec LIBS ${noli_linear_libs})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Loads of four from columns of three overlap. Keeping the overlap in a register for the next block costs
  # more shuffles than the load: sweeps take a quarter longer.
  target_compile_options(noli_linear PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-predictive-commoning>)
endif()
noli_room(objective DEPS core exec geometry energy model contact linear)
noli_room(step DEPS core exec model contact objective linear LIBS fmt::fmt)
noli_room(output DEPS core LIBS fmt::fmt ZLIB::ZLIB
  $<BUILD_INTERFACE:nlohmann_json::nlohmann_json> $<BUILD_INTERFACE:noli_xxhash>)
noli_room(sim DEPS core exec scene mesh model contact objective linear step output LIBS fmt::fmt)

if(NOLI_WITH_CUDA)
  include(${CMAKE_CURRENT_LIST_DIR}/cuda.cmake)
endif()

# The library: all rooms in one static archive behind three public headers.
add_library(noli STATIC)
add_library(noli::noli ALIAS noli)
noli_link_rooms(noli sim)
target_include_directories(noli PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_compile_features(noli PUBLIC cxx_std_20)
