# find_package(ddl): the targets ddl::ddl (shared) and ddl::static, wherever the folder has been moved.
get_filename_component(_ddl_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET ddl::ddl)
  add_library(ddl::ddl SHARED IMPORTED)
  set_target_properties(ddl::ddl PROPERTIES IMPORTED_LOCATION "${_ddl_prefix}/lib/libddl.so"
    IMPORTED_SONAME "@SONAME@")
  add_library(ddl::static STATIC IMPORTED)
  set_target_properties(ddl::static PROPERTIES IMPORTED_LOCATION "${_ddl_prefix}/lib/libddl.a"
    INTERFACE_LINK_LIBRARIES "@NATIVE@")
  foreach(_ddl_target ddl::ddl ddl::static)
    set_target_properties(${_ddl_target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${_ddl_prefix}/include")
    if(CMAKE_CXX_COMPILER_LOADED)
      set_property(TARGET ${_ddl_target} PROPERTY INTERFACE_COMPILE_FEATURES cxx_std_17)
    endif()
  endforeach()
endif()
