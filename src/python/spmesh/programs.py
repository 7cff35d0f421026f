"""Runs the programs of the project, alone or in pipes, without a shell."""

from __future__ import annotations

import logging
import os
import shutil
import signal
import subprocess
import sysconfig
import tempfile
import threading
import warnings
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, BinaryIO, Callable, Sequence, Union, cast

from .errors import SpmeshError
from .output import OutputFile
from .types import Buffer, FilePath

if TYPE_CHECKING:
    import numpy.typing as npt

# The program and its arguments. Paths (`pathlib.Path`) are names of files: those that start with "-" are no
# flags.
Command = Sequence[Union[str, int, float, "os.PathLike[str]"]]
# Bytes, what writes them into an open file, or an array of points (n, 2) or (n, 3).
Input = Union[Buffer, Callable[[BinaryIO], object], "npt.NDArray[Any]"]

# A program whose reader went away says so with one of these: it is never the cause of a failure.
CLOSED = (141, -signal.SIGPIPE)
# The output is complete but for points that inputs lost.
SALVAGED = 7
# Seconds until a program that was asked to end, and to remove its temporary files, is killed.
PATIENCE_S = 10.0

_log = logging.getLogger("spmesh")


class ProgramError(RuntimeError):
    """A program failed: `program` is its name, `code` its exit code (see README.md), `message` what it wrote
    to stderr.

    A negative code is the number of the signal that ended it. Of a pipe, it is the program that caused the
    failure.
    """

    def __init__(self, program: str, code: int, message: str):
        super().__init__(program, code, message)
        self.program, self.code, self.message = program, code, message

    def __str__(self) -> str:
        ended = f"was ended by signal {-self.code}" if self.code < 0 else f"failed with exit code {self.code}"
        return f"{self.program} {ended}" + (f": {self.message}" if self.message else "")


class ProgramNotFoundError(FileNotFoundError):
    """A program is in none of the places where it is looked for."""


def find(program: str) -> Path:
    """The path of a program: in the folder that SPMESH_BIN names, beside the interpreter, or on PATH.

    Raises ProgramNotFoundError, which says how to install the programs.

        spmesh.programs.find("spdelaunay2d")
    """
    stated = os.environ.get("SPMESH_BIN")
    places = [stated] if stated else [sysconfig.get_path("scripts"), os.environ.get("PATH", os.defpath)]
    for place in places:
        if found := shutil.which(program, path=place):
            return Path(found).absolute()
    where = f"the folder of SPMESH_BIN, {stated}" if stated else "PATH, or beside the interpreter"
    raise ProgramNotFoundError(
        f"{program} is not in {where}. Install the programs with `cargo install --locked --path .` or "
        "`pip install ./src/python/wheel` in the source of spmesh, or let SPMESH_BIN name their folder"
    )


def argument(name: FilePath) -> str:
    """The name of a file as an argument that no program takes for a flag, or for stdin."""
    text = os.fspath(name)
    return os.path.join(".", text) if text.startswith("-") else text


def run(*commands: Command, input: Input | None = None, output: FilePath | None = None) -> bytes:
    """Runs a program, or several in a pipe, and returns what the last one writes to stdout.

    Each command is a list: the program, and its arguments. `pathlib.Path`s are names of files, also if they
    start with "-". `input` goes to stdin of the first: bytes, an array of points, which `spfinalize` reads,
    or a function that writes into the open file it is given, in a thread of its own. With `output`, stdout
    goes to this file instead, which gets its name when all programs have succeeded.

    Raises ProgramError, ProgramNotFoundError, OSError, and what `input` raises. After any exception,
    KeyboardInterrupt included, no program runs on, and `output` is what it was. Notices of programs go to the
    logger "spmesh".

        spmesh.programs.run(["spfinalize", Path("tile.laz")], ["spdelaunay2d"], output="terrain.spm")
    """
    if output is None:
        with Pipe(*commands, input=input) as pipe:
            return pipe.stdout.read()
    file = OutputFile(output)
    try:
        with Pipe(*commands, input=input, output=file):
            pass
        file.commit()
    finally:
        file.close()
    return b""


