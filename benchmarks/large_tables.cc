#include "benchmarks/large_tables.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "benchmarks/campaign/median_interval.h"
#include "benchmarks/csv.h"
#include "benchmarks/growth_report.h"

namespace lcpbench {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  constexpr int kLongest = 512;
  char text[kLongest];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// "-" for what is not there, which is negative.
std::string Shown(const char* format, double value) { return value < 0 ? "-" : Format(format, value); }

std::string Cell(double value) { return value < 0 ? "" : CsvWriter::Cell(value); }

// "median (most)"
std::string MedianAndMost(const std::vector<double>& values) {
  if (values.empty()) return "-";
  return Format("%.3g (%.3g)", MedianOf(values), *std::max_element(values.begin(), values.end()));
}

std::vector<int> Sizes(const std::vector<LargeRow>& rows) {
  std::set<int> sizes;
  for (const LargeRow& row : rows) sizes.insert(row.problem.size);
  return {sizes.begin(), sizes.end()};
}

std::vector<std::string> Families(const std::vector<LargeRow>& rows) {
  std::vector<std::string> families;
  for (const LargeRow& row : rows) {
    if (std::find(families.begin(), families.end(), row.problem.family) == families.end()) {
      families.push_back(row.problem.family);
    }
  }
  return families;
}

std::string Table(const std::string& title, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < head.size(); ++column) {
    widths.push_back(head[column].size());
    for (const auto& line : lines) widths[column] = std::max(widths[column], line[column].size());
  }
  const auto row = [&](const std::vector<std::string>& cells, char fill) {
    std::string text = "|";
    for (std::size_t column = 0; column < cells.size(); ++column) {
      const std::string space(widths[column] - cells[column].size(), fill);
      text += " " + (column == 0 ? cells[column] + space : space + cells[column]) + " |";
    }
    return text + "\n";
  };
  std::string text = "\n" + title + "\n\n" + row(head, ' ');
  text += row(std::vector<std::string>(head.size(), ""), '-');
  for (const auto& line : lines) text += row(line, ' ');
  return text;
}

// A column of the files and of the table that is printed row by row.
struct Column {
  const char* name;
  std::string (*cell)(const LargeRow& row);
  int width = 0;  // of the printed table; negative: flush left
};

template <double Factorisation::*member>
std::string OfK(const LargeRow& row) {
  return row.oracle.has_value() ? Cell(row.oracle->best.*member) : "";
}

const Column kCsvColumns[] = {
    {"family", [](const LargeRow& row) { return row.problem.family; }},
    {"n", [](const LargeRow& row) { return std::to_string(row.problem.size); }},
    {"seed", [](const LargeRow& row) { return std::to_string(row.problem.seed); }},
    {"mass_ratio", [](const LargeRow& row) { return Cell(row.problem.mass_ratio); }},
    {"solver", [](const LargeRow& row) { return row.solver; }},
    {"bodies", [](const LargeRow& row) { return row.oracle ? std::to_string(row.oracle->bodies) : ""; }},
    {"active", [](const LargeRow& row) { return row.oracle ? std::to_string(row.oracle->active) : ""; }},
    {"k_s", [](const LargeRow& row) { return row.oracle ? Cell(row.oracle->best.total_s()) : ""; }},
    {"k_how", [](const LargeRow& row) { return row.oracle ? row.oracle->best.name : row.why_no_k; }},
    {"k_order_s", OfK<&Factorisation::order_s>},
    {"k_analyse_s", OfK<&Factorisation::analyse_s>},
    {"k_factor_s", OfK<&Factorisation::factor_s>},
    {"k_solve_s", OfK<&Factorisation::solve_s>},
    {"k_fill", OfK<&Factorisation::fill>},
    {"k_flops", OfK<&Factorisation::flops>},
    {"contact_s", [](const LargeRow& row) { return row.oracle ? Cell(row.oracle->contact_s) : ""; }},
    {"setup_s", [](const LargeRow& row) { return Cell(row.outcome.setup_s); }},
    {"solve_s", [](const LargeRow& row) { return Cell(row.outcome.solve_s); }},
    {"in_k", [](const LargeRow& row) { return Cell(row.in_k()); }},
    {"iterations",
     [](const LargeRow& row) { return row.outcome.iterations < 0 ? "" : std::to_string(row.outcome.iterations); }},
    {"rho", [](const LargeRow& row) { return Cell(row.outcome.rho); }},
    {"floor", [](const LargeRow& row) { return Cell(row.outcome.floor); }},
    {"backward_error", [](const LargeRow& row) { return Cell(row.outcome.backward_error); }},
    {"verdict", [](const LargeRow& row) { return row.outcome.verdict; }},
    {"detail", [](const LargeRow& row) { return row.outcome.detail; }},
    {"peak_bytes", [](const LargeRow& row) { return Cell(row.outcome.peak_bytes); }},
};

