"""Describes the machine, the commit and the versions of a measurement."""

import datetime
import os
import pathlib
import platform
import subprocess

from target import ROOT


def line_of(*command):
    """First line that `command` prints, or nothing."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
        return (done.stdout.splitlines() or [""])[0]
    except (OSError, subprocess.CalledProcessError):
        return ""


def field_of(path, key):
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith(key):
            return line.split(":", 1)[1].strip()
    return ""


def commit():
    changed = "" if line_of("git", "status", "--porcelain") == "" else " with changes"
    return (line_of("git", "rev-parse", "--short=12", "HEAD") or "unknown") + changed


def memory_bytes():
    return int(field_of("/proc/meminfo", "MemTotal").split()[0]) * 1024


def describe():
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": commit(),
        "cpu": field_of("/proc/cpuinfo", "model name"),
        "cores": len(os.sched_getaffinity(0)),
        "memory_GiB": round(memory_bytes() / 2**30),
        "kernel": f"{platform.system()} {platform.release()}",
        "rustc": line_of("rustc", "--version"),
        "c++": line_of("g++", "--version"),
    }