class Pipe:
    """Programs that run in a pipe while the block of `with` reads `stdout`, an open binary file.

    At the end of the block, all programs have ended. Its exceptions are those of `run`. If the block ends
    before the output does, the programs are stopped without an error. If it fails on what it reads, and a
    program has failed, ProgramError is raised, for that is the cause.

        with spmesh.programs.Pipe(["spfinalize", Path("tile.laz")], ["spdelaunay2d"]) as pipe:
            for block in spmesh.open(pipe.stdout):
                ...
    """

    def __init__(self, *commands: Command, input: Input | None = None, output: OutputFile | None = None):
        if not commands or not all(commands):
            raise ValueError("no program is given")
        self._commands = [_words(command) for command in commands]
        self._input, self._output = input, output
        self._processes: list[subprocess.Popen[bytes]] = []
        self._messages: list[IO[bytes]] = []
        self._feeder: threading.Thread | None = None
        self._fed: BaseException | None = None

    @property
    def stdout(self) -> BinaryIO:
        """What the last program writes."""
        return cast(BinaryIO, self._processes[-1].stdout)

    def __enter__(self) -> Pipe:
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(self, kind: object, failure: BaseException | None, trace: object) -> None:
        try:
            if failure is None or isinstance(failure, SpmeshError):
                self._end(failure)
        finally:
            self._stop()

    def _start(self) -> None:
        source: int | IO[bytes] | None = subprocess.DEVNULL if self._input is None else subprocess.PIPE
        for number, words in enumerate(self._commands):
            is_last = number == len(self._commands) - 1
            target = self._output.fileno() if is_last and self._output else subprocess.PIPE
            self._messages.append(tempfile.TemporaryFile())
            process = subprocess.Popen(words, stdin=source, stdout=target, stderr=self._messages[-1])
            if self._processes and self._processes[-1].stdout:
                # Only the next program reads from it now.
                self._processes[-1].stdout.close()
            self._processes.append(process)
            source = process.stdout
        if self._input is not None:
            self._feeder = threading.Thread(target=self._feed, daemon=True)
            self._feeder.start()

    def _feed(self) -> None:
        stdin = cast(BinaryIO, self._processes[0].stdin)
        try:
            if callable(self._input):
                self._input(stdin)
            elif isinstance(self._input, (bytes, bytearray, memoryview)):
                stdin.write(self._input)
            else:
                from .meshes import write_points

                write_points(stdin, cast("npt.NDArray[Any]", self._input))
            stdin.close()
        except BrokenPipeError:
            # The program does not read on: its exit code says why.
            pass
        except BaseException as error:
            self._fed = error
            # The program must not take what it has got for a whole input.
            _terminate(self._processes)
        finally:
            try:
                stdin.close()
            except OSError:
                pass

    def _end(self, failure: SpmeshError | None) -> None:
        """Waits for the programs, and raises what made them fail."""
        stdout = self._processes[-1].stdout
        if stdout:
            stdout.close()
        codes = [process.wait() for process in self._processes]
        if self._feeder:
            self._feeder.join()
        if self._fed is not None:
            raise self._fed
        texts = [_text(file) for file in self._messages]
        for words, code, text in zip(self._commands, codes, texts):
            if code not in (0, SALVAGED, *CLOSED):
                raise ProgramError(os.path.basename(words[0]), code, _message(words[0], text)) from failure
        for words, code, text in zip(self._commands, codes, texts):
            if code == SALVAGED:
                warnings.warn(f"{os.path.basename(words[0])}: {_message(words[0], text)}", stacklevel=4)
            elif text:
                _log.info("%s", text)

    def _stop(self) -> None:
        """Ends what still runs. Programs remove their temporary files when they are asked to end."""
        _terminate(self._processes)
        for process in self._processes:
            try:
                process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdout:
                process.stdout.close()
        if self._feeder:
            # It cannot be interrupted while it waits for something else than the program.
            self._feeder.join(PATIENCE_S)
        for file in self._messages:
            file.close()


def _words(command: Command) -> list[str]:
    """The words of a command. Names of files do not look like flags."""
    program, *arguments = command
    words = [argument(word) if isinstance(word, os.PathLike) else str(word) for word in arguments]
    return [str(find(str(program))), *words]


def _terminate(processes: list[subprocess.Popen[bytes]]) -> None:
    for process in processes:
        if process.poll() is None:
            process.terminate()


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode(errors="replace").strip()


def _message(program: str, text: str) -> str:
    """What a program says, without its name."""
    name = os.path.basename(program)
    return "\n".join(line.removeprefix(f"{name}: ") for line in text.splitlines())