const Column kPrintedColumns[] = {
    {"family", [](const LargeRow& row) { return row.problem.family; }, -16},
    {"n", [](const LargeRow& row) { return std::to_string(row.problem.size); }, 7},
    {"seed", [](const LargeRow& row) { return std::to_string(row.problem.seed); }, 4},
    {"masses", [](const LargeRow& row) { return Format("%g", row.problem.mass_ratio); }, 6},
    {"solver", [](const LargeRow& row) { return row.solver; }, -18},
    {"bodies", [](const LargeRow& row) { return row.oracle ? std::to_string(row.oracle->bodies) : "-"; }, 7},
    {"K [ms]", [](const LargeRow& row) { return row.oracle ? Format("%.2f", 1e3 * row.oracle->best.total_s()) : "-"; },
     9},
    {"set-up", [](const LargeRow& row) { return Shown("%.2f", 1e3 * row.outcome.setup_s); }, 9},
    {"solve [ms]", [](const LargeRow& row) { return Shown("%.2f", 1e3 * row.outcome.solve_s); }, 10},
    {"in K", [](const LargeRow& row) { return Shown("%.1f", row.in_k()); }, 8},
    {"iter.", [](const LargeRow& row) { return Shown("%.0f", static_cast<double>(row.outcome.iterations)); }, 7},
    {"rho", [](const LargeRow& row) { return Shown("%.1e", row.outcome.rho); }, 8},
    {"floor", [](const LargeRow& row) { return Shown("%.1e", row.outcome.floor); }, 8},
    {"MB", [](const LargeRow& row) { return Shown("%.0f", 1e-6 * row.outcome.peak_bytes); }, 7},
    {"verdict",
     [](const LargeRow& row) {
       return row.outcome.verdict + (row.outcome.detail.empty() ? "" : ": " + row.outcome.detail);
     },
     -8},
};

std::string PrintedCell(const Column& column, const std::string& text, char fill) {
  const auto width = static_cast<std::size_t>(std::abs(column.width));
  const std::string space(width > text.size() ? width - text.size() : 0, fill);
  return " " + (column.width < 0 ? text + space : space + text) + " |";
}

}  // namespace

std::vector<std::string> CsvColumns() {
  std::vector<std::string> names;
  for (const Column& column : kCsvColumns) names.emplace_back(column.name);
  return names;
}

std::vector<std::string> CsvCells(const LargeRow& row) {
  std::vector<std::string> cells;
  for (const Column& column : kCsvColumns) cells.push_back(column.cell(row));
  return cells;
}

std::string MarkdownHead() {
  std::string names = "|";
  std::string line = "|";
  for (const Column& column : kPrintedColumns) {
    names += PrintedCell(column, column.name, ' ');
    line += PrintedCell(column, "", '-');
  }
  return names + "\n" + line + "\n";
}

std::string MarkdownRow(const LargeRow& row) {
  std::string line = "|";
  for (const Column& column : kPrintedColumns) line += PrintedCell(column, column.cell(row), ' ');
  return line + "\n";
}

std::string VerifiedTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers) {
  std::vector<std::string> head = {"solver"};
  std::vector<std::vector<std::string>> lines;
  for (const int size : Sizes(rows)) head.push_back("n = " + std::to_string(size));
  for (const std::string& solver : solvers) {
    lines.push_back({solver});
    for (const int size : Sizes(rows)) {
      int verified = 0;
      int all = 0;
      std::vector<double> in_k;
      for (const LargeRow& row : rows) {
        if (row.solver != solver || row.problem.size != size) continue;
        ++all;
        if (row.outcome.verified) ++verified;
        if (row.in_k() >= 0) in_k.push_back(row.in_k());
      }
      lines.back().push_back(Format("%d/%d, %s K", verified, all, MedianAndMost(in_k).c_str()));
    }
  }
  return Table("Verified of all, and median (most) of (set-up + solve) / K", head, lines);
}

