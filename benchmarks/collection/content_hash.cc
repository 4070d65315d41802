#include "benchmarks/collection/content_hash.h"

#include <openssl/evp.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "hashes are of little-endian numbers");

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) Fail();
  }
  void Add(std::string_view bytes) {
    if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) Fail();
  }
  void Add(std::int64_t value) { AddBytes(&value, 1); }
  template <typename Number>
  void AddBytes(const Number* numbers, Index count) {
    if (EVP_DigestUpdate(context_.get(), numbers, sizeof(Number) * static_cast<size_t>(count)) != 1) Fail();
  }
  std::string Digits() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    if (EVP_DigestFinal_ex(context_.get(), digest, &length) != 1) Fail();
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (unsigned int k = 0; k < length; ++k) {
      text += kDigits[digest[k] >> 4U];
      text += kDigits[digest[k] & 15U];
    }
    return text;
  }

 private:
  [[noreturn]] static void Fail() { throw std::runtime_error("SHA-256 is not to be had from libcrypto"); }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

void AddMatrix(const SparseMatrix& matrix, Sha256* hash) {
  hash->Add(matrix.rows());
  hash->Add(matrix.cols());
  for (Index i = 0; i < matrix.rows(); ++i) {
    std::int64_t count = 0;
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) ++count;
    hash->Add(count);
  }
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      hash->Add(it.col());
      const double value = it.value();
      hash->AddBytes(&value, 1);
    }
  }
}

}  // namespace

std::string ContentHash(const LcpProblem& problem) {
  if (!problem.has_standard_bounds()) throw std::logic_error("hashes are of unilateral and bilateral rows");
  Sha256 hash;
  hash.Add("lcpbench problem 1\n");
  hash.Add(problem.size());
  switch (problem.given_form()) {
    case MatrixForm::kDense: {
      hash.Add(std::int64_t{0});
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = problem.DenseA();
      hash.AddBytes(rows.data(), rows.size());
      break;
    }
    case MatrixForm::kSparse:
      hash.Add(std::int64_t{1});
      AddMatrix(problem.SparseA(), &hash);
      break;
    case MatrixForm::kFactors:
      hash.Add(std::int64_t{2});
      AddMatrix(problem.J(), &hash);
      hash.AddBytes(problem.inverse_mass().data(), problem.inverse_mass().size());
      break;
  }
  hash.AddBytes(problem.b().data(), problem.b().size());
  hash.Add(static_cast<std::int64_t>(problem.bilateral_rows().size()));
  for (const Index row : problem.bilateral_rows()) hash.Add(row);
  return hash.Digits();
}

std::string TextHash(const std::string& text) {
  Sha256 hash;
  hash.Add(std::string_view(text));
  return hash.Digits();
}

std::string SequenceHash::Result() const { return TextHash(text_); }

}  // namespace lcpbench
