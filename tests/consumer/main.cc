#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

int main() {
  const lcpbench::AssembledLcp lcp = lcpbench::AssembleContactLcp(lcpbench::GenerateScene("disc-pile", 20, 1));
  lcpbench::LcpResult result;
  lcpbench::MakeSolver("dantzig")->Solve(lcp.problem, {}, &result);
  return lcpbench::Verify(lcp.problem, result, 1e-9).passes ? 0 : 1;
}
