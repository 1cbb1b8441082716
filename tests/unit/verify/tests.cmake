# Plots are read back as XML.
find_package(pugixml REQUIRED)
target_link_libraries(test_verify PRIVATE pugixml::pugixml)
