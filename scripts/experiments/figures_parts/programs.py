"""Our programs, and their streams as text."""

import subprocess

import target


def run(name, *words, stdin=""):
    """The output of a program, as bytes."""
    given = stdin if isinstance(stdin, bytes) else stdin.encode()
    command = [target.PROGRAMS / name, *map(str, words)]
    done = subprocess.run(command, input=given, capture_output=True)
    if done.returncode:
        raise SystemExit(f"{name} {' '.join(map(str, words))}: {done.stderr.decode().strip()}")
    return done.stdout


def text_twin(stream):
    """The lines of the text twin of a stream."""
    return run("spconvert", "--quiet", "--to", "text", stdin=stream).decode().splitlines()
