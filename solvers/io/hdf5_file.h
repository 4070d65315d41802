#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lcpbench {

/// A dataset of rank 0 or 1: 32-bit integers, 64-bit IEEE numbers, or one text of fixed length.
using Hdf5Dataset = std::variant<std::vector<int>, std::vector<double>, std::string>;

/// Datasets by their paths in the file, "/group/name".
using Hdf5Datasets = std::vector<std::pair<std::string, Hdf5Dataset>>;

/// Those of the wanted datasets that the file holds, in the order asked for. A list that was created and never written
/// (it has no byte in the file, and libhdf5 would give fill values) is empty.
///
/// libhdf5 was not made for hostile files: it crashes on some, and allocates what others promise. So it runs in a
/// forked child, which may open no other file, write none, and whose memory and processor time are limited in
/// proportion to the file's size (memory not under sanitizers, which reserve more than any limit); datasets come back
/// through its socket. All of them together take no more memory than the file, whatever it promises. The child runs
/// libhdf5 after fork without exec, so that where other threads use libhdf5 themselves at that moment (its builds
/// without thread safety do not allow that anyhow) the child may fail or, until its time is up, hang; the caller's
/// memory is safe.
/// Refused are datasets of other types or ranks, in chunks, compressed, virtual or stored in other files, links that
/// are not hard, and datasets whose values the file does not hold.
/// @param wanted  paths, each with an empty value of the type that it must have
/// @param groups  "/name", of which the file must have one
/// @throws InputError `path: ...` naming the dataset, or the groups and what the file has instead, what was expected
/// and what was found; also where the file cannot be opened, is not HDF5, or crashes the child
Hdf5Datasets ReadHdf5(const std::string& path, const Hdf5Datasets& wanted, const std::vector<std::string>& groups);

/// Writes a new HDF5 file of these datasets and the groups of their paths, the same bytes for the same values. It takes
/// the place of a file of this name. Not for several threads at once.
/// Written as by WriteTextFile, with its errors
void WriteHdf5(const std::string& path, const Hdf5Datasets& datasets);

}  // namespace lcpbench
