//! Interrupts and requests to terminate leave no file behind.

use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};

use crate::programs::{outcome, run, tool};

#[test]
fn a_signal_leaves_no_file_and_keeps_the_old_one() {
    for (name, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let [folder, temporary] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let old = folder.path().join("old.spm");
        fs::write(&old, "old").unwrap();
        for output in ["old.spm", "new.spm"] {
            let mut dd4 = tool("dd4");
            dd4.arg("-o").arg(folder.path().join(output)).arg("-").env("TMPDIR", temporary.path());
            let mut child = dd4.stdin(Stdio::piped()).spawn().unwrap();
            // More than a pipe holds, so that the program has made its output and reads.
            let lines: String =
                (0..500_000).map(|i| format!("{i} {} {} {}\n", i % 7, i % 11, i % 13)).collect();
            child.stdin.as_mut().unwrap().write_all(lines.as_bytes()).unwrap();
            let kill = format!("kill -{name} {}", child.id());
            assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.signal(), Some(number), "{:?}", outcome(&output));
        }
        assert_eq!(fs::read_to_string(&old).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(fs::read_dir(temporary.path()).unwrap().count(), 0);
    }
}

#[test]
fn ignored_signals_stay_ignored() {
    // As after nohup: the shell ignores the signal, and its child inherits this.
    let dd4 = env!("CARGO_BIN_EXE_dd4");
    let script =
        format!("trap '' INT; '{dd4}' --grid 2x2x2x2 -o /dev/null & trap - INT; kill -INT $!; wait $!");
    let status = Command::new("sh").args(["-c", &script]).status().unwrap();
    assert!(status.success(), "{status:?}");
    assert_eq!(
        outcome(&run("dd4", &["--grid", "2x2x2x2", "-o", "/dev/null"], &[])),
        (Some(0), String::new())
    );
}
