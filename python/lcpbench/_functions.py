"""Functions of this process as solvers of a campaign, which runs in processes of its own.

Every worker of the campaign is a relay (_relay.py) that hands its socket over. From then on the campaign talks to a
thread of this process, in C++ but for the calls of the function.
"""

import contextlib
import ctypes
import inspect
import os
import platform
import shlex
import socket
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

from . import _core

_WAIT = 10  # for threads at the end [s]


class _Stopped(BaseException):
    """The campaign has given up a function that took too long."""


def _empty(problem):
    return problem.b


def _with_tolerance(name: str, function: Callable) -> Callable:
    """The function as it is called: (problem, tolerance)."""
    try:
        signature = inspect.signature(function)
    except ValueError:  # it has none
        return lambda problem, tolerance: function(problem)
    takes_tolerance = "tolerance" in signature.parameters
    try:
        signature.bind(None, **{"tolerance": None} if takes_tolerance else {})
    except TypeError:
        raise ValueError(f"solvers: {name}: expected a function of (problem) or (problem, tolerance)") from None
    if takes_tolerance:
        return lambda problem, tolerance: function(problem, tolerance=tolerance)
    return lambda problem, tolerance: function(problem)


class FunctionServer:
    """Serves functions, by name, while it is open.

    costs  by name: rows of a problem and seconds of a call that does nothing, as often as it was measured
    """

    def __init__(self, functions: dict[str, Callable]):
        self._functions = {name: _with_tolerance(name, function) for name, function in functions.items()}
        self.costs: dict[str, list[tuple[int, float]]] = {name: [] for name in functions}
        self._threads: list[threading.Thread] = []

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="lcpbench-")
        self._address = os.path.join(self._folder.name, "functions")
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(self._address)
        self._listener.listen()
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_):
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for thread in self._threads:
            thread.join(_WAIT)
        self._folder.cleanup()

    def command(self, name: str) -> str:
        """The worker of a function, for the option --external."""
        relay = str(Path(__file__).with_name("_relay.py"))
        return shlex.join([sys.executable, "-I", "-S", relay, self._address, name])

    def _accept(self) -> None:
        while True:
            try:
                link, _ = self._listener.accept()
            except OSError:  # closed
                return
            thread = threading.Thread(target=self._attend, args=(link,), daemon=True)
            self._threads.append(thread)
            thread.start()

    def _attend(self, link: socket.socket) -> None:
        """One relay: its function is served by a thread, which is stopped where the relay was killed."""
        with link:
            name, descriptors, _, _ = socket.recv_fds(link, 4096, 1)
            if not descriptors:
                return
            server = threading.Thread(target=self._serve, args=(link, descriptors[0], name.decode()), daemon=True)
            server.start()
            with contextlib.suppress(OSError):
                link.recv(1)
            server.join(1)
            while server.is_alive():
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(server.ident), ctypes.py_object(_Stopped))
                server.join(1)

    def _serve(self, link: socket.socket, descriptor: int, name: str) -> None:
        try:
            self.costs[name] += _core.serve(descriptor, name, f"Python {platform.python_version()}",
                                            self._functions[name], _with_tolerance("", _empty))
        except _Stopped:
            pass
        finally:
            os.close(descriptor)
            with contextlib.suppress(OSError):  # where it was killed
                link.shutdown(socket.SHUT_RDWR)  # ends the relay
