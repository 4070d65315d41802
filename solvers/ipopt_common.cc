// Shared by ipopt_qp.cc and ipopt_ncp.cc.
