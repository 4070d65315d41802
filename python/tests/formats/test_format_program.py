"""The program beside the command: requests and answers, limits of the process that reads a file, names and options."""

import gzip
import json
import os
import resource
import signal
import struct
import subprocess
import time

import numpy as np
from stored_problems import ROOT, FormatTest, StoredProblem, difference, formats, generated, program

_PROGRAM = ["/usr/bin/python3", str(ROOT / "python/lcpbench/formats")]


class FormatProgram(FormatTest):
    def ask(self, *requests):
        """@param requests  each a record, and bytes behind it"""
        sent = b"".join(json.dumps(record).encode() + b"\n" + more for record, more in requests)
        done = subprocess.run(_PROGRAM, input=sent, capture_output=True, check=True, timeout=60)
        self.assertEqual(done.stderr, b"")
        answers, at = [], 0
        while at < len(done.stdout):
            size = struct.unpack_from("<Q", done.stdout, at + 1)[0]
            answers.append((done.stdout[at:at + 1], done.stdout[at + 9:at + 9 + size]))
            at += 9 + size
        self.assertEqual(len(answers), len(requests))
        return answers

    def read_request(self, path, **options):
        return {"read": len(bytes(path)), "options": options}, bytes(path)

    def test_problems_go_both_ways_bit_for_bit(self):
        problems = list(generated(12))
        for k, problem in enumerate(problems):
            formats.save(problem, self.folder / f"{k}.hdf5")
        paths = [self.folder / f"{k}.hdf5" for k in range(len(problems))]
        answers = self.ask(*map(self.read_request, paths))
        writes = []
        for problem, path, (kind, answer) in zip(problems, paths, answers, strict=True):
            self.assertEqual(kind, b"+")
            read = program.from_record(json.loads(answer))
            self.assertEqual(difference(read, formats.load(path)[0]), "")
            record = json.loads(answer)
            if "A" not in record:  # the command adds it
                A = problem.entries().tocoo()
                record["A"] = {"shape": A.shape, "row": A.row.tolist(), "col": A.col.tolist(), "val": A.data.tolist()}
            writes.append(({"write": "hdf5", "is_dense": False, "problem": record}, b""))
        for path, (kind, answer) in zip(paths, self.ask(*writes), strict=True):
            self.assertEqual((kind, answer), (b"+", path.read_bytes()))

    def test_refusals_are_answers_and_the_next_request_is_taken(self):
        good, wrong = self.folder / "good.dat", self.folder / "wrong.dat"
        good.write_text("1 0 1 1 1 1 2 -1")
        wrong.write_text("1 0 1 1 1 1 x -1")
        answers = self.ask(self.read_request(wrong), self.read_request(self.folder / "absent.h5"), self.read_request(good))
        self.assertEqual([kind for kind, _ in answers], [b"-", b"-", b"+"])
        self.assertEqual(answers[0][1].decode(), f"{wrong}:1: expected number 1 of the 1 of a matrix to be finite, found 'x'")
        self.assertEqual(answers[1][1].decode(), f"{self.folder}/absent.h5: cannot be opened: No such file or directory")
        self.assertEqual(json.loads(answers[2][1]), {"id": "good", "b": [-1.0], "A": [[2.0]], "bilateral": []})

    def test_asymmetric_matrices_are_read_where_that_is_asked_for(self):
        P = [[4.0, 1.0 + 2.0**-50], [1.0, 3.0]]
        np.savez(self.folder / "p.npz", P=P, q=np.ones(2))
        asked = [self.read_request(self.folder / "p.npz", **options) for options in ({}, {"most_asymmetry": 1e-9})]
        (refused, said), (read, problem) = self.ask(*asked)
        self.assertEqual((refused, read, json.loads(problem)["A"]), (b"-", b"+", P))
        self.assertIn("--symmetrize", said.decode())

    def end(self, read):
        """How a confined process ends that reads so; None where it answers."""
        path = self.folder / "file.h5"
        path.write_bytes(bytes(1000))
        return program.confined(path, lambda: read(path), lambda kind, pieces: None)

    def test_a_process_that_reads_opens_one_file_and_writes_none(self):
        nothing = StoredProblem("nothing", np.zeros(0), A=np.zeros((0, 0)))

        def opens_once(path):
            with path.open("rb"):
                return nothing

        def opens_twice(path):
            with path.open("rb"), path.open("rb"):
                return nothing

        def writes(path):
            with path.open("wb") as file:
                file.write(b"x")
            return nothing
        before = [resource.getrlimit(kind) for kind in (resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_NOFILE)]
        self.assertIsNone(self.end(opens_once))
        self.assertEqual(self.end(opens_twice), "ended with exit status 1")
        self.assertRegex(self.end(writes), "was killed by signal 25|ended with exit status 1")
        self.assertEqual(self.end(lambda path: os.kill(os.getpid(), signal.SIGSEGV)), "was killed by signal 11 (Segmentation fault)")
        self.assertIsNone(self.end(lambda path: np.ones(1 << 33)))  # does not fit into memory: an answer
        self.assertEqual(before, [resource.getrlimit(kind) for kind in (resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_NOFILE)])

    def test_what_unpacks_to_more_than_the_memory_is_refused(self):
        """A line and an array of more than 100 MB, packed to less than one, with 64 MB of memory."""
        numbers, archive = self.folder / "numbers.dat.gz", self.folder / "p.npz"
        with gzip.open(numbers, "wb", compresslevel=1) as file:
            file.write(b"20000 0 20000 20000 20000 20000 ")
            for _ in range(1 << 5):
                file.write(b"1 " * (1 << 21))
        np.savez_compressed(archive, P=np.zeros((4000, 4000)), q=np.zeros(4000))
        for name, value in (("_available_memory", lambda: 0), ("_LEAST_MEMORY", 64 << 20)):
            self.addCleanup(setattr, program, name, getattr(program, name))
            setattr(program, name, value)
        for path in (numbers, archive):
            end = program.confined(path, lambda path=path: formats.load(path)[0], lambda kind, pieces: os._exit(42 if kind == b"-" else 43))
            self.assertEqual(end, "ended with exit status 42", path)  # that of a refusal

    def test_time_is_limited(self):
        before, program._LEAST_SECONDS = program._LEAST_SECONDS, 1
        self.addCleanup(setattr, program, "_LEAST_SECONDS", before)

        def endless():
            while True:
                time.process_time()
        (self.folder / "file.h5").write_bytes(b"")
        self.assertEqual(program.confined(self.folder / "file.h5", endless, lambda kind, pieces: None), "did not end in time")
