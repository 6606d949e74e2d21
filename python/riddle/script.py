"""What a script with a figure needs beside the modules of the headers: its options, one line for what goes wrong, files
whole or absent.

    from riddle import script

    OPTIONS = script.options(__doc__)        # --quick, --out DIR, --help; anything else is refused in one line, with
                                             status 2
    ...
    script.save(figure, OPTIONS, "hopper.png")
"""
import argparse
import atexit
import os
import sys

from ._core import Error


def _say(text):
    name = os.path.basename(sys.argv[0])
    line = "".join(c if c.isprintable() else "?" for c in f"{name}: {text}")
    print(line.encode(errors="replace").decode(errors="replace"), file=sys.stderr)


def _flush():
    """What was printed, at the end: a full device is told, with status 1. A pipe that nobody reads any more: silent,
    status 141."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        os._exit(141)
    except OSError as error:
        _say(f"standard output: {error}")
        os._exit(1)


def _one_line(kind, error, trace):
    """In place of a traceback, where that would tell a user nothing. Ctrl-C: status 130."""
    if issubclass(kind, KeyboardInterrupt):
        _say("interrupted")
        _flush()
        os._exit(130)
    elif issubclass(kind, BrokenPipeError):
        os._exit(141)
    elif issubclass(kind, (OSError, MemoryError, Error)):
        _say(str(error) or "out of memory")
    else:
        sys.__excepthook__(kind, error, trace)


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        _say(f"{message}; --help lists the options")
        sys.exit(2)


def options(about):
    """Reads the command line: .quick (True: a small run), .out (the folder for files, made if it is not there). about:
    the text of --help."""
    parser = _Parser(description=about, allow_abbrev=False)
    parser.add_argument("--quick", action="store_true", help="a small run, of a few seconds")
    parser.add_argument("--out", metavar="DIR", default=".", help="folder for what is written; default: where you are")
    given = parser.parse_args()
    sys.excepthook = _one_line
    atexit.register(_flush)
    try:
        os.makedirs(given.out, exist_ok=True)
        free = os.access(given.out, os.W_OK)
    except OSError:
        free = False
    if not free:
        parser.error(f"--out {given.out}: allowed: a folder that can be written to")
    return given


def save(figure, given, name, **keywords):
    """Writes a figure of matplotlib into the folder of --out under its name, whole or not at all."""
    target = os.path.join(given.out, name)
    part = f"{target}.part"
    try:
        figure.savefig(part, format=os.path.splitext(name)[1][1:], **keywords)
        os.replace(part, target)
    finally:
        if os.path.exists(part):
            os.remove(part)
