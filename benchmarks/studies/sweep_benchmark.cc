// Times one matrix-free pass over two-body rows against the bandwidth floor: a pass that reads every row, and reads and
// writes every f and every number of the bodies, once each and in order, and computes nothing else.
//
// Rows: the scene disc-pile at 10^3 to 10^6 contacts, which the time per item is of (study.h).

#include <array>
#include <string>
#include <string_view>

#include "benchmarks/studies/study.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/rows/two_body_copy.h"

namespace lcpbench {
namespace {

constexpr std::array kSizes = {1'000, 10'000, 100'000, 1'000'000};
constexpr std::uint64_t kSeed = 1;
constexpr std::string_view kScene = "disc-pile";
constexpr Index kRowDoubles = 8;

// One size, with its rows in the given and in a coloured order.
struct Workload {
  Index size;
  RowWork given;
  RowWork coloured;
  Array rows;  // as many bytes as either's rows
  Point next;

  explicit Workload(int contacts) {
    const LcpProblem problem = AssembleContactLcp(GenerateScene(kScene, contacts, kSeed)).problem;
    size = problem.size();
    TwoBodyCopy copy;
    copy.Take(problem);
    given.Prepare(problem, RowForm::kMatrixFree, false, &copy.rows());
    coloured.Prepare(problem, RowForm::kMatrixFree, true, &copy.rows());
    rows.setOnes(size * kRowDoubles);
    next = coloured.x;
  }
};

KeptWorkload<Workload> kept;

void AddToAll(Array* values) {
  for (Index i = 0; i + kLanes <= values->size(); i += kLanes) {
    Store(values->data() + i, Load(values->data() + i) + Filled(1.0));
  }
}

void Floor(Workload* work) {
  std::array<Lanes, 4> sums{};
  const double* from = work->rows.data();
  for (Index i = 0; i + 4 * kLanes <= work->rows.size(); i += 4 * kLanes) {
    for (Index k = 0; k < 4; ++k) sums[static_cast<size_t>(k)] += Load(from + i + k * kLanes);
  }
  double total = Sum((sums[0] + sums[1]) + (sums[2] + sums[3]));
  benchmark::DoNotOptimize(total);
  AddToAll(&work->next.f);
  AddToAll(&work->next.image);
  benchmark::ClobberMemory();
}

void Sweep(RowWork* rows, Index size, bool backward) {
  StepSums sums;
  rows->rows->Sweep(0, size, backward, 1.0, &rows->x, &sums);
  benchmark::DoNotOptimize(sums.residual);
}
void Forward(Workload* work) { Sweep(&work->given, work->size, false); }
void Coloured(Workload* work) { Sweep(&work->coloured, work->size, false); }
void ColouredBackward(Workload* work) { Sweep(&work->coloured, work->size, true); }

void Gradient(Workload* work) {
  RowWork& rows = work->coloured;
  StepSums sums;
  rows.rows->StartImage(&work->next.image);
  rows.rows->GradientStep(0, work->size, 0.1, rows.x, &work->next, &sums);
  benchmark::DoNotOptimize(sums.residual);
}

struct Pass {
  const char* name;
  void (*run)(Workload* work);
};

constexpr std::array kPasses = {
    Pass{"floor", Floor},
    Pass{"forward", Forward},                     // Gauss-Seidel in the given order
    Pass{"coloured", Coloured},                   // in blocks, colour by colour
    Pass{"coloured-backward", ColouredBackward},  // the other half of a symmetric sweep
    Pass{"gradient", Gradient},                   // the pass of apgd
};

// By size before pass, so that a workload is made once.
void RegisterAll() {
  for (const int size : kSizes) {
    for (const Pass& pass : kPasses) {
      const std::string name = std::string(kScene) + "/" + pass.name + "/" + std::to_string(size);
      const auto time = [size, &pass](benchmark::State& state) {
        Workload& work = kept.Get(std::to_string(size), size);
        for (auto _ : state) pass.run(&work);
        CountPerItem(state, static_cast<double>(work.size));
      };
      benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  lcpbench::RegisterAll();
  return lcpbench::RunStudy(argc, argv);
}
