#include "solvers/peers/protocol/protocol.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "tests/fuzz/binary_mutation.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

void ExpectSame(const ProblemArrays& p, const ProblemArrays& q) {
  EXPECT_EQ(p.form, q.form);
  EXPECT_EQ(p.rows, q.rows);
  EXPECT_EQ(p.columns, q.columns);
  EXPECT_EQ(p.row_start, q.row_start);
  EXPECT_EQ(p.column, q.column);
  EXPECT_EQ(p.value, q.value);
  EXPECT_EQ(p.inverse_mass, q.inverse_mass);
  EXPECT_EQ(p.b, q.b);
  EXPECT_EQ(p.bilateral, q.bilateral);
  EXPECT_EQ(p.friction, q.friction);
  EXPECT_EQ(p.bounded, q.bounded);
  EXPECT_EQ(p.facts.symmetric, q.facts.symmetric);
  EXPECT_EQ(p.facts.positive_semidefinite, q.facts.positive_semidefinite);
}

// One of each form, with joints and without.
std::vector<ProblemArrays> Problems() {
  std::vector<ProblemArrays> problems;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const LcpProblem planted = PlantedProblem(9, 4, seed, seed % 3, 0).problem;
    problems.push_back(ProblemArrays::Of(planted));
    for (const MatrixForm form : {MatrixForm::kDense, MatrixForm::kSparse}) {
      problems.push_back(ProblemArrays::Of(InForm(planted, form)));
    }
    SparseMatrix J(2, 3);
    J.insert(0, 1) = seed;
    J.insert(1, 0) = -1;
    problems.push_back(
        ProblemArrays::Of(LcpProblem::FromFactors("", J, Eigen::Vector3d(1, 0, 2), Eigen::Vector2d(seed, -1))));
    problems.back().facts.rank = 1;
    problems.back().facts.f_unique = false;
    problems.back().facts.columns_per_body = seed % 2 == 0 ? 3 : 6;
  }
  return problems;
}

TEST(Protocol, ProblemsOfEveryFormComeBackBitForBit) {
  const std::vector<ProblemArrays> problems = Problems();
  for (const ProblemArrays& problem : problems) {
    for (const std::uint32_t version : {1U, 2U, 3U, 4U})
      ExpectSame(DecodeProblem(Encode(problem, version), version), problem);
    const MatrixFacts facts = DecodeProblem(Encode(problem)).facts;
    EXPECT_EQ(facts.rank, problem.facts.rank);
    EXPECT_EQ(facts.f_unique, problem.facts.f_unique);
    EXPECT_EQ(facts.columns_per_body, problem.facts.columns_per_body);
    EXPECT_EQ(DecodeProblem(Encode(problem, 2), 2).facts.columns_per_body, 3);
  }
  std::vector<ProblemArrays> stream = problems;
  for (ProblemArrays& problem : stream) {
    problem.friction = {{1, 0, 0.25}, {2, 0, 1e-9, -1}};
    EXPECT_THROW(Encode(problem, 4), std::runtime_error);
    problem.bounded = {{3, -std::numeric_limits<double>::infinity(), 2}};
    ExpectSame(DecodeProblem(Encode(problem)), problem);
    problem.friction.clear();
    EXPECT_THROW(Encode(problem, 4), std::runtime_error);
  }
  stream = DecodeStream(Encode(std::span(problems)));
  ASSERT_EQ(stream.size(), problems.size());
  for (std::size_t k = 0; k < stream.size(); ++k) ExpectSame(stream[k], problems[k]);
}

