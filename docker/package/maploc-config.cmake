# find_package(maploc) makes the target maploc::maploc, the C++ client library.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(Protobuf 3.21)
find_dependency(gRPC 1.51 CONFIG)
find_dependency(PkgConfig)
pkg_check_modules(UTF8PROC QUIET REQUIRED IMPORTED_TARGET libutf8proc)
include(${CMAKE_CURRENT_LIST_DIR}/maploc-targets.cmake)
