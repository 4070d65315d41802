#pragma once

#include <string>
#include <vector>

#include "benchmarks/large_study.h"

namespace lcpbench {

/// Columns and cells of the CSV file: one row per solver x problem, SI units, empty where there is no value.
std::vector<std::string> CsvColumns();
std::vector<std::string> CsvCells(const LargeRow& row);

/// The same in short as a Markdown table of fixed width: its head, and rows as they come.
std::string MarkdownHead();
std::string MarkdownRow(const LargeRow& row);

/// Tables over all rows, in Markdown with a title line each.
/// Per solver and size: how many answers are verified, and median (most) of in_k() over those.
std::string VerifiedTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers);
/// Per solver and family: p of total_s() ~ n^p by least squares from kLeastForExponent rows on, medians over
/// seeds, where all are verified at two sizes at least.
inline constexpr int kLeastForExponent = 10'000;
std::string ExponentTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers);
/// Per solver and size: median (most) over problems of total_s() relative to that of the fastest of `peers` with a
/// verified answer.
std::string PeerTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers,
                      const std::vector<std::string>& peers);
/// Per solver, family and mass ratio: over the seeds how many answers are verified, how many have rho <= max(tolerance,
/// floor), and medians of iterations, rho and floor.
std::string MassTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers, double tolerance);

}  // namespace lcpbench
