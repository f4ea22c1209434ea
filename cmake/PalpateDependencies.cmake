# Third-party libraries, all from Debian 12; packages.txt is the list that installs them.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(TBB REQUIRED)

# The libraries below carry old headers; SYSTEM keeps their warnings out of ours.
find_package(CGAL REQUIRED QUIET)
add_library(palpate_cgal INTERFACE)
target_link_libraries(palpate_cgal INTERFACE CGAL::CGAL)
target_compile_definitions(palpate_cgal INTERFACE CGAL_DISABLE_ROUNDING_MATH_CHECK)
# CGAL's interval arithmetic relies on the rounding mode.
target_compile_options(palpate_cgal INTERFACE -frounding-math -Wno-shadow)

find_library(EMBREE_LIBRARY embree3 REQUIRED)
add_library(palpate_embree INTERFACE)
target_link_libraries(palpate_embree INTERFACE ${EMBREE_LIBRARY})

find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_path(CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(OPENBLAS_LIBRARY openblas REQUIRED)
add_library(palpate_cholmod INTERFACE)
target_include_directories(palpate_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE})
target_link_libraries(palpate_cholmod INTERFACE ${CHOLMOD_LIBRARY} ${OPENBLAS_LIBRARY} gomp)
