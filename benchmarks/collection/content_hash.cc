#include "benchmarks/collection/content_hash.h"

#include <openssl/evp.h>

#include <bit>
#include <boost/algorithm/hex.hpp>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "hashes are of little-endian numbers");

// What is hashed, byte by byte.
class HashedBytes {
 public:
  void Add(std::int64_t value) { AddAll(&value, 1); }
  template <typename Number>
  void AddAll(const Number* numbers, Index count) {
    text_.append(reinterpret_cast<const char*>(numbers), sizeof(Number) * static_cast<size_t>(count));
  }
  void Add(std::string_view text) { text_ += text; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void AddMatrix(const SparseMatrix& matrix, HashedBytes* hash) {
  hash->Add(matrix.rows());
  hash->Add(matrix.cols());
  for (Index i = 0; i < matrix.rows(); ++i) hash->Add(matrix.innerVector(i).nonZeros());
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      hash->Add(it.col());
      const double value = it.value();
      hash->AddAll(&value, 1);
    }
  }
}

void AddLaws(const RowBounds& bounds, HashedBytes* hash) {
  hash->Add(static_cast<std::int64_t>(bounds.friction.size()));
  for (const FrictionRow& row : bounds.friction) {
    for (const std::int64_t value : {row.row, row.normal, Index{row.slip}}) hash->Add(value);
    hash->AddAll(&row.mu, 1);
  }
  hash->Add(static_cast<std::int64_t>(bounds.bounded.size()));
  for (const BoundedRow& row : bounds.bounded) {
    hash->Add(row.row);
    for (const double value : {row.lower, row.upper}) hash->AddAll(&value, 1);
  }
}

}  // namespace

std::string ContentHash(const LcpProblem& problem) {
  HashedBytes hash;
  hash.Add("lcpbench problem 1\n");
  hash.Add(problem.size());
  switch (problem.given_form()) {
    case MatrixForm::kDense: {
      hash.Add(std::int64_t{0});
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = problem.DenseA();
      hash.AddAll(rows.data(), rows.size());
      break;
    }
    case MatrixForm::kSparse:
      hash.Add(std::int64_t{1});
      AddMatrix(problem.SparseA(), &hash);
      break;
    case MatrixForm::kFactors:
      hash.Add(std::int64_t{2});
      AddMatrix(problem.J(), &hash);
      hash.AddAll(problem.inverse_mass().data(), problem.inverse_mass().size());
      break;
  }
  hash.AddAll(problem.b().data(), problem.b().size());
  hash.Add(static_cast<std::int64_t>(problem.bilateral_rows().size()));
  for (const Index row : problem.bilateral_rows()) hash.Add(row);
  if (!problem.is_plain()) AddLaws(problem.bounds(), &hash);
  return TextHash(hash.text());
}

std::string TextHash(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  if (EVP_Digest(text.data(), text.size(), digest, &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("libcrypto does not provide SHA-256");
  }
  std::string digits;
  boost::algorithm::hex_lower(digest, digest + length, std::back_inserter(digits));
  return digits;
}

std::string SequenceHash::Result() const { return TextHash(text_); }

}  // namespace lcpbench
