# find_package(fairlead): the target fairlead::fairlead, headers only.
if(NOT TARGET fairlead::fairlead)
  get_filename_component(fairlead_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(fairlead::fairlead INTERFACE IMPORTED)
  set_target_properties(fairlead::fairlead PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${fairlead_prefix}/include"
    INTERFACE_COMPILE_FEATURES cxx_std_17
    # the same bits everywhere: no fused multiply-add, no errno side of sqrt
    INTERFACE_COMPILE_OPTIONS "-ffp-contract=off;-fno-math-errno")
endif()
