#pragma once

#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// One of Simbody's impulse solvers, behind plain numbers: Simbody's headers do not compile as C++20.
class ImpulseCode {
 public:
  virtual ~ImpulseCode() = default;
  /// A unilateral row, and the two friction rows that a contact has, or none (-1).
  struct Contact {
    int normal = 0, tangent = -1, other_tangent = -1;
    double mu = 0;
  };
  /// @param A         rows x rows, row after row, copied
  /// @param joints    bilateral rows
  /// @param contacts  of all other rows
  virtual void SetMatrix(int rows, const double* A, const std::vector<int>& joints,
                         const std::vector<Contact>& contacts) = 0;
  struct Limits {
    double tolerance = -1;  ///< negative: the library's own
    int iterations = 0;     ///< 0: the library's own
  };
  /// The call alone may be timed between Begin and End. @param b  `rows` numbers
  virtual void Begin(const double* b, const Limits& limits) = 0;
  /// Whether the library claims success.
  virtual bool Solve() = 0;
  /// The force of a row, from the last call.
  virtual double Force(int row) const = 0;
  /// As the library counts them.
  virtual long long iterations() const = 0;
};

/// @param by_pruning  PLUSImpulseSolver, else PGSImpulseSolver
std::unique_ptr<ImpulseCode> MakeImpulseCode(bool by_pruning);

/// As Simbody says.
std::string SimbodyVersion();

}  // namespace lcpbench
