//! Interrupts and requests to terminate leave no file behind.

use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Output, Stdio};

use crate::programs::{Folder, outcome, tool, with_signals};

const SIGNALS: [i32; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

/// Starts the program and gives it more than a pipe holds, so that it has made its output and reads.
fn start(output: &str, temporary: &Folder, are_ignored: bool) -> Child {
    let mut dd4 = tool("dd4");
    dd4.args(["-o", output, "-"]).env("TMPDIR", temporary.root()).stdin(Stdio::piped());
    let mut child = with_signals(&mut dd4, &SIGNALS, are_ignored).spawn().unwrap();
    let lines: String =
        (0..500_000).map(|i| format!("{} {} {} {}\n", i % 3, i % 7, i % 11, i % 13)).collect();
    child.stdin.as_mut().unwrap().write_all(lines.as_bytes()).unwrap();
    child
}

/// Sends a signal, closes stdin, and waits.
fn end(child: Child, signal: i32) -> Output {
    // SAFETY: the call takes integers, and the child is not yet waited for.
    assert_eq!(unsafe { libc::kill(child.id() as i32, signal) }, 0);
    child.wait_with_output().unwrap()
}

#[test]
fn a_signal_leaves_no_file_and_keeps_the_old_one() {
    for signal in SIGNALS {
        let [folder, temporary] = [(); 2].map(|()| Folder::new());
        let old = folder.write("old.spm", "old");
        for output in [&old, &folder.path("new.spm")] {
            let output = end(start(output, &temporary, false), signal);
            assert_eq!(output.status.signal(), Some(signal), "{:?}", outcome(&output));
        }
        assert_eq!(fs::read_to_string(&old).unwrap(), "old");
        assert_eq!(folder.names(""), ["old.spm"]);
        assert_eq!(temporary.names("").len(), 0);
    }
}

/// As after `nohup`, and in jobs that a script starts with `&`.
#[test]
fn ignored_signals_stay_ignored() {
    for signal in SIGNALS {
        let [folder, temporary] = [(); 2].map(|()| Folder::new());
        let output = end(start(&folder.path("new.spm"), &temporary, true), signal);
        assert_eq!(output.status.code(), Some(0), "{:?}", outcome(&output));
        assert_eq!(folder.names(""), ["new.spm"]);
    }
}
