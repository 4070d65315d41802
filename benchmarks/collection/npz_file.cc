#include "benchmarks/collection/npz_file.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "solvers/io/qps_text.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they stand");

// Little-endian numbers of 2 and 4 bytes.
std::string Bytes2(std::uint32_t value) {
  return {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
}
std::string Bytes4(std::uint32_t value) { return Bytes2(value & 0xffff) + Bytes2(value >> 16); }

// Without zlib's header and check sum, as zip has it.
std::string Deflated(std::string_view bytes) {
  constexpr std::size_t kHeader = 2, kCheckSum = 4;
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
               bytes.size()) != Z_OK) {
    throw std::runtime_error("zlib's compress failed");
  }
  return packed.substr(kHeader, size - kHeader - kCheckSum);
}

// A zip archive. [PKWARE, .ZIP file format specification 6.3]
class Archive {
 public:
  void Add(const std::string& name, const std::string& bytes) {
    constexpr std::uint32_t kVersion = 20, kDeflated = 8, kFirstOf1980 = 0x21;
    const std::string packed = Deflated(bytes);
    const auto check =
        static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
    const std::string facts = Bytes2(kVersion) + Bytes2(0) + Bytes2(kDeflated) + Bytes2(0) + Bytes2(kFirstOf1980) +
                              Bytes4(check) + Bytes4(static_cast<std::uint32_t>(packed.size())) +
                              Bytes4(static_cast<std::uint32_t>(bytes.size())) +
                              Bytes2(static_cast<std::uint32_t>(name.size())) + Bytes2(0);
    directory_ += "PK\1\2" + Bytes2(kVersion) + facts + Bytes2(0) + Bytes2(0) + Bytes2(0) + Bytes4(0) +
                  Bytes4(static_cast<std::uint32_t>(bytes_.size())) + name;
    bytes_ += "PK\3\4" + facts + name;
    bytes_ += packed;
    ++count_;
  }
  std::string Finish() && {
    const auto start = static_cast<std::uint32_t>(bytes_.size());
    bytes_ += directory_ + "PK\5\6" + Bytes4(0) + Bytes2(count_) + Bytes2(count_) +
              Bytes4(static_cast<std::uint32_t>(directory_.size())) + Bytes4(start) + Bytes2(0);
    return std::move(bytes_);
  }

 private:
  std::string bytes_, directory_;
  std::uint32_t count_ = 0;
};

// An array of numpy's format 1.0.
std::string Array(const std::string& type, const std::string& shape, std::string_view values) {
  constexpr std::size_t kAlignment = 64, kPrelude = 10;
  std::string header = "{'descr': '" + type + "', 'fortran_order': True, 'shape': (" + shape + "), }";
  header.append(kAlignment - (kPrelude + header.size() + 1) % kAlignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\1\0", kPrelude - 2);
  bytes += Bytes2(static_cast<std::uint32_t>(header.size())) + header;
  bytes += values;
  return bytes;
}

std::string_view BytesOf(const double* values, Index count) {
  return {reinterpret_cast<const char*>(values), sizeof(double) * static_cast<std::size_t>(count)};
}

}  // namespace

void WriteNpzProblem(const LcpProblem& problem, const std::string& path) {
  constexpr Index kMostRows = 23'000;
  const Index n = problem.size();
  RequireQp(problem);
  if (n > kMostRows) {
    throw InputError("problem '" + problem.id() + "': expected at most " + std::to_string(kMostRows) +
                     " rows, for the 4 GB of the format, found " + std::to_string(n));
  }
  const Eigen::MatrixXd& P = problem.DenseA();
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(n);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::VectorXd upper = Eigen::VectorXd::Constant(n, kInfinity);
  for (const Index row : problem.bilateral_rows()) lower[row] = -kInfinity;
  for (const BoundedRow& row : problem.bounded_rows()) {
    lower[row.row] = row.lower;
    upper[row.row] = row.upper;
  }
  const std::string numbers = "<f8", size = std::to_string(n);
  const std::string none = Array("|O", "", "\x80\x03N.");
  Archive archive;
  archive.Add("P.npy", Array(numbers, size + ", " + size, BytesOf(P.data(), P.size())));
  archive.Add("q.npy", Array(numbers, size + ",", BytesOf(problem.b().data(), n)));
  for (const char* name : {"G", "h", "A", "b"}) archive.Add(std::string(name) + ".npy", none);
  archive.Add("lb.npy", Array(numbers, size + ",", BytesOf(lower.data(), n)));
  archive.Add("ub.npy", problem.bounded_rows().empty() ? none : Array(numbers, size + ",", BytesOf(upper.data(), n)));
  WriteTextFile(path, std::move(archive).Finish());
}

}  // namespace lcpbench
