#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "model/records/replay.h"

namespace lcpbench {

/// Two numbers agree when their ScaledDeviation is at most this.
inline constexpr double kReplayTolerance = 1e-9;

/// What many replayed records amount to: agreement per contact kind and of A, the sizes of the corrections, and every
/// number that is left over.
class ReplaySummary {
 public:
  /// @param where  "file:line", for the list of what is left over
  void Add(const ReplayRecord& record, const ReplayResult& result, const std::string& where);

  size_t records() const { return records_; }
  /// A agrees on every record, and b, corrected, on every row.
  bool AllAgree() const { return left_over_.empty(); }

  /// For people: several lines, the first few of what is left over last.
  std::string Table() const;
  /// One JSON object on one line: {records, rows, tolerance, agrees, A {records, agree, largest, id}, kinds [{kind,
  /// rows, agree_before, largest_before, agree_after, largest_after, largest_geometry}], corrections [{key, formula,
  /// rows, largest}], left_over [{where, id, what, recorded, ours, deviation}]}.
  std::string Json() const;

 private:
  struct Largest {
    double deviation = 0;
    std::string id;
    void Take(double value, const std::string& record_id);
  };
  struct Tally {
    size_t rows = 0;
    size_t agree_before = 0;
    size_t agree_after = 0;
    Largest before;
    Largest after;
    Largest geometry;
  };
  struct Size {
    size_t rows = 0;
    Largest largest;  ///< [m/s^2], not scaled
  };
  struct LeftOver {
    std::string where;
    std::string id;
    std::string what;
    double recorded = 0;  ///< corrected
    double ours = 0;
  };

  Tally Total() const;

  size_t records_ = 0;
  size_t records_with_equal_A_ = 0;
  Largest A_;
  std::map<std::string, Tally> kinds_;
  std::array<Size, kCorrectionCount> corrections_;
  std::vector<LeftOver> left_over_;
};

}  // namespace lcpbench
