#include "model/records/replay_summary.h"

#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace lcpbench {
namespace {

bool Agrees(double deviation) { return deviation <= kReplayTolerance; }

// Two digits: deviations are compared by magnitude only.
std::string Short(double value) {
  std::ostringstream text;
  text << std::setprecision(2) << value;
  return text.str();
}

}  // namespace

void ReplaySummary::Largest::Take(double value, const std::string& record_id) {
  // Not a number counts as the largest of all.
  if (value > deviation || std::isnan(value)) {
    deviation = value;
    id = record_id;
  }
}

void ReplaySummary::Add(const ReplayRecord& record, const ReplayResult& result, const std::string& where) {
  ++records_;
  for (size_t i = 0; i < result.rows.size(); ++i) {
    const ReplayRow& row = result.rows[i];
    const double before = ScaledDeviation(row.ours, row.recorded);
    const double after = ScaledDeviation(row.ours, row.corrected());
    Tally& tally = kinds_[row.kind];
    ++tally.rows;
    if (Agrees(before)) ++tally.agree_before;
    if (Agrees(after)) ++tally.agree_after;
    tally.before.Take(before, record.id);
    tally.after.Take(after, record.id);
    tally.geometry.Take(row.geometry_deviation, record.id);
    for (size_t k = 0; k < kCorrectionCount; ++k) {
      if (row.added[k] == 0) continue;
      ++corrections_[k].rows;
      corrections_[k].largest.Take(std::abs(row.added[k]), record.id);
    }
    if (!Agrees(after)) {
      left_over_.push_back(
          {where, record.id, "b[" + std::to_string(i) + "] (" + row.kind + ")", row.corrected(), row.ours});
    }
  }
  Largest of_record;
  LeftOver worst{where, record.id, "", 0, 0};
  for (Eigen::Index i = 0; i < result.A.rows(); ++i) {
    for (Eigen::Index j = 0; j < result.A.cols(); ++j) {
      const double deviation = ScaledDeviation(result.A(i, j), record.A(i, j));
      A_.Take(deviation, record.id);
      const double so_far = of_record.deviation;
      of_record.Take(deviation, record.id);
      if (!(of_record.deviation > so_far)) continue;
      worst.what = "A[" + std::to_string(i) + "][" + std::to_string(j) + "] (" +
                   result.rows[static_cast<size_t>(i)].kind + ", " + result.rows[static_cast<size_t>(j)].kind + ")";
      worst.recorded = record.A(i, j);
      worst.ours = result.A(i, j);
    }
  }
  if (Agrees(of_record.deviation)) {
    ++records_with_equal_A_;
  } else {
    left_over_.push_back(worst);
  }
}

ReplaySummary::Tally ReplaySummary::Total() const {
  Tally total;
  for (const auto& [kind, tally] : kinds_) {
    total.rows += tally.rows;
    total.agree_before += tally.agree_before;
    total.agree_after += tally.agree_after;
    total.before.Take(tally.before.deviation, tally.before.id);
    total.after.Take(tally.after.deviation, tally.after.id);
    total.geometry.Take(tally.geometry.deviation, tally.geometry.id);
  }
  return total;
}

std::string ReplaySummary::Table() const {
  constexpr size_t kMostLeftOver = 20;
  std::ostringstream out;
  const auto line = [&](const std::string& kind, const Tally& tally) {
    out << std::left << std::setw(24) << kind << std::right << std::setw(7) << tally.rows << std::setw(9)
        << tally.agree_before << std::setw(9) << Short(tally.before.deviation) << std::setw(9) << tally.agree_after
        << std::setw(9) << Short(tally.after.deviation) << std::setw(11) << Short(tally.geometry.deviation) << "\n";
  };
  const Tally total = Total();
  out << records_ << " records, " << total.rows << " rows; numbers agree within " << kReplayTolerance
      << " (1 + |recorded|)\n\n"
      << "A: " << records_with_equal_A_ << " of " << records_ << " records agree, largest deviation "
      << Short(A_.deviation) << (A_.id.empty() ? "" : " in " + A_.id) << "\n\n"
      << "b without the stabilisation term\n"
      << "                                     as recorded         corrected     n, d, d'\n"
      << "kind                       rows    agree  largest    agree  largest    largest\n";
  for (const auto& [kind, tally] : kinds_) line(kind, tally);
  line("total", total);
  out << "\ncorrections             rows     largest  in record   added to the recorded b\n";
  for (size_t k = 0; k < kCorrectionCount; ++k) {
    const CorrectionText text = Text(static_cast<Correction>(k));
    out << std::left << std::setw(20) << text.key << std::right << std::setw(8) << corrections_[k].rows << std::setw(12)
        << Short(corrections_[k].largest.deviation) << "  " << std::left << std::setw(12) << corrections_[k].largest.id
        << text.formula << "\n";
  }
  if (!left_over_.empty()) out << "\nleft over: " << left_over_.size() << "\n" << std::setprecision(17);
  for (size_t i = 0; i < left_over_.size() && i < kMostLeftOver; ++i) {
    const LeftOver& left = left_over_[i];
    out << left.where << ": " << left.id << ": " << left.what << ": corrected " << left.recorded << ", ours "
        << left.ours << "\n";
  }
  if (left_over_.size() > kMostLeftOver) out << "... (--json lists all)\n";
  return out.str();
}

std::string ReplaySummary::Json() const {
  using Json = nlohmann::ordered_json;
  Json kinds = Json::array();
  for (const auto& [kind, tally] : kinds_) {
    kinds.push_back({{"kind", kind},
                     {"rows", tally.rows},
                     {"agree_before", tally.agree_before},
                     {"largest_before", tally.before.deviation},
                     {"agree_after", tally.agree_after},
                     {"largest_after", tally.after.deviation},
                     {"largest_geometry", tally.geometry.deviation}});
  }
  Json corrections = Json::array();
  for (size_t k = 0; k < kCorrectionCount; ++k) {
    const CorrectionText text = Text(static_cast<Correction>(k));
    corrections.push_back({{"key", text.key},
                           {"formula", text.formula},
                           {"rows", corrections_[k].rows},
                           {"largest", corrections_[k].largest.deviation}});
  }
  Json left_over = Json::array();
  for (const LeftOver& left : left_over_) {
    left_over.push_back({{"where", left.where},
                         {"id", left.id},
                         {"what", left.what},
                         {"recorded", left.recorded},
                         {"ours", left.ours},
                         {"deviation", ScaledDeviation(left.ours, left.recorded)}});
  }
  const Json out = {
      {"records", records_},
      {"rows", Total().rows},
      {"tolerance", kReplayTolerance},
      {"agrees", AllAgree()},
      {"A", {{"records", records_}, {"agree", records_with_equal_A_}, {"largest", A_.deviation}, {"id", A_.id}}},
      {"kinds", std::move(kinds)},
      {"corrections", std::move(corrections)},
      {"left_over", std::move(left_over)}};
  // A name may hold any bytes.
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lcpbench