std::string ExponentTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers) {
  std::vector<std::string> head = {"family"};
  head.insert(head.end(), solvers.begin(), solvers.end());
  std::vector<std::vector<std::string>> lines;
  for (const std::string& family : Families(rows)) {
    lines.push_back({family});
    for (const std::string& solver : solvers) {
      SizeSeries series;
      for (const int size : Sizes(rows)) {
        if (size < kLeastForExponent) continue;
        std::vector<double> times;
        bool all_verified = true;
        for (const LargeRow& row : rows) {
          if (row.solver != solver || row.problem.size != size || row.problem.family != family) continue;
          all_verified = all_verified && row.outcome.verified;
          times.push_back(row.total_s());
        }
        if (all_verified && !times.empty()) series.points.push_back({static_cast<double>(size), MedianOf(times)});
      }
      lines.back().push_back(series.points.size() > 1 ? Format("%.2f", series.Exponent()) : "-");
    }
  }
  return Table("p of time ~ n^p from n = 10000 on", head, lines);
}

std::string PeerTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers,
                      const std::vector<std::string>& peers) {
  using Key = std::tuple<std::string, int, std::uint64_t, double>;
  const auto key = [](const LargeProblem& p) { return Key{p.family, p.size, p.seed, p.mass_ratio}; };
  std::map<Key, double> fastest;
  for (const LargeRow& row : rows) {
    if (!row.outcome.verified || std::find(peers.begin(), peers.end(), row.solver) == peers.end()) continue;
    const auto [it, is_new] = fastest.try_emplace(key(row.problem), row.total_s());
    if (!is_new) it->second = std::min(it->second, row.total_s());
  }
  std::vector<std::string> head = {"solver"};
  for (const int size : Sizes(rows)) head.push_back("n = " + std::to_string(size));
  std::vector<std::vector<std::string>> lines;
  for (const std::string& solver : solvers) {
    lines.push_back({solver});
    for (const int size : Sizes(rows)) {
      std::vector<double> ratios;
      for (const LargeRow& row : rows) {
        if (row.solver != solver || row.problem.size != size || !row.outcome.verified) continue;
        const auto peer = fastest.find(key(row.problem));
        if (peer != fastest.end()) ratios.push_back(row.total_s() / peer->second);
      }
      lines.back().push_back(MedianAndMost(ratios) + Format(" of %zu", ratios.size()));
    }
  }
  return Table("(Set-up + solve) / solve of the fastest verified peer: median (most) of problems", head, lines);
}

std::string MassTable(const std::vector<LargeRow>& rows, const std::vector<std::string>& solvers, double tolerance) {
  std::vector<std::string> head = {"solver",   "family",     "n",   "mass ratio", "verified",
                                   "at floor", "iterations", "rho", "floor"};
  std::vector<std::vector<std::string>> lines;
  std::set<double> ratios;
  for (const LargeRow& row : rows) ratios.insert(row.problem.mass_ratio);
  for (const std::string& solver : solvers) {
    for (const std::string& family : Families(rows)) {
      for (const int size : Sizes(rows)) {
        for (const double ratio : ratios) {
          int all = 0;
          int verified = 0;
          int at_floor = 0;
          std::vector<double> iterations;
          std::vector<double> rho;
          std::vector<double> floor;
          for (const LargeRow& row : rows) {
            if (row.solver != solver || row.problem.family != family || row.problem.size != size ||
                row.problem.mass_ratio != ratio) {
              continue;
            }
            const SolveOutcome& o = row.outcome;
            ++all;
            if (o.verified) ++verified;
            if (o.rho >= 0 && o.rho <= std::max(tolerance, o.floor)) ++at_floor;
            if (o.iterations >= 0) iterations.push_back(static_cast<double>(o.iterations));
            if (o.rho >= 0) rho.push_back(o.rho);
            if (o.floor >= 0) floor.push_back(o.floor);
          }
          if (all == 0) continue;
          const auto median = [](const char* format, const std::vector<double>& values) {
            return values.empty() ? std::string("-") : Format(format, MedianOf(values));
          };
          lines.push_back({solver, family, std::to_string(size), Format("%g", ratio), Format("%d/%d", verified, all),
                           Format("%d/%d", at_floor, all), median("%.0f", iterations), median("%.1e", rho),
                           median("%.1e", floor)});
        }
      }
    }
  }
  return Table("Mass ratios: verified, rho <= max(tolerance, floor), and medians over seeds", head, lines);
}

}  // namespace lcpbench
