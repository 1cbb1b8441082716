# Derivatives by ceres::Jet, for fresnel_test.cpp.
find_package(Ceres REQUIRED)
target_link_libraries(test_bsdf PRIVATE Ceres::ceres)
