# A portfolio of the peers that are in this build.
if(TARGET lcpbench_linked_bullet AND TARGET lcpbench_linked_alglib)
  lcpbench_add_peer(portfolio SOURCES portfolio/portfolio.cc LIBRARIES lcpbench_linked_bullet lcpbench_linked_alglib)
endif()
