"""The worker's process of a campaign whose solver is a function of another process: hands its socket over to that one,
and stays until it is done. By path, so that nothing else is loaded: _relay.py ADDRESS NAME.
"""

import socket
import sys

with socket.socket(socket.AF_UNIX) as link:
    link.connect(sys.argv[1])
    socket.send_fds(link, [sys.argv[2].encode()], [sys.stdin.fileno()])
    link.recv(1)
