#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "model/contact/system.h"
#include "model/records/replay_record.h"

namespace lcpbench {

/// Agreement with the paper's own software: its recorded contact problems, assembled again by this model.
///
/// The features are rebuilt from the recorded geometry (centres of curvature from U, radii without the gap that was
/// added to them, edges through the impact points), then found and assembled by AssembleContactLcp like any other
/// system. The software's b departs from the second derivative of the gap in the ways that Correction lists; with them,
/// recorded b - extra + corrections is what this model computes. A needs no correction.

/// What the mathematics demands and the software does otherwise; derived in docs/model.md section 13. Written with the
/// software's own quantities: dv = v1(U1) - v2(U2) the relative velocity at the ends of the centre arms, vn = n.dv, vt
/// = t.dv, t = Perp(n), rho the signed radius that it divides by.
enum class Correction {
  kNormalDerivative,   ///< its n' = dv/rho is not perpendicular to n:  -vn^2/rho
  kVertexAboveEdge,    ///< a vertex taken to be where its foot is:  -d (omega1 - omega2)^2
  kVertexAboveVertex,  ///< the same of two vertices:  2 omega1 vt
  kJointAxis,          ///< the arms of fixed axes with the term of turning ones:  -2 omega2 vt
  kRodLength,          ///< it divides by the rest length L; the distance is l = |p1 - p2|:  vt^2 (1/L - 1/l)
  kPathGap,            ///< n' of a path at distance d turns slower by 1 + kappa d:  kappa vt^2/(1 + kappa d) - n'.dv
};

inline constexpr size_t kCorrectionCount = 6;

/// The corrections for readers, by Correction.
struct CorrectionText {
  const char* key;
  const char* formula;
};
inline constexpr std::array<CorrectionText, kCorrectionCount> kCorrectionTexts = {
    {{"normal-derivative", "-vn^2/rho"},
     {"vertex-above-edge", "-d (omega1 - omega2)^2"},
     {"vertex-above-vertex", "2 omega1 vt"},
     {"joint-axis", "-2 omega2 vt"},
     {"rod-length", "vt^2 (1/L - 1/l)"},
     {"path-gap", "kappa vt^2/(1 + kappa d) - n'.dv"}}};

/// One recorded row against this model's.
struct ReplayRow {
  std::string kind;     ///< as recorded; "_concave" where a radius is negative, "_world" for a joint with fixed axes
  double recorded = 0;  ///< b - extra [m/s^2]
  std::array<double, kCorrectionCount> added{};  ///< corrections, by Correction
  double ours = 0;                               ///< this model's b
  /// Largest difference of n, and of d and d' scaled as below, between the record and the rebuilt row.
  double geometry_deviation = 0;

  double corrected() const {
    double sum = recorded;
    for (const double term : added) sum += term;
    return sum;
  }
};

/// A record rebuilt by this model.
struct ReplayResult {
  std::vector<ReplayRow> rows;
  Eigen::MatrixXd A;  ///< this model's, rows as recorded
};

/// A record's contact as one constraint of this model, whose row or rows give the recorded one:
/// recorded row = sum_k weight[k] (row k of the constraint).
struct RebuiltContact {
  Constraint constraint;
  std::array<double, 2> weight{};                ///< a pin has two rows (world x, y), all others one
  double gap_offset = 0;                         ///< recorded gap - weighted d
  std::array<double, kCorrectionCount> added{};  ///< corrections of the recorded b, by Correction
};

/// Rods are recorded with n from attachment 1 to 2, hence weight -1. Vertex/vertex contacts, which this model refuses,
/// are rebuilt as the distance row they are away from d = 0, as a rod of the recorded length. A joint's axis is a
/// combination of the two rows of a pin.
RebuiltContact Rebuild(const RecordedContact& contact, const std::vector<Body>& bodies);

/// Rebuilds and assembles `record`.  O(n^2).
/// @throws InputError if the recorded geometry is not a contact system (AssembleContactLcp), naming body and feature
ReplayResult Replay(const ReplayRecord& record);

/// |x - reference| / (1 + |reference|): how deviations are measured here.
double ScaledDeviation(double x, double reference);

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

  size_t records_ = 0;
  size_t records_with_equal_A_ = 0;
  Largest A_;
  std::map<std::string, Tally> kinds_;
  Tally total_;
  std::array<Size, kCorrectionCount> corrections_;
  std::vector<LeftOver> left_over_;
};

}  // namespace lcpbench