TEST(Protocol, PassesComeBackAsTheyWere) {
  const std::vector<ProblemArrays> problems = Problems();
  PassRequest request;
  request.kind = PassKind::kAgain;
  request.tolerance = 1e-6;
  request.time_limit_s = 2;
  request.settle_s = 3;
  request.warm_up = {2, 3};
  request.order = {1, 0};
  request.other_b = {Eigen::VectorXd::Ones(problems[1].rows), Eigen::VectorXd::Zero(problems[0].rows)};
  const PassRequest asked = DecodePass(Encode(request), problems);
  EXPECT_EQ(asked.kind, request.kind);
  EXPECT_EQ(asked.tolerance, request.tolerance);
  EXPECT_EQ(asked.time_limit_s, request.time_limit_s);
  EXPECT_EQ(asked.settle_s, request.settle_s);
  EXPECT_EQ(asked.warm_up, request.warm_up);
  EXPECT_EQ(asked.order, request.order);
  EXPECT_EQ(asked.other_b, request.other_b);
  EXPECT_THROW(DecodePass(Encode(request), std::span(problems).first(3)), std::runtime_error);

  PassReply reply;
  for (const std::uint32_t place : request.order) {
    reply.entries.push_back({1, 2, 3, 4, 5, LcpStatus::kTimeLimit, Eigen::VectorXd::Constant(problems[place].rows, 7)});
  }
  reply.disturbance = {6, 0.5, 8};
  const PassReply back = DecodePassReply(Encode(reply), request, problems);
  ASSERT_EQ(back.entries.size(), request.order.size());
  EXPECT_EQ(back.entries[0].seconds, 1);
  EXPECT_EQ(back.entries[0].problem_s, 2);
  EXPECT_EQ(back.entries[0].prepare_s, 3);
  EXPECT_EQ(back.entries[0].convert_s, 4);
  EXPECT_EQ(back.entries[0].solve_s, 5);
  EXPECT_EQ(back.entries[0].status, LcpStatus::kTimeLimit);
  EXPECT_EQ(back.entries[0].f, reply.entries[0].f);
  ASSERT_TRUE(back.disturbance.has_value());
  EXPECT_EQ(back.disturbance->probe_s, 6);
  EXPECT_EQ(back.disturbance->cpu_share, 0.5);
  EXPECT_EQ(back.disturbance->switches, 8);
  // One answer is missing.
  reply.entries.pop_back();
  EXPECT_THROW(DecodePassReply(Encode(reply), request, problems), std::runtime_error);
}

TEST(Protocol, AnswersComeBackBitForBit) {
  LcpResult result;
  result.status = LcpStatus::kInfeasible;
  result.f = Eigen::Vector3d(1, -0.0, std::numeric_limits<double>::denorm_min());
  result.iterations = 12345678901LL;
  result.detail = "a ray";
  result.own_solve_s = 1e-6;
  result.own_convert_s = 2e-6;
  result.own_fresh_s = 4e-6;
  result.farkas_ray = Eigen::Vector3d(0, 1, 0);
  const LcpResult back = DecodeResult(Encode(result), 3);
  EXPECT_EQ(back.status, result.status);
  EXPECT_EQ(back.f, result.f);
  EXPECT_EQ(back.iterations, result.iterations);
  EXPECT_EQ(back.detail, result.detail);
  EXPECT_EQ(back.own_solve_s, result.own_solve_s);
  EXPECT_EQ(back.own_convert_s, result.own_convert_s);
  EXPECT_EQ(back.farkas_ray, result.farkas_ray);

  result.model = FrictionModel::kFrozenBounds;
  result.friction_bounds = Eigen::Vector3d(0, 2, 0);
  EXPECT_EQ(DecodeResult(Encode(result), 3).friction_bounds, result.friction_bounds);
  EXPECT_EQ(back.friction_bounds.size(), 0);

  EXPECT_EQ(back.own_fresh_s, result.own_fresh_s);
  EXPECT_EQ(DecodeResult(Encode(result, 1), 3, 1).own_fresh_s, -1);

  const SolveRequest request{1e-6, 2.5, 7, true, Eigen::VectorXd::Ones(3)};
  const SolveRequest asked = DecodeSolve(Encode(request), 3);
  EXPECT_EQ(asked.tolerance, request.tolerance);
  EXPECT_EQ(asked.time_limit_s, request.time_limit_s);
  EXPECT_EQ(asked.max_iterations, request.max_iterations);
  EXPECT_EQ(asked.time_parts, request.time_parts);
  EXPECT_EQ(asked.start, request.start);
}

// Whatever arrives, it is a message or a clear error: no crash, no allocation beyond what arrived.
TEST(Protocol, BrokenPayloadsAreErrors) {
  std::mt19937_64 random(1);
  for (const ProblemArrays& problem : Problems()) {
    const Bytes good = Encode(problem);
    for (std::size_t size = 0; size < good.size(); ++size) {
      EXPECT_THROW(DecodeProblem(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))),
                   std::runtime_error);
    }
    int refused = 0;
    for (int i = 0; i < 1000; ++i) {
      Bytes bad = good;
      for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<char>(random());
      try {
        DecodeProblem(bad);
      } catch (const std::exception&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0);
  }
  const Bytes hello = Encode(Hello{kProtocolVersion + 1, WantedForm::kDense, "n", "v", "l"});
  EXPECT_THROW(DecodeHello(hello), std::runtime_error);
}

// Recorded conversations and changes of them.
TEST(ProtocolLaw, HoldsForTheCorpusAndItsChanges) {
  ExpectLawHolds(
      BrokenProtocolLaw, "protocol_corpus", 4000,
      [random = std::mt19937_64(1), of_text = ChangesOfText()](const std::string& bytes, const auto& corpus) mutable {
        std::vector<std::string> changes = of_text(bytes, corpus);
        changes.push_back(OverwrittenBytes(bytes, &random));
        return changes;
      });
}

}  // namespace
}  // namespace lcpbench
