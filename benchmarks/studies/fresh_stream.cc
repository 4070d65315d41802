#include "benchmarks/studies/fresh_stream.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "support/process_watch.h"
#include "benchmarks/measure/quantile.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/external_solver.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The probe of the clock rate that one in ten so far is below, as in a campaign.
double FastProbe(double probe_s) {
  static std::vector<double> probes;
  probes.insert(std::upper_bound(probes.begin(), probes.end(), probe_s), probe_s);
  constexpr std::size_t kOneIn = 10;
  return probes[probes.size() / kOneIn];
}

struct Run {
  PassReply reply;
  double disturbance = kInfinity;
};

// Again where the machine disturbed it; of several runs the one that was disturbed least.
Run RunUndisturbed(Contestant* contestant, std::span<const ProblemArrays> stream, const PassRequest& request,
                   const NoiseRule& noise) {
  Run best;
  for (int run = 0; run <= noise.most_reruns && best.disturbance > 0; ++run) {
    const DisturbanceWatch watch;
    PassReply reply = contestant->Pass(stream, request);
    Disturbance found = watch.Finish();
    if (contestant->is_elsewhere()) found.cpu_share = 1;  // this thread waits meanwhile
    const double disturbance = DisturbanceOf(noise, found, std::min(FastProbe(found.probe_s), found.probe_s));
    if (disturbance < best.disturbance) best = {std::move(reply), disturbance};
  }
  return best;
}

bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

}  // namespace

FreshStream::FreshStream(FreshProblems* problems, std::size_t begin, std::size_t end, const CampaignPlan& plan,
                         double tier)
    : source_(problems),
      begin_(begin),
      planned_(std::span(problems->planned()).subspan(begin, end - begin)),
      plan_(plan),
      tier_(tier) {}

void FreshStream::DropProblems() {
  problems_ = {};
  arrays_ = {};
  for (Standing& standing : standings_) standing.f = {};
}

FreshStream::Standing& FreshStream::StandingOf(Contestant* contestant) {
  for (Standing& standing : standings_) {
    if (standing.contestant == contestant) return standing;
  }
  Standing& standing = standings_.emplace_back();
  standing.contestant = contestant;
  standing.calm.resize(planned_.size());
  standing.disturbed.resize(planned_.size());
  Judge(contestant, &standing);
  return standing;
}

void FreshStream::Measure(const std::vector<Contestant*>& contestants) {
  if (problems_.empty()) {
    problems_ = source_->Make(begin_, begin_ + planned_.size());
    arrays_.reserve(problems_.size());
    for (const auto& one : problems_) arrays_.push_back(ProblemArrays::Of(one.problem));
  }
  for (Contestant* contestant : contestants) contestant->BeginStream();
  for (Contestant* contestant : contestants) StandingOf(contestant).spent_s = 0;
  std::vector<std::size_t> alone(contestants.size());
  std::iota(alone.begin(), alone.end(), std::size_t{0});
  for (int k = 0; k < plan_.passes; ++k) {
    ++passes_;
    for (const std::size_t chosen : ShuffleGroups(alone, plan_.seed, passes_)) {
      RunPass(contestants[chosen], &StandingOf(contestants[chosen]), passes_);
    }
  }
}

bool FreshStream::Passes(std::size_t place, const Eigen::VectorXd& f) const {
  const FreshProblems::Problem& given = problems_[place];
  return PassesTier(ComputeMetrics(given.problem, f, &given.reference), tier_);
}

void FreshStream::Judge(Contestant* contestant, Standing* standing) {
  LcpOptions options;
  options.tolerance = tier_;
  std::vector<double> verified_s;
  double spent = 0;
  for (std::size_t place = 0; place < planned_.size() && spent <= plan_.budgets.judge_s; ++place) {
    const bool is_given = contestant->WhyRefused(RowsOf(place)).empty();
    double seconds = kInfinity;
    LcpResult result;
    if (is_given) {
      options.time_limit_s = plan_.limits.Of(RowsOf(place));
      result = contestant->Judge(problems_[place].problem, arrays_[place], options, &seconds);
      spent += seconds;
    }
    const bool passes = is_given && Passes(place, result.f);
    standing->judged_s.push_back(seconds);
    standing->verified.push_back(passes);
    standing->f.push_back(std::move(result.f));
    if (passes) verified_s.push_back(seconds);
  }
  if (!verified_s.empty()) standing->median_s = MedianOf(verified_s);
}

void FreshStream::RunPass(Contestant* contestant, Standing* standing, int pass) {
  std::vector<std::size_t> places;
  double time_limit_s = 0;
  for (std::size_t place = 0; place < standing->verified.size(); ++place) {
    if (!standing->verified[place]) continue;
    places.push_back(place);
    time_limit_s = std::max(time_limit_s, plan_.limits.Of(RowsOf(place)));
  }
  PassRequest request = PlanPass(places, PassKind::kFresh, plan_.seed + begin_, pass);
  request.tolerance = tier_;
  request.time_limit_s = time_limit_s;
  request.budget_s = plan_.budgets.timed_s - standing->spent_s;
  if (planned_.front().size_class->stream > 0) request.group = GroupOf(standing->median_s);
  if (request.order.empty() || request.budget_s <= 0) return;
  Run run;
  try {
    run = RunUndisturbed(contestant, arrays_, request, plan_.noise);
  } catch (const WorkerFailure& failure) {
    std::cerr << contestant->key() << ": a pass did not finish: " << failure.what() << std::endl;
    return;
  }
  std::vector<double> all;
  for (std::size_t k = 0; k < run.reply.size(); ++k) {
    const std::size_t place = request.order[k];
    const PassEntry& entry = run.reply[k];
    all.push_back(entry.seconds);
    standing->spent_s += entry.seconds;
    (run.disturbance > 0 ? standing->disturbed : standing->calm)[place].push_back(entry.seconds);
    if (!SameBits(entry.f, standing->f[place]) && !Passes(place, entry.f)) standing->verified[place] = false;
  }
  if (!all.empty()) standing->median_s = MedianOf(std::move(all));
}

std::vector<double> FreshStream::Seconds(const Contestant& contestant) const {
  std::vector<double> seconds(planned_.size(), std::numeric_limits<double>::quiet_NaN());
  const auto found = std::find_if(standings_.begin(), standings_.end(),
                                  [&](const Standing& standing) { return standing.contestant == &contestant; });
  if (found == standings_.end()) return seconds;
  for (std::size_t place = 0; place < found->verified.size(); ++place) {
    const auto& passes = found->calm[place].empty() ? found->disturbed[place] : found->calm[place];
    seconds[place] = !found->verified[place] ? kInfinity : passes.empty() ? found->judged_s[place] : MedianOf(passes);
  }
  return seconds;
}

}  // namespace lcpbench
