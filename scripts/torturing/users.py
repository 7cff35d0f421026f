"""Another user, whom limits and permissions bind when they do not bind root."""

import os
import subprocess

# No one else's processes count against the limits of this user.
USER = 61_873


def find(program):
    """The number of a user without rights who can run `program`, or None."""
    if os.geteuid() != 0:
        return None
    try:
        done = subprocess.run(
            [program, "--version"], preexec_fn=become(USER), capture_output=True, check=False
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return USER if done.returncode == 0 else None


def become(user):
    """What makes a process one of that user."""

    def before():
        os.setgroups([])
        os.setgid(user)
        os.setuid(user)

    return before


def give(folder, user):
    """Makes a folder and all in it those of a user."""
    for path, _, files in os.walk(folder):
        os.chown(path, user, user)
        for file in files:
            os.chown(os.path.join(path, file), user, user, follow_symlinks=False)
    # So that the user can reach it.
    for above in (folder.parent, folder.parent.parent):
        os.chmod(above, 0o755)
