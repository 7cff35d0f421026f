//! Incomplete files with names that killed processes have left behind.
//!
//! The names say which process made them: its number, and the machine and the namespace that this number is
//! of. So a process that is at work is never taken for a dead one, whatever machines share a file system.

use std::ffi::OsStr;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use rustix::io::Errno;
use rustix::process::{Pid, test_kill_process};

use crate::output::open_unnamed;

/// Prefix of the name of an incomplete file, if it needs a name.
pub(crate) const PREFIX: &str = ".spmesh-";

/// The prefix of such names of this process.
pub(crate) fn own_prefix() -> String {
    machine().map_or_else(|| PREFIX.to_string(), |machine| format!("{machine}{}-", std::process::id()))
}

/// Removes the incomplete files in a folder that processes of this machine have left which exist no more, as
/// after SIGKILL. Where the file system has files without names, none are looked for: a folder may be large.
pub fn remove_orphans(folder: &Path) {
    if open_unnamed(folder).is_none() {
        remove_in(folder);
    }
}

fn remove_in(folder: &Path) {
    let (Some(machine), Ok(entries)) = (machine(), fs::read_dir(folder)) else { return };
    for entry in entries.flatten() {
        if is_orphan(&entry.file_name(), &machine) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_orphan(name: &OsStr, machine: &str) -> bool {
    let number = || name.to_str()?.strip_prefix(machine)?.split_once('-')?.0.parse().ok();
    number().and_then(Pid::from_raw).is_some_and(|pid| test_kill_process(pid) == Err(Errno::SRCH))
}

/// The prefix of names of all processes whose numbers can be told from that of this one: those of its
/// namespace, since the machine was started. `None` if the system does not say so.
fn machine() -> Option<String> {
    let start = fs::read("/proc/sys/kernel/random/boot_id").ok()?;
    let namespace = fs::read_link("/proc/self/ns/pid").ok()?;
    let mut hasher = DefaultHasher::new();
    (start, namespace).hash(&mut hasher);
    Some(format!("{PREFIX}{:016x}-", hasher.finish()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_dead_processes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let Some(machine) = machine() else { return };
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let dead = child.id();
        child.wait().unwrap();
        let kept = [
            "mesh.spm".to_string(),
            format!("{PREFIX}abcdef"),
            format!("{PREFIX}0123456789abcdef-{dead}-abc"),
            format!("{}abc", own_prefix()),
            format!("{machine}1-abc"),
            format!("{machine}0-abc"),
        ];
        for name in kept.iter().chain([&format!("{machine}{dead}-abc")]) {
            fs::write(folder.path().join(name), "half").unwrap();
        }
        remove_in(folder.path());
        let mut left: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        let mut kept = kept.map(std::ffi::OsString::from);
        kept.sort();
        assert_eq!(left, kept);
    }
}
